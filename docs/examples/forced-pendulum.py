"""A pendulum that is pushed to and fro, x'' = -sin(x) + u, u'' = -r^2 u, where u^2 + w^2 is the square of the force."""

name = "forced-pendulum"
title = "forced pendulum"
state = "x v u w"
parameters = "r"
field = {"x": "v", "v": "-sin(x) + u", "u": "r*w", "w": "-r*u"}
R = {"x": -1, "u": -1}
symmetries = {"S": {"x": -1, "v": -1, "u": -1, "w": -1}}
section = "u"
first_integral = "u**2 + w**2"
first_integral_name = "squared force"
level_coordinate = "w"
