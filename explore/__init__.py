"""The search: families of symmetric periodic orbits, their bifurcations, claims for the verifier. Not rigorous.

`trace` follows a family, `resonances` finds where it bifurcates, `refine` makes a claim of that, a `Candidate` for
`orbitproof.verify.certify`, and `refine_at` of a point from elsewhere. JAX is loaded when one of these names is first
used.
"""

import os
from typing import Any

from orbitproof.shared.extras import missing_extra
from orbitproof.shared.faces import face

# XLA reports on standard error that it takes some processors' tuning preferences for missing instructions
# (the code is then compiled again). It reads this once, when JAX is imported.
os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")

_attribute, __dir__, __all__ = face(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name not in __all__:
        raise AttributeError(f"orbitproof.explore has no {name!r}; it has {', '.join(__all__)}")
    try:
        return _attribute(name)
    except ModuleNotFoundError as error:
        line = missing_extra(error)
        if line is None:
            raise
        raise ModuleNotFoundError(line, name=error.name) from None
