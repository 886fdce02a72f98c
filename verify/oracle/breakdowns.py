"""What breaks down in a search for approximations: the claim is not proved, with that reason."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from orbitproof.verify.evidence import IntegrationFailure


@contextmanager
def breakdowns_told() -> Iterator[None]:
    """Exceptions of an arithmetic that breaks down become `IntegrationFailure`; others are bugs, and pass."""
    try:
        yield
    except (ArithmeticError, TypeError, ValueError) as error:
        said = " ".join(str(error).split())
        raise IntegrationFailure(
            "guess",
            f"no approximate solution was found ({type(error).__name__}{': ' if said else ''}{said})",
            "give smaller radii or another centre",
        ) from error
