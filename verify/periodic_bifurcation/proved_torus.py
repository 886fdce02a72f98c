"""Neimark-Sacker bifurcations of periodic orbits in a box: an invariant torus, its side (sections 25.9 to 25.12)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Literal

from flint import acb, arb, arb_mat

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    Reason,
    concluded,
    enclose,
    excludes_zero,
    is_positive,
    show,
)
from orbitproof.verify.periodic import (
    Multipliers,
    check_coordinates,
    check_functions_of,
    check_transversal,
    multipliers_of,
    state_on_box,
)
from orbitproof.verify.periodic_bifurcation.enclosures import BifurcationEnclosures
from orbitproof.verify.periodic_bifurcation.equations import Matrix, PointEquations, equations_of
from orbitproof.verify.periodic_bifurcation.returns import check_least, check_returns, time_at
from orbitproof.verify.periodic_bifurcation.torus_coefficients import TorusCoefficients, coefficients_of_torus
from orbitproof.verify.periodic_bifurcation.torus_system import TorusPoint, check_torus_point

_RESONANCES = (1, 2, 3, 4)


@dataclass(frozen=True)
class TorusResults:
    """What is known of a proved Neimark-Sacker bifurcation, in the units of its system.

    Attributes:
        point: enclosures of the state at the point in the box, by name.
        parameter_name, parameter: what varies, and its value at the bifurcation.
        period: the least period of the orbit there.
        multiplier: one of the pair on the unit circle; the other is its conjugate.
        multipliers: the others but that of the direction of the flow, and where they lie: none is on the circle.
        speed: the derivative of the absolute value of the pair in the parameter.
        lyapunov: d = Re(conj(lambda) c_1), for the eigenvector of the claim.
        side: the values of the parameter for which there is the torus: above or below that of the bifurcation.
        criticality: "supercritical" if d < 0: within the centre manifold the torus attracts, and the orbit that it
            surrounds repels; "subcritical" if d > 0.
    """

    point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    period: arb
    multiplier: acb
    multipliers: Multipliers
    speed: arb
    lyapunov: arb
    side: Literal["above", "below"]
    criticality: Literal["supercritical", "subcritical"]

    @property
    def is_attracting(self) -> bool:
        """Whether the torus is asymptotically stable; if not it is unstable."""
        return self.criticality == "supercritical" and self.multipliers.outside == 0


@dataclass(frozen=True)
class TorusTheorem:
    """The box of a claim contains exactly one Neimark-Sacker bifurcation as claimed (Theorem 25.14)."""

    claim: PeriodicBifurcation

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return (
            *(["functions"] if self.claim.system.defined else []),
            "section", "direction", "return-map", "bifurcation", "non-resonance", "others", "least-period",
            "crossing", "lyapunov",
        )  # fmt: skip


def check_torus_exactly(checklist: Checklist, claim: PeriodicBifurcation) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_functions_of(checklist, claim.system)
    check_coordinates(checklist, claim)
    check_transversal(checklist, claim)


def prove_torus(
    claim: PeriodicBifurcation, checklist: Checklist, enclosures: BifurcationEnclosures | None
) -> Outcome[TorusResults]:
    """Check that the box contains exactly one bifurcation as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> TorusResults:
        found = check_returns(checklist, claim, enclosures)
        equations = equations_of(claim, found)
        place = check_torus_point(checklist, claim, equations)
        _check_resonances(checklist, place)
        others = _check_others(checklist, equations, place)
        check_least(checklist, claim, found.earlier, place.where)
        derivatives = [function.derivatives(place.where) for function in equations.returns]
        coefficients = _check_coefficients(checklist, derivatives, place)
        return _results(claim, found, place, others, coefficients)

    theorem: TorusTheorem | Reason = TorusTheorem(claim)
    if not claim.is_torus:
        theorem = Reason("theorem", f"{claim.kind} is about no torus", "claim a torus")
    return concluded(theorem, checklist, check)


