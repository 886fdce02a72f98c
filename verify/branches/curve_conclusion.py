"""What the results of an atlas give together of a curve: with its bifurcations, resonances and stable orbits."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from typing import Any

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import UNLISTED
from orbitproof.verify.branches.certified import certified_point
from orbitproof.verify.branches.conclusion import Check, Watch
from orbitproof.verify.branches.conclusion_as_json import curve_to_json, list_to_json
from orbitproof.verify.branches.results import Result, on_curve
from orbitproof.verify.certificate import Certificate, Recheck
from orbitproof.verify.curve import (
    Conclusion,
    ProvedCurve,
    conclude,
    enclose_crossings,
    enclose_other_point,
    is_born_at_doubling,
)
from orbitproof.verify.evidence import Proved
from orbitproof.verify.lasting import LEAST_ORDER, conclude_lasting
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import ListConclusion, conclude_list
from orbitproof.verify.words.branches import conclusion_in_words

partner = partial(enclose_other_point, ORACLE)
"""Encloses the other point of a symmetric orbit on Fix(R), by integration."""

follow = partial(enclose_crossings, ORACLE)
"""Encloses crossings of the section by an orbit."""


def conclude_curve(
    atlas: Atlas,
    results: Sequence[Result],
    bifurcations: Sequence[Certificate],
    check: Check,
    order: int | None,
    watch: Watch,
    combinations: bool,
) -> dict[str, Any]:
    """The conclusion as JSON; see `conclusion_of`."""
    # By the whole certificate: what was found of one says nothing of another that has its id.
    checks = dict(zip(bifurcations, check(bifurcations), strict=True))

    with watch([entry.id for entry in bifurcations], "looked for on the curve") as begin:

        def examine(certificate: Certificate) -> Recheck:
            begin(certificate.id)
            return checks[certificate]

        points = [certified_point(atlas, entry, examine) for entry in bifurcations]
        conclusion = conclude(atlas, results, points, partner, follow)
    # No theorem is about resonances of the orbits at which the period doubles over the mass (15.10), nor about those of
    # a curve that goes on to a doubling from which its orbits are born (16.14).
    if order is None or any(atlas.system is known for known in UNLISTED) or is_born_at_doubling(atlas):
        return told(conclusion)
    of_curve = on_curve(atlas, results)
    with _stretches(conclusion, "resonances", watch) as begun:
        listed = conclude_list(atlas, of_curve, conclusion, order, combinations, begun)
    # A shorter list of a curve whose twist is known from before is that list alone.
    is_asked = order >= LEAST_ORDER and any(result.twist is not None for result in of_curve)
    if not is_asked:
        return told_list(listed)
    with _stretches(conclusion, "stability for ever", watch) as begun:
        return told_list(conclude_lasting(atlas, of_curve, listed, begun))


@contextmanager
def _stretches(curve: Conclusion[ProvedCurve], what: str, watch: Watch) -> Iterator[Callable[[int], None]]:
    """A function for the numbers of the stretches of a curve, each before it is looked at."""
    count = len(curve.outcome.results.chain.stretches) if isinstance(curve.outcome, Proved) else 0
    names = [f"{what}, part {number} of {count}" for number in range(1, count + 1)]
    with watch(names, "listed") as begin:
        last = -1

        def begun(number: int) -> None:
            nonlocal last
            if number > last:
                last = number
                begin(names[number])

        yield begun


def told(conclusion: Conclusion[ProvedCurve]) -> dict[str, Any]:
    """A conclusion as JSON, with its theorem in words."""
    return curve_to_json(conclusion, conclusion_in_words(conclusion))


def told_list(conclusion: ListConclusion) -> dict[str, Any]:
    """A conclusion with its list as JSON, with the theorem in words."""
    return list_to_json(conclusion, conclusion_in_words(conclusion))
