"""Conditions C2-C4 and HC2-HC4: two regular curves that cross at one point (section 8).

Each check adds one hypothesis to the checklist and returns what the next ones build on; it raises
`NotEstablishedError` if the hypothesis is not shown.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.reduction import BifurcationFunction, Family, PeriodTwoFamily, reduced_function
from orbitproof.verify.evidence import (
    MAX_ORDER,
    Checklist,
    DerivativeTable,
    Evidence,
    all_finite,
    excludes_zero,
    indices_up_to,
    is_below,
    is_inside,
    is_outside,
    meet,
    show,
    symmetric,
)
from orbitproof.verify.newton import BoxFunction, ImplicitGraph, is_regular

_NEWTON_STEPS = 8


@dataclass(frozen=True)
class Problem:
    """What the conditions are about.

    Attributes:
        k: multiplicity.
        radii: half-widths of P_0, P_1, P_2, exactly.
        box: balls that contain P_0, P_1, P_2.
        iterates: iterates[i-1][j] is q_{j+1} of P^i, for i = 1 .. k and j = 0 .. n-1; P^m stands for P if half
            orbits meet the section m times (section 8.8).
        first_integral: H on Fix(R), or `None` for maps with a parameter.
    """

    k: int
    radii: tuple[Fraction, ...]
    box: tuple[arb, ...]
    iterates: tuple[tuple[BoxFunction, ...], ...]
    first_integral: BoxFunction | None

    @property
    def prefix(self) -> str:
        """ "H" for Hamiltonian systems: the conditions are then called HC2 to HC4."""
        return "H" if self.first_integral is not None else ""


@dataclass(frozen=True)
class Point:
    """The bifurcation point.

    Attributes:
        where: enclosure of its coordinates p.
        crossing: enclosure of G_01 + G_11 p_1' there.
    """

    where: tuple[arb, ...]
    crossing: arb


def check_enclosures(
    checklist: Checklist,
    candidate: Candidate,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb] = (),
) -> Problem:
    """Every derivative that the conditions use is there and finite, and its two enclosures meet."""
    k, radii, crossings = candidate.k, candidate.radii, candidate.crossings
    size = len(radii)
    statement = (
        f"P to P^{k * crossings} exist on the box with finite enclosures of their derivatives up to order {MAX_ORDER}"
    )
    with checklist.hypothesis("poincare-map", "6", statement, "smaller radii or more precision") as evidence:
        for number, time in enumerate(return_times, start=1):
            evidence.record(f"time of crossing {number}", time)
        evidence.require(
            len(iterates) == k * crossings and all(len(components) == size - 1 for components in iterates),
            "an iterate or a component is missing",
        )
        evidence.require(
            (first_integral is None) == candidate.is_family_of_maps,
            "the first integral is missing, or there is one too many",
        )
        tables = [table for components in iterates for table in components]
        tables += [] if first_integral is None else [first_integral]
        indices = indices_up_to(size, MAX_ORDER)
        complete = bool(tables) and all(
            set(indices) <= set(source) for table in tables for source in (table.box, table.centre)
        )
        evidence.require(complete, "a derivative is missing")
        if complete:
            evidence.require(
                all(all_finite(source[index] for index in indices) for t in tables for source in (t.box, t.centre)),
                "an enclosure is not finite",
                needs_precision=True,
            )
            evidence.require(
                all(t.box[index].overlaps(t.centre[index]) is True for t in tables for index in indices),
                "an enclosure at the centre is disjoint from that over the box; a bound is wrong",
            )
    if crossings > 1:
        from orbitproof.verify.poincare import check_half_orbit

        check_half_orbit(checklist, iterates[: crossings - 1])
    return Problem(
        k=k,
        radii=radii,
        box=tuple(symmetric(radius) for radius in radii),
        iterates=tuple(
            tuple(BoxFunction(table) for table in components) for components in iterates[crossings - 1 :: crossings]
        ),
        first_integral=None if first_integral is None else BoxFunction(first_integral),
    )


def check_family(checklist: Checklist, problem: Problem) -> PeriodTwoFamily:
    """k > 1: the symmetric period-two points in the box are one curve (p_1(p_0), p_2(p_0)) over P_0."""
    statement = "interval Newton: pi_q P = 0 has one solution (p_1, p_2)(p_0) inside P_1 x P_2 for each p_0 in P_0"
    remedy = "move the centre onto the family, align p_0 with it, or widen the box across it"
    with checklist.hypothesis("family", "8.1", statement, remedy) as evidence:
        graph = ImplicitGraph(problem.iterates[0], problem.box, 1)
        _record_matrix(evidence, graph.derivative_matrix(problem.box), 1, 1, "P")
        evidence.require(graph.is_regular(), "D_(p_1, p_2) pi_q P may be singular in the box", needs_precision=True)
        for position, ball in enumerate(graph.image(problem.box[:1]), start=1):
            require_inside(evidence, f"p_{position}", ball, problem, position)
    return PeriodTwoFamily(graph)


def check_no_other_orbit(checklist: Checklist, problem: Problem, i: int) -> None:
    """Every matrix in the hull of D_(p_1, p_2) pi_q P^i is regular: no other symmetric orbit of period 2i."""
    statement = f"every matrix in the interval hull of D_(p_1, p_2) pi_q P^{i} over the box is regular"
    remedy = f"smaller radii; if the family is near a resonance of order {i}, much smaller ones"
    with checklist.hypothesis(f"regular-{i}", "8.2", statement, remedy) as evidence:
        matrix = [component.gradient(problem.box, 1) for component in problem.iterates[i - 1]]
        _record_matrix(evidence, matrix, 1, 1, f"P^{i}")
        evidence.require(is_regular(matrix), "a singular matrix is not excluded", needs_precision=True)


def check_reduction(checklist: Checklist, problem: Problem, family: Family | None) -> BifurcationFunction:
    """C2/HC2: p_2^H exists on P_0 x P_1 with values inside P_2, and p_1(P_0) lies inside P_1.

    `family` is `None` for k = 1, where p_1 = 0 along the doubly symmetric branch.
    """
    statement = "p_1(P_0) lies inside P_1 and pi_q2 P^k = 0 has one solution p_2^H in P_2, inside it, over P_0 x P_1"
    remedy = "widen P_2, or choose smaller P_0 and P_1"
    with checklist.hypothesis(f"{problem.prefix}C2", "8.3", statement, remedy) as evidence:
        component, *others = problem.iterates[-1]
        graph = ImplicitGraph(tuple(others), problem.box, 2)
        _record_matrix(evidence, graph.derivative_matrix(problem.box), 2, 2, f"P^{problem.k}")
        evidence.require(graph.is_regular(), "D_p2 pi_q2 P^k may be singular in the box", needs_precision=True)
        for position, ball in enumerate(graph.image(problem.box[:2]), start=2):
            require_inside(evidence, f"p_{position}^H", ball, problem, position)
        slope = arb(0) if family is None else family.over(problem.box[0])[1]
        require_inside(evidence, "p_1(P_0)", slope, problem, 1)
    return BifurcationFunction(component, graph)


def check_reduced_function(
    checklist: Checklist, problem: Problem, family: Family, reduction: BifurcationFunction
) -> None:
    """C3/HC3: the zeros of the reduced function g over P_1 are one curve p_0(p_1) inside P_0."""
    statement = "interval Newton: g = 0 has one solution p_0(p_1) in P_0, inside it, for each p_1 in P_1"
    remedy = "widen P_0 or choose a smaller P_1; is k right, and the centre at the bifurcation point?"
    with checklist.hypothesis(f"{problem.prefix}C3", "8.4", statement, remedy) as evidence:
        p_0, p_1 = problem.box[:2]
        reduced = reduced_function(p_0, p_1, family, reduction)
        require_nonzero(evidence, "g_0 = ", evidence.record("g_0", reduced.slope))
        evidence.record("g(0, P_1)", reduced.at_centre(p_1))
        require_inside(evidence, "p_0(P_1)", reduced.zero(p_1), problem, 0)


def check_transversality(
    checklist: Checklist, problem: Problem, family: Family, reduction: BifurcationFunction
) -> None:
    """C4/HC4: G_01 + G_11 p_1' does not vanish along the family, so that the curves cross once."""
    statement = "G_01 + G_11 p_1' does not vanish along the family over P_0"
    with checklist.hypothesis(f"{problem.prefix}C4", "8.5", statement, "choose smaller radii") as evidence:
        crossing = _crossing(problem.box[0], family, reduction)
        evidence.record("G_01 + G_11 p_1'", crossing)
        require_nonzero(evidence, "", crossing)


