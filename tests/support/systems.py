"""Systems by their description."""

from __future__ import annotations

from typing import Any

from orbitproof.shared.formats import define_system


def described(**description: Any) -> Any:
    """`define_system` of keys as arguments."""
    return define_system(description)
