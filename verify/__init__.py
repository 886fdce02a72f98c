"""Proofs of bifurcations of symmetric periodic orbits, in ball arithmetic (docs/method.md).

`certify` takes claims, `Candidate` values, and gives a `Certificate` for each; `certify_atlas` takes an `Atlas`, a
curve or surface in pieces, and gives one. On these `certify_web`, `certify_index` and
`certify_catalogue` build. `read` and `write` are the files of certificates of every kind, and `recheck` checks them
again. `places` says where orbits lie on a curve, `prove_again` proves rows once more in another way. Nothing here
imports `orbitproof.explore`. What a name takes is loaded when it is first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
