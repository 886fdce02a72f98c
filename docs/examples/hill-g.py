"""Hill's lunar problem in the plane, in p + i q = (x + i y)^2 with derivative u + i v: orbits that the rotation by pi
maps to themselves close here in half their time. M. Henon, Astronomy and Astrophysics 1 (1969) 223-238: families g, g'.
"""

name = "hill-g"
title = "planar Hill problem up to the rotation by pi"
state = "p q u v"
where = {"w": "(p**2 + q**2)**(-1/4)"}  # 1 / sqrt(x^2 + y^2)
field = {
    "p": "u",
    "q": "v",
    "u": "(p*(u**2 - v**2) + 2*q*u*v)*w**4/2 + 2*v + 3*p + 3*(p**2 + q**2)*w**2 - 2*p*w**3",
    "v": "(2*p*u*v - q*(u**2 - v**2))*w**4/2 - 2*u + 3*q - 2*q*w**3",
}
R = {"q": -1, "u": -1}
section = "q"
first_integral = "3*(p + (p**2 + q**2)*w**2)/2 + 2*w - (u**2 + v**2)*w**2/4"
first_integral_name = "Jacobi constant"
