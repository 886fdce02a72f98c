"""The relativistic oscillator of relativistic.py with a = 1/4, over the levels of its energy.

The level is the parameter e: E - e is constant along orbits for every e, and held at 0.
"""

name = "relativistic-levels"
title = "relativistic oscillator with x^2 y/4"
state = "x y px py"
parameters = "e"
where = {"energy": "sqrt(1 + px**2 + py**2)"}
field = {"x": "px/energy", "y": "py/energy", "px": "-x - x*y/2", "py": "-y - x**2/4"}
R = {"x": -1, "py": -1}
section = "py"
family_parameter = "e"
first_integral = "energy + (x**2 + y**2)/2 + x**2*y/4 - e"
first_integral_name = "E - e"
level_coordinate = "px"
fixed_level = {"value": 0, "between": ["1/4", "3"]}
