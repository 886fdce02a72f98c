"""The statement that search and proof agree on: systems, exact numbers, claims and their files.

`CR3BP` and `FALKNER_SKAN` are systems, `load_system` reads your own, and `define_system` makes it of a description.
`EARTH_MOON` and `SUN_JUPITER` are exact mass parameters of the CR3BP; a `Candidate` is a claim about a box, an `Atlas`
one about a whole curve or surface. All units are nondimensional: in the CR3BP the primaries are 1 apart, their masses
add up to 1 and they turn once in the time 2 pi.

>>> from orbitproof.shared import CR3BP, EARTH_MOON
>>> CR3BP.centre_coordinates
('x', 'z', 'vy')
>>> f"{float(EARTH_MOON):.10f}"
'0.0121505845'
"""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
