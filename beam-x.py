"""The fourth-order equation u'''' + P u'' + u - u^2 = 0 of an elastic strut and of capillary-gravity water waves.

B. Buffoni, A. R. Champneys, J. F. Toland, J. Dynamics and Differential Equations 8 (1996) 221-279.
"""

name = "beam"
title = "equation u'''' + P u'' + u - u^2 = 0"
state = "u u1 u2 u3"
parameters = "P"
field = {"u": "u1", "u1": "u2", "u2": "u3", "u3": "-P*u2 - u + u**2"}
R = {"u1": -1, "u3": -1}
section = "u1"
first_integral = "u1*u3 - u2**2/3 + P*u1**2/2 + u**2/2 - u**3/3"
first_integral_name = "H"
level_coordinate = "u2"
