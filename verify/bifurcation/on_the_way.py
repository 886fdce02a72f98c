"""Claims that fail before their orbits are followed to crossing k: what each half return decides (section 8.2)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from flint import arb, arb_mat

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.conditions import Problem, check_family, check_no_other_orbit
from orbitproof.verify.bifurcation.counsel import Counsel, Failure, advised, silent
from orbitproof.verify.bifurcation.refusals import EXCLUDED, REMEDY
from orbitproof.verify.evidence import Checklist, NotEstablishedError, Reason, enclose, symmetric
from orbitproof.verify.newton import BoxFunction, is_regular
from orbitproof.verify.poincare import HalfReturns, check_half_orbit

_EXCLUDED_ON_THE_WAY = (
    f"{EXCLUDED}at the R-symmetric points with P^2(x) = x in it, D_(p_1, p_2) pi_q P^{{k}} lies, by P and P^2, in a "
    "hull of which every matrix is regular (section 8.2)"
)


def check_half_returns(candidate: Candidate, found: HalfReturns, counsel: Counsel = silent) -> None:
    """Raise `NotEstablishedError` if a condition about so many half returns, fewer than k, fails.

    It is the failure that the proof would come to, which `refusals.prove` finds when all returns are
    enclosed; or that of a claim which the first two half returns exclude.
    """
    problem = _problem(candidate, found)
    checklist = Checklist()
    try:
        if len(found.kernels) == 1:
            check_half_orbit(checklist, found.before)
        _check(checklist, problem)
    except NotEstablishedError as error:
        reason = replace(error.reason, enclosures=dict(checklist.hypotheses[-1].enclosures))
        failure = Failure(candidate, problem, reason, checklist.hypotheses, lambda other: _check(Checklist(), other))
        raise NotEstablishedError(advised(failure, counsel)) from None
    except ArithmeticError:
        return
    if found.image and _excludes_branches(candidate, problem, found):
        message = _EXCLUDED_ON_THE_WAY.format(k=candidate.k)
        raise NotEstablishedError(Reason("multiplicity", message, REMEDY, excluded=True))


def _problem(candidate: Candidate, found: HalfReturns) -> Problem:
    return Problem(
        k=candidate.k,
        radii=candidate.radii,
        box=tuple(symmetric(radius) for radius in candidate.radii),
        iterates=tuple(tuple(BoxFunction(table) for table in tables) for tables in found.kernels),
        first_integral=None,
    )


def _check(checklist: Checklist, problem: Problem) -> None:
    """The conditions about the last of these half returns that are the same for all kinds."""
    last = len(problem.iterates)
    if last == 1:
        check_family(checklist, problem)
    check_no_other_orbit(checklist, problem, last)


def _excludes_branches(candidate: Candidate, problem: Problem, found: HalfReturns) -> bool:
    """Whether no point of the family in the box is a bifurcation of this k, by the first two half returns."""
    try:
        matrix = _iterate(candidate, problem, found)
    except ZeroDivisionError:
        return False
    return is_regular([[matrix[i, j] for j in range(1, matrix.ncols())] for i in range(matrix.nrows())])


def _iterate(candidate: Candidate, problem: Problem, found: HalfReturns) -> arb_mat:
    """D_p pi_q P^k at all points of the family in the box, shape (n, 1 + n), by the recurrences of section 8.2."""
    odd = candidate.k % 2 == 1
    now = arb_mat([component.gradient(problem.box, 0) for component in problem.iterates[0 if odd else 1]])
    before = -now if odd else 0 * now
    twice = 2 * _of_second_image(candidate, problem.box, found)
    for _ in range((candidate.k - 1) // 2):
        before, now = now, now * twice - before
    return now


def _of_second_image(candidate: Candidate, box: Sequence[arb], found: HalfReturns) -> arb_mat:
    """D_p of the coordinates p of P^2 on Fix(R). What is not in `found` is a parameter, which P leaves alone."""
    frame = arb_mat([[enclose(value) for value in row] for row in candidate.frame])
    rows = []
    for name, own in zip(candidate.coordinates, frame.tolist(), strict=True):
        rows.append(BoxFunction(found.image[name]).gradient(box, 0) if name in found.image else own)
    return frame.solve(arb_mat(rows))
