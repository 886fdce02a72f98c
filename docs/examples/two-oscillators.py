"""Two oscillators that stiffen each other; one of them can stay at rest, and the other then loses R at a level."""

name = "two-oscillators"
title = "two oscillators that stiffen each other"
state = "x y vx vy"
parameters = "a"
field = {
    "x": "vx",
    "y": "vy",
    "vx": "-a*x - x*y**2",
    "vy": "-y - x**2*y",
}
R = {"y": -1, "vx": -1}
symmetries = {"S": {"x": -1, "vx": -1}}
section = "y"
first_integral = "vx**2 + vy**2 + a*x**2 + y**2 + x**2*y**2"
first_integral_name = "twice the energy"
level_coordinate = "vy"