def _crossing(p_0: arb, family: Family, reduction: BifurcationFunction) -> arb:
    """Enclosure of the derivative of G_1(p_0, p_1(p_0)), which is G_01 + G_11 p_1'."""
    where = family.over(p_0)
    jet = reduction.jet(where)
    return jet.derivative(1, 1) + jet.derivative(0, 2) * family.jet(where).slope


def locate(checklist: Checklist, problem: Problem, family: Family, reduction: BifurcationFunction) -> Point:
    """The bifurcation point: the zero of G_1(p_0, p_1(p_0)) over P_0, by interval Newton, repeated."""
    statement = "interval Newton for G_1(p_0, p_1(p_0)) gives the bifurcation point, inside the box"
    remedy = "move the centre to the bifurcation point"
    with checklist.hypothesis("point", "8.7", statement, remedy) as evidence:
        p_0 = narrowed_zero(
            problem,
            0,
            lambda middle: reduction.jet(family.over(middle)).derivative(0, 1),
            lambda ball: _crossing(ball, family, reduction),
        )
        where = family.over(p_0)
        for position, ball in enumerate(where):
            require_inside(evidence, f"p_{position}", ball, problem, position)
        crossing = evidence.record("G_01 + G_11 p_1'", _crossing(p_0, family, reduction))
    return Point(where, crossing)


