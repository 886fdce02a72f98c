"""A particle in an anharmonic potential, by the theory of relativity: rest mass and speed of light are 1.

Its energy, 3/2 with that of rest, is not quadratic in px, which follows from it between 1/4 and 2.
"""

name = "relativistic"
title = "relativistic oscillator with x^2 y"
state = "x y px py"
parameters = "a"
where = {"energy": "sqrt(1 + px**2 + py**2)"}
field = {"x": "px/energy", "y": "py/energy", "px": "-x - 2*a*x*y", "py": "-y - a*x**2"}
R = {"x": -1, "py": -1}
section = "py"
family_parameter = "a"
first_integral = "energy + (x**2 + y**2)/2 + a*x**2*y"
first_integral_name = "E"
level_coordinate = "px"
fixed_level = {"value": "3/2", "between": ["1/4", "2"]}
