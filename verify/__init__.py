"""Proofs of bifurcations of symmetric periodic orbits, in ball arithmetic (docs/method.md).

`certify` takes claims of any kind and gives a `Certificate` for each: of a box, a `Candidate`; of a curve or surface in
pieces, an `Atlas`; of curves that meet, of the index along a curve, of the rows of a catalogue. `read` and `write` are
the files of certificates of every kind, and `recheck` checks them again. `places` says where orbits lie on a curve,
`prove_again` proves rows once more in another way. Nothing here imports `orbitproof.explore`. What a name takes is
loaded when it is first used.
"""

from orbitproof.shared.faces import face

__getattr__, __dir__, __all__ = face(__name__, __file__)
