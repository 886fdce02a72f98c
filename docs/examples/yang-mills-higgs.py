"""Two oscillators coupled as in Yang-Mills-Higgs mechanics; y = 0 is a normal mode."""

name = "yang-mills-higgs"
title = "Yang-Mills-Higgs oscillator"
state = "x y px py"
field = {"x": "px", "y": "py", "px": "-x - x*y**2", "py": "-y - y*x**2"}
R = {"px": -1, "py": -1}
symmetries = {"S": {"y": -1, "py": -1}}
section = "px"
first_integral = "(px**2 + py**2 + x**2 + y**2 + x**2*y**2)/2"
first_integral_name = "energy"
