"""Hill's lunar problem; its planar families are those of M. Henon, Astronomy and Astrophysics 1 (1969) 223-238."""

name = "hill"
title = "Hill's lunar problem"
state = "x y z vx vy vz"
where = {"pull": "(x**2 + y**2 + z**2)**(-3/2)"}
field = {
    "x": "vx",
    "y": "vy",
    "z": "vz",
    "vx": "2*vy + 3*x - x*pull",
    "vy": "-2*vx - y*pull",
    "vz": "-z - z*pull",
}
R = {"y": -1, "vx": -1, "vz": -1}
symmetries = {"S": {"z": -1, "vz": -1}}
section = "y"
first_integral = "3*x**2 - z**2 + 2/sqrt(x**2 + y**2 + z**2) - vx**2 - vy**2 - vz**2"
first_integral_name = "Jacobi constant"
level_coordinate = "w"