def narrowed_zero(problem: Problem, position: int, value: Callable[[arb], arb], slope: Callable[[arb], arb]) -> arb:
    """A ball for the one zero in P_i, i = `position`, of a function of p_i, by interval Newton, repeated.

    `value` encloses the function at a point of P_i, `slope` its derivative over a part of P_i.
    """
    p = problem.box[position]
    for _ in range(_NEWTON_STEPS):
        middle = p.mid()
        if not is_inside(middle, problem.radii[position]):
            break
        # The segment from the middle to the zero lies in p and in P_i.
        narrower = meet(p, middle - value(middle) / slope(p))
        progress = is_below(narrower.rad() * 2, p.rad())
        p = narrower
        if not progress:
            break
    return p


def _record_matrix(
    evidence: Evidence, matrix: Sequence[Sequence[arb]], first_row: int, first_column: int, iterate: str
) -> None:
    for row, entries in enumerate(matrix, start=first_row):
        for column, ball in enumerate(entries, start=first_column):
            evidence.record(f"d q_{row}({iterate}) / d p_{column}", ball)


def require_inside(evidence: Evidence, name: str, ball: arb, problem: Problem, position: int) -> None:
    """Require that the ball lies inside P_i, i = `position`."""
    radius = problem.radii[position]
    evidence.record(name, ball)
    outside = is_outside(ball, radius)
    where = "lies outside [-R, R]: there is no such point in the box" if outside else "is not inside (-R, R)"
    evidence.require(
        is_inside(ball, radius),
        f"{name} in {show(ball)} {where}, R = {float(radius):.3g}",
        needs_precision=not outside,
        excluded=outside,
    )


def require_nonzero(evidence: Evidence, name: str, ball: arb) -> None:
    """Require that the ball, which holds over the box, excludes 0."""
    evidence.require(excludes_zero(ball), f"{name}{show(ball)} may vanish", needs_precision=True)
