"""Hill's lunar problem in the plane with its two reversing symmetries, which are one another after the rotation by pi.

Half a period takes an orbit of the family g to its image under the rotation; orbits of g' do not have this symmetry.
"""

name = "hill-planar"
title = "planar Hill problem"
state = "x y vx vy"
where = {"pull": "(x**2 + y**2)**(-3/2)"}
field = {"x": "vx", "y": "vy", "vx": "2*vy + 3*x - x*pull", "vy": "-2*vx - y*pull"}
R = {"y": -1, "vx": -1}
section = "y"
symmetries = {"rotation": {"x": -1, "y": -1, "vx": -1, "vy": -1}}
reversors = {"turned": {"R": {"x": -1, "vy": -1}, "section": "x", "level_coordinate": "vx"}}
first_integral = "3*x**2 + 2/sqrt(x**2 + y**2) - vx**2 - vy**2"
first_integral_name = "Jacobi constant"
level_coordinate = "vy"
