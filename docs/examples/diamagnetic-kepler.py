"""An electron about a nucleus in a magnetic field, without angular momentum; nu = 0: straight orbits."""

name = "diamagnetic-kepler"
title = "diamagnetic Kepler problem"
state = "mu nu pmu pnu"
parameters = {"eps": [None, "0"]}
field = {
    "mu": "pmu",
    "nu": "pnu",
    "pmu": "2*eps*mu - mu*nu**2*(2*mu**2 + nu**2)/4",
    "pnu": "2*eps*nu - nu*mu**2*(mu**2 + 2*nu**2)/4",
}
R = {"mu": -1, "pnu": -1}
symmetries = {"S": {"nu": -1, "pnu": -1}}
section = "mu"
family_parameter = "eps"
first_integral = "(pmu**2 + pnu**2)/2 - eps*(mu**2 + nu**2) + mu**2*nu**2*(mu**2 + nu**2)/8"
level_coordinate = "pmu"
fixed_level = {"value": "2", "sign": 1}
