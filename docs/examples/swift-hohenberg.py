"""Stationary Swift-Hohenberg equation on the level of its equilibria x = -1, 1: even periodic solutions."""

name = "swift-hohenberg"
title = "equation x'''' + xi x'' + x^3 - x = 0"
state = "x y z w"
parameters = "xi"
field = {"x": "y", "y": "z", "z": "w", "w": "x - x**3 - xi*z"}
R = {"y": -1, "w": -1}
section = "y"
family_parameter = "xi"
first_integral = "y*w - 0.5*z**2 + 0.5*xi*y**2 + (x**2 - 1)**2/4"
first_integral_name = "E"
level_coordinate = "z"
fixed_level = {"value": 0, "sign": 1}
