"""The Michelson system, travelling waves of the Kuramoto-Sivashinsky equation: x''' = c^2 - x' - x^2/2.

D. Michelson, Physica D 19 (1986) 89-111.
"""

name = "michelson"
title = "Michelson system"
state = "x y z"
parameters = "c"
field = {"x": "y", "y": "z", "z": "c**2 - y - x**2/2"}
R = {"x": -1, "y": 1, "z": -1}
section = "x"
famly_parameter = "c"
