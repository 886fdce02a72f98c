"""What the results of an atlas give together."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from typing import Any

from flint import ctx

from orbitproof.shared.formats import AnyAtlas
from orbitproof.verify.branches.kinds import kind_of
from orbitproof.verify.branches.results import Result
from orbitproof.verify.certificate import Certificate, Recheck, repeated

Check = Callable[[Sequence[Certificate]], Sequence[Recheck]]
"""Checks certificates of bifurcations again, in their order."""
Watch = Callable[[Sequence[str], str], AbstractContextManager[Callable[[str], None]]]
"""For names of what is done one after the other, and a word for what is done, a context in which a function is called
with each before it begins."""

_BITS = 53
"""Bits of what is done with balls between the chapters, which set their own precision, and of what is stored of it."""


def conclusion_of(
    atlas: AnyAtlas,
    results: Sequence[Result],
    bifurcations: Sequence[Certificate],
    check: Check,
    order: int | None,
    watch: Watch = lambda names, word: nullcontext(lambda name: None),
    combinations: bool = False,
) -> dict[str, Any]:
    """The conclusion as JSON.

    Args:
        bifurcations: certificates that are looked for on a curve.
        check: checks such certificates again, in their order.
        order: with one, all resonances on a curve up to it as well; and which orbits are stable for ever, if results
            know the twist.
        watch: shows which of them is looked for, and how far the list is.
        combinations: whether combination resonances are listed with the others.

    Raises `ValueError` if an id appears twice: the theorem speaks of certificates by their ids.
    """
    for name in repeated(bifurcations):
        raise ValueError(f"the certificates of bifurcations: {name!r} appears twice")
    # A certificate is the same wherever it is made.
    with ctx.workprec(_BITS):
        asked = (bifurcations, check, order, watch, combinations)
        conclusion: dict[str, Any] = kind_of(atlas).conclude(atlas, results, *asked)
    return conclusion
