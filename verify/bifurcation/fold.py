"""Folds: the curve of symmetric orbits turns back in the parameter (section 9.6).

The curve is a graph over p_1, its tangent at the fold; p_0 leads across the levels of the parameter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.conditions import Problem, narrowed_zero, require_inside, require_nonzero
from orbitproof.verify.bifurcation.nondegeneracy import Nondegeneracy, check_level_slope, side_of
from orbitproof.verify.bifurcation.proved_bifurcation import (
    BifurcationResults,
    Tell,
    around,
    conclude,
    results_at,
)
from orbitproof.verify.evidence import Checklist, DerivativeTable, MultiIndex, Outcome, Reason, meet
from orbitproof.verify.newton import BoxFunction, ImplicitGraph, Jet, compose

_ALONG = 1
_REMEDY = "move the centre to the extremum, align p_1 with the curve there, or choose smaller radii"


@dataclass(frozen=True)
class FoldTheorem:
    """The box of a claim contains exactly one fold (Theorem 9.1).

    Attributes:
        claim, in_own_box: as of `BifurcationTheorem`.
    """

    claim: Candidate
    in_own_box: bool = False

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        names = ["curve", "extremum", "point", *([] if self.claim.is_family_of_maps else ["dH/dp_0"])]
        return around(self.claim, names, self.in_own_box)


def theorem_of(candidate: Candidate) -> FoldTheorem | Reason:
    """The theorem that a candidate claims, or why none applies."""
    if not candidate.is_fold:
        return Reason("theorem", f"{candidate.kind} is no fold", "claim a fold")
    if candidate.k != 1:
        return Reason("theorem", f"a fold with k = {candidate.k}", "claim a fold with k = 1")
    return FoldTheorem(candidate)


def prove(
    candidate: Candidate,
    checklist: Checklist,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb] = (),
    tell: Tell = lambda _problem, reason: reason,
) -> Outcome[BifurcationResults]:
    """Check that there is a fold as `candidate` claims; as `proved_bifurcation.prove`."""
    theorem = theorem_of(candidate)
    return conclude(theorem, check, candidate, checklist, iterates, first_integral, return_times, tell)


def check(candidate: Candidate, checklist: Checklist, problem: Problem) -> BifurcationResults:
    """The conditions, one by one; raises `NotEstablishedError` for the first that is not shown."""
    return results_at(candidate, problem, *check_fold(checklist, problem))


@dataclass(frozen=True)
class TurningCurve:
    """The symmetric period-two points in the box, as a graph over p_1; tables and points here have p_1 first.

    Attributes:
        graph: (p_0, p_2)(p_1), the zeros of pi_q P.
        first_integral: H on Fix(R), or `None` if the parameter is p_0.
    """

    graph: ImplicitGraph
    first_integral: BoxFunction | None

    def over(self, p_1: arb) -> tuple[arb, ...]:
        """Enclosure of the points (p_0, p_1, p_2) of the curve."""
        return _exchanged(self.graph.over((p_1,)))

    def parameter(self, p_1: arb) -> Jet:
        """Jet of the parameter along the curve, up to a constant: a function of p_1, at every point of the ball."""
        where = self.graph.over((p_1,))
        curve = self.graph.jets(where)
        return curve[1] if self.first_integral is None else compose(self.first_integral.derivatives(where), curve)


def _exchanged(values: Sequence[arb]) -> tuple[arb, ...]:
    """Coordinates or balls with the first two exchanged."""
    first, second, *others = values
    return (second, first, *others)


def _with_p_1_first(function: BoxFunction) -> BoxFunction:
    def reordered(part: Mapping[MultiIndex, arb]) -> dict[MultiIndex, arb]:
        return {(index[1], index[0], *index[2:]): ball for index, ball in part.items()}

    return BoxFunction(DerivativeTable(reordered(function.table.box), reordered(function.table.centre)))


def check_fold(checklist: Checklist, problem: Problem) -> tuple[tuple[arb, ...], Nondegeneracy]:
    """All conditions of a fold: the enclosure of its coordinates p, and the side on which the two orbits exist."""
    curve = check_curve(checklist, problem)
    everywhere = _check_extremum(checklist, problem, curve)
    where, curvature = _locate(checklist, problem, curve, everywhere)
    if problem.first_integral is not None:
        check_level_slope(checklist, problem, where)
    return where, Nondegeneracy(side_of(curvature), {"beta": curvature / 2})


def check_curve(checklist: Checklist, problem: Problem) -> TurningCurve:
    """The symmetric period-two points in the box are one curve (p_0(p_1), p_2(p_1)) over P_1."""
    statement = "interval Newton: pi_q P = 0 has one solution (p_0, p_2)(p_1) inside P_0 x P_2 for each p_1 in P_1"
    remedy = "move the centre onto the curve, align p_1 with it, or widen the box across it"
    with checklist.hypothesis("curve", "9.6", statement, remedy) as evidence:
        functions = tuple(_with_p_1_first(component) for component in problem.iterates[0])
        graph = ImplicitGraph(functions, _exchanged(problem.box), 1)
        across = [position for position in range(len(problem.box)) if position != _ALONG]
        for row, entries in enumerate(graph.derivative_matrix(graph.box), start=1):
            for position, ball in zip(across, entries, strict=True):
                evidence.record(f"d q_{row}(P) / d p_{position}", ball)
        evidence.require(graph.is_regular(), "D_(p_0, p_2) pi_q P may be singular in the box", needs_precision=True)
        for position, ball in zip(across, graph.image(graph.box[:1]), strict=True):
            require_inside(evidence, f"p_{position}(P_1)", ball, problem, position)
    integral = problem.first_integral
    return TurningCurve(graph, None if integral is None else _with_p_1_first(integral))


def _check_extremum(checklist: Checklist, problem: Problem, curve: TurningCurve) -> arb:
    """g'' does not vanish on the whole curve in the box, and g' vanishes at one point of it; encloses g''."""
    statement = "along the curve over P_1, g'' does not vanish and interval Newton gives one zero of g', inside P_1"
    with checklist.hypothesis("extremum", "9.6", statement, _REMEDY) as evidence:
        curvature = evidence.record("g''(P_1)", curve.parameter(problem.box[_ALONG]).derivative(2))
        require_nonzero(evidence, "g'' = ", curvature)
        slope = evidence.record("g'(0)", curve.parameter(arb(0)).derivative(1))
        require_inside(evidence, "p_1", -slope / curvature, problem, _ALONG)
    return curvature


def _locate(
    checklist: Checklist, problem: Problem, curve: TurningCurve, everywhere: arb
) -> tuple[tuple[arb, ...], arb]:
    """The point of the fold, the zero of g' over P_1, by interval Newton, repeated; and g'' there."""
    statement = "interval Newton for g' gives the point of the fold, inside the box"
    with checklist.hypothesis("point", "9.6", statement, _REMEDY) as evidence:
        p_1 = narrowed_zero(
            problem,
            _ALONG,
            lambda middle: curve.parameter(middle).derivative(1),
            lambda ball: curve.parameter(ball).derivative(2),
        )
        where = curve.over(p_1)
        for position, ball in enumerate(where):
            require_inside(evidence, f"p_{position}", ball, problem, position)
        curvature = evidence.record("g''", meet(everywhere, curve.parameter(p_1).derivative(2)))
    return where, curvature