def _check_resonances(checklist: Checklist, place: TorusPoint) -> None:
    """The pair is no pair of roots of unity of order 1, .., 4: it is not real, and there is no strong resonance."""
    statement = "the multiplier is no root of unity of order 1, 2, 3 or 4"
    remedy = "at a strong resonance the bifurcation is another one: vary a second parameter"
    with checklist.hypothesis("non-resonance", "25.10", statement, remedy) as evidence:
        power = acb(1)
        for order in _RESONANCES:
            power = power * place.multiplier
            distance = evidence.record(f"distance of its power {order} from 1", abs(power - 1))
            evidence.require(is_positive(distance), f"its power {order} may be 1", needs_precision=True)


def _check_others(checklist: Checklist, equations: PointEquations, place: TorusPoint) -> Multipliers:
    """All other multipliers of the map lie inside or outside the unit circle."""
    statement = "every other multiplier of the return map lies inside or outside the unit circle"
    with checklist.hypothesis("others", "25.10", statement, "more precision, or another parameter") as evidence:
        slopes = equations.slopes(place.where)
        found = multipliers_of(without_plane(equations.minus(0, slopes), place.eigenvector), 1, keeps_volume=False)
        for position, value in enumerate(found.values):
            evidence.record(f"absolute value {position}", abs(value))
        decided = found.inside + found.outside == equations.size - 2
        evidence.require(decided, "where one of them lies is not decided", needs_precision=True)
    return found


def without_plane(matrix: Sequence[Sequence[arb]], eigenvector: Sequence[acb]) -> Matrix:
    """A matrix on the quotient by the plane of u and v, w = u + i v an eigenvector, in the coordinates but two.

    Raises `ZeroDivisionError` where u and v are not shown to be independent.
    """
    rows = [[value.real, value.imag] for value in eigenvector]
    size = len(rows)
    dropped = max(combinations(range(size), 2), key=lambda pair: _size_of(rows[pair[0]], rows[pair[1]]))
    kept = [i for i in range(size) if i not in dropped]
    if not kept:
        return []
    inverse = arb_mat([rows[i] for i in dropped]).inv()
    lost = arb_mat([rows[i] for i in kept]) * inverse * arb_mat([[matrix[i][k] for k in kept] for i in dropped])
    return [[matrix[i][k] - lost[a, b] for b, k in enumerate(kept)] for a, i in enumerate(kept)]


def _size_of(first: Sequence[arb], second: Sequence[arb]) -> float:
    return float(abs((first[0] * second[1] - first[1] * second[0]).mid()))


def _check_coefficients(
    checklist: Checklist, derivatives: Sequence[Mapping[tuple[int, ...], arb]], place: TorusPoint
) -> TorusCoefficients:
    """The pair crosses the circle with a speed that is not 0, and the first Lyapunov coefficient is not 0."""
    statement = "the absolute value of the multiplier has a derivative in the parameter that is not 0"
    with checklist.hypothesis("crossing", "25.9", statement, "smaller radii, or more precision") as evidence:
        found = coefficients_of_torus(derivatives, place.multiplier, place.eigenvector)
        evidence.record("derivative of the absolute value", found.speed)
        message = f"it is in {show(found.speed)}"
        evidence.require(excludes_zero(found.speed), message, needs_precision=True)
    statement = "the first Lyapunov coefficient is not 0"
    remedy = "more precision, larger radii for a better third derivative, or another parameter"
    with checklist.hypothesis("lyapunov", "25.10", statement, remedy) as evidence:
        evidence.record("first Lyapunov coefficient", found.lyapunov)
        message = f"it is in {show(found.lyapunov)}"
        evidence.require(excludes_zero(found.lyapunov), message, needs_precision=True)
    return found


def _results(
    claim: PeriodicBifurcation,
    found: BifurcationEnclosures,
    place: TorusPoint,
    others: Multipliers,
    coefficients: TorusCoefficients,
) -> TorusResults:
    assert claim.parameter is not None
    return TorusResults(
        dict(zip(claim.system.given_state, state_on_box(claim, list(place.where[:-1])), strict=True)),
        claim.parameter,
        enclose(claim.parameters[claim.parameter]) + place.where[-1],
        time_at(claim, found, place.where),
        place.multiplier,
        others,
        coefficients.speed,
        coefficients.lyapunov,
        # The product of two wide balls that are positive need not be.
        "below" if is_positive(coefficients.speed) == is_positive(coefficients.lyapunov) else "above",
        "subcritical" if is_positive(coefficients.lyapunov) else "supercritical",
    )
