"""The equation of beam.py on the zero level of its integral, with P as the parameter of the family.

Homoclinic orbits of the equilibrium 0 lie on this level for P < 2, and periodic orbits near them.
"""

name = "beam-level"
title = "equation u'''' + P u'' + u - u^2 = 0"
state = "u u1 u2 u3"
parameters = "P"
field = {"u": "u1", "u1": "u2", "u2": "u3", "u3": "-P*u2 - u + u**2"}
R = {"u1": -1, "u3": -1}
section = "u1"
family_parameter = "P"
first_integral = "u1*u3 - 0.5*u2**2 + 0.5*P*u1**2 + 0.5*u**2 - u**3/3"
first_integral_name = "H"
level_coordinate = "u2"
