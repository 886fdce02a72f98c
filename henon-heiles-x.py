"""The system of Henon and Heiles, Astronomical Journal 69 (1964) 73-79; its energy is the parameter of its families."""

name = "henon-heiles"
title = "Henon-Heiles system"
state = "x y vx vy"
field = {
    "x": "vx",
    "y": "vy",
    "vx": "-x - 2*x*y",
    "vy": "-y - x**2 + y**2",
}
R = {"x": -1, "vy": -1}
symmetries = {"S": {"x": -1, "vx": -1}}
reversors = {"T": {"vx": -1, "vy": -1}}
section = "y"
first_integral = "(vx**2 + vy**2 + x**2 + y**2)/2 + x**2*y - y**3/3"
first_integral_name = "energy"
