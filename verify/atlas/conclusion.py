"""What the results of an atlas give together: a curve with its bifurcations and resonances, or a surface."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager, nullcontext
from functools import partial
from typing import Any

from flint import ctx

from orbitproof.shared.formats import AnyAtlas, Atlas
from orbitproof.shared.systems import UNLISTED
from orbitproof.verify.atlas.certified import certified_point
from orbitproof.verify.atlas.conclusion_as_json import conclusion_to_json
from orbitproof.verify.atlas.kinds import kind_of
from orbitproof.verify.atlas.results import Result
from orbitproof.verify.certificate import Certificate, Recheck, repeated
from orbitproof.verify.curve import (
    Conclusion,
    ProvedCurve,
    conclude,
    enclose_crossings,
    enclose_other_point,
    is_born_at_doubling,
)
from orbitproof.verify.evidence import Proved
from orbitproof.verify.lasting import LEAST_ORDER, LastingResult, conclude_lasting
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.stability import conclude_list
from orbitproof.verify.words.branches import BranchConclusion, conclusion_in_words

partner = partial(enclose_other_point, ORACLE)
"""Encloses the other point of a symmetric orbit on Fix(R), by integration."""

follow = partial(enclose_crossings, ORACLE)
"""Encloses crossings of the section by an orbit."""

_BITS = 53
"""Of what is done with balls between the chapters, which set their own precision, and of what is stored of it."""

Watch = Callable[[Sequence[str], str], AbstractContextManager[Callable[[str], None]]]
"""For names of what is done one after the other, and a word for what is done, a context in which a function is called
with each before it begins."""


def conclusion_of(
    atlas: AnyAtlas,
    results: Sequence[Result],
    bifurcations: Sequence[Certificate],
    check: Callable[[Sequence[Certificate]], Sequence[Recheck]],
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
        return _concluded(atlas, results, bifurcations, check, order, watch, combinations)


def _concluded(
    atlas: AnyAtlas,
    results: Sequence[Result],
    bifurcations: Sequence[Certificate],
    check: Callable[[Sequence[Certificate]], Sequence[Recheck]],
    order: int | None,
    watch: Watch,
    combinations: bool,
) -> dict[str, Any]:
    """See `conclusion_of`."""
    conclude_whole = kind_of(atlas).conclude
    if conclude_whole is not None:
        return told(conclude_whole(atlas, results))
    assert isinstance(atlas, Atlas)
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
    of_curve = [result for result in results if isinstance(result, LastingResult)]
    with _stretches(conclusion, "resonances", watch) as begun:
        listed = conclude_list(atlas, of_curve, conclusion, order, combinations, begun)
    # A shorter list of a curve whose twist is known from before is that list alone.
    is_asked = order >= LEAST_ORDER and any(result.twist is not None for result in of_curve)
    if not is_asked:
        return told(listed)
    with _stretches(conclusion, "stability for ever", watch) as begun:
        return told(conclude_lasting(atlas, of_curve, listed, begun))


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


def told(conclusion: BranchConclusion) -> dict[str, Any]:
    """A conclusion as JSON, with its theorem in words."""
    return conclusion_to_json(conclusion, conclusion_in_words(conclusion))
