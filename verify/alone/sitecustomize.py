"""With this folder on PYTHONPATH no process of Python, workers included, can import the search side.

Python imports `sitecustomize` by itself when it starts. ``make demo`` proves in this way.
"""

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

SEARCH_SIDE = frozenset(
    {"orbitproof.explore", "orbitproof.figures", "explore", "figures"}
    | {"jax", "jaxlib", "diffrax", "equinox", "mpmath", "matplotlib", "scipy", "sympy"}
)


class Refusal(MetaPathFinder):
    """Asked before every other finder."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Raises `ImportError` for the search side; leaves everything else to the others."""
        if fullname in SEARCH_SIDE:
            raise ImportError(f"the verifier must not import the search side ({fullname})", name=fullname)
        return None


sys.meta_path.insert(0, Refusal())
