"""Folds, period doublings and pitchforks of periodic orbits in a box, and what follows (sections 25.1 to 25.8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

from flint import acb, arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.claim import keeps_volume
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    Reason,
    concluded,
    enclose,
    excludes_zero,
    is_positive,
)
from orbitproof.verify.newton import is_regular
from orbitproof.verify.periodic import (
    Multipliers,
    check_coordinates,
    check_functions_of,
    check_integral,
    check_transversal,
    multipliers_of,
    on_level,
    state_on_box,
)
from orbitproof.verify.periodic_bifurcation.coefficients import Coefficients, flip_coefficients, fold_coefficients
from orbitproof.verify.periodic_bifurcation.enclosures import BifurcationEnclosures
from orbitproof.verify.periodic_bifurcation.equations import PointEquations, equations_of, sides_of
from orbitproof.verify.periodic_bifurcation.extended_system import BifurcationPoint, check_extended, multiplier_of
from orbitproof.verify.periodic_bifurcation.returns import check_last, check_least, check_returns, time_at
from orbitproof.verify.periodic_bifurcation.symmetry import check_mirrored, check_symmetry, signs_on_box


@dataclass(frozen=True)
class PeriodicBifurcationResults:
    """What is known of a proved bifurcation, in the units of its system.

    Attributes:
        point: enclosures of the state at the point in the box, by name.
        parameter_name, parameter: what varies, and its value at the bifurcation.
        period: the least period of the orbit there.
        known: the multiplier of the orbit that bifurcates, 1 or -1 exactly.
        multipliers: the others, and where they lie.
        side: the values of what varies for which there are the new orbits: above or below that of the bifurcation.
        opening: kappa: what varies differs from its value at the bifurcation by kappa y^2 + .. along the new orbits, in
            the units of Lemmas 25.2 and 25.3.
        criticality: of a doubling or a pitchfork without a first integral, whether the new orbits are where a
            multiplier of the old one lies outside the unit circle ("supercritical") or inside; `None` if not known.
        is_fixed: of a pitchfork, whether the orbit lies in Fix(S); if not, S moves it by half a period.
        level_name, level: the first integral; empty and `None` where the claim uses none, or where the level varies.
    """

    point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    period: arb
    known: Literal[1, -1]
    multipliers: Multipliers
    side: Literal["above", "below"]
    opening: arb
    criticality: Literal["supercritical", "subcritical"] | None = None
    is_fixed: bool | None = None
    level_name: Title = ""
    level: arb | None = None

    stored_rules: ClassVar = {"dependentRequired": {"level": ["level_name"]}}


@dataclass(frozen=True)
class PeriodicBifurcationTheorem:
    """The box of a claim contains exactly one bifurcation as claimed (Theorem 25.8)."""

    claim: PeriodicBifurcation

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        on_level, mirrored = self.claim.level is not None, self.claim.is_mirrored
        is_fold = self.claim.is_fold
        return (
            *(["functions"] if self.claim.system.defined else []),
            "section", *(["symmetry"] if mirrored else []), *(["first-integral"] if on_level else []), "direction",
            "return-map", "bifurcation", *(["last-coordinate"] if on_level else []),
            *([] if is_fold else ["curve"]), *(["mirrored"] if mirrored else []), "least-period", "side",
        )  # fmt: skip


def check_bifurcation_exactly(checklist: Checklist, claim: PeriodicBifurcation) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_functions_of(checklist, claim.system)
    check_coordinates(checklist, claim)
    if claim.is_mirrored:
        check_symmetry(checklist, claim)
    if claim.level is not None:
        check_integral(checklist, claim)
    check_transversal(checklist, claim)


def prove_periodic_bifurcation(
    claim: PeriodicBifurcation, checklist: Checklist, enclosures: BifurcationEnclosures | None
) -> Outcome[PeriodicBifurcationResults]:
    """Check that the box contains exactly one bifurcation as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> PeriodicBifurcationResults:
        found = check_returns(checklist, claim, enclosures)
        equations = equations_of(claim, found)
        place = check_extended(checklist, claim, equations)
        if claim.level is not None:
            check_last(checklist, claim, equations)
        if not claim.is_fold:
            _check_curve(checklist, claim, equations)
        is_fixed = check_mirrored(checklist, claim, place) if claim.is_mirrored else None
        check_least(checklist, claim, found.earlier, place.where)
        coefficients = _check_side(checklist, claim, equations, place)
        return _results(claim, found, equations, place, coefficients, is_fixed)

    theorem: PeriodicBifurcationTheorem | Reason = PeriodicBifurcationTheorem(claim)
    if claim.is_torus:
        theorem = Reason("theorem", f"{claim.kind} is about two multipliers", "claim another kind")
    return concluded(theorem, checklist, check)


def _check_curve(checklist: Checklist, claim: PeriodicBifurcation, equations: PointEquations) -> None:
    """The points that return at crossing m are a curve over the interval, at most one for each value."""
    statement = "1 is no multiplier of the map on the box: for each value of the interval at most one point returns"
    with checklist.hypothesis("curve", "25.5", statement, "smaller radii") as evidence:
        matrix = equations.minus(1, equations.slopes(sides_of(claim)))
        evidence.require(is_regular(matrix), "the derivative may be singular in the box", needs_precision=True)


def _check_side(
    checklist: Checklist, claim: PeriodicBifurcation, equations: PointEquations, place: BifurcationPoint
) -> Coefficients:
    """On which side of the bifurcation the new orbits are."""
    is_fold = claim.is_fold
    section = "25.4" if is_fold else "25.5"
    statement = "the coefficients of s and y^2 in the bifurcation equation are not 0"
    with checklist.hypothesis("side", section, statement, "smaller radii, or more precision") as evidence:
        (kernel,) = claim.kernel
        normal = [enclose(value) for value in kernel]
        found = (fold_coefficients if is_fold else flip_coefficients)(equations, place, normal)
        evidence.record("of s", found.speed)
        evidence.record("of y^2", found.bend)
        evidence.record("kappa", found.opening)
        for ball in (found.speed, found.bend, found.opening):
            evidence.require(excludes_zero(ball), "a coefficient may be 0", needs_precision=True)
    return found


def _results(
    claim: PeriodicBifurcation,
    found: BifurcationEnclosures,
    equations: PointEquations,
    place: BifurcationPoint,
    coefficients: Coefficients,
    is_fixed: bool | None,
) -> PeriodicBifurcationResults:
    system, varies = claim.system, claim.parameter is not None
    p, s = list(place.where[:-1]), place.where[-1]
    name = claim.parameter or system.first_integral_name or "H"
    middle = claim.parameters[claim.parameter] if claim.parameter is not None else claim.level
    assert middle is not None
    time = time_at(claim, found, place.where)
    on_a_level = claim.level is not None and varies
    return PeriodicBifurcationResults(
        dict(zip(system.given_state, state_on_box(claim, p), strict=True)),
        name,
        enclose(middle) + s,
        2 * time if is_fixed is False else time,
        1 if claim.is_fold or claim.is_mirrored else -1,
        _other_multipliers(claim, equations, place, is_fixed),
        "above" if is_positive(coefficients.opening) else "below",
        coefficients.opening,
        _criticality(claim, coefficients),
        is_fixed,
        (system.first_integral_name or "H") if on_a_level else "",
        enclose(claim.level) if on_a_level and claim.level is not None else None,
    )


def _criticality(
    claim: PeriodicBifurcation, coefficients: Coefficients
) -> Literal["supercritical", "subcritical"] | None:
    """Where a multiplier leaves the unit circle, if it is one alone (Lemma 25.4)."""
    if claim.is_fold or claim.level is not None or not excludes_zero(coefficients.pairing):
        return None
    same = is_positive(coefficients.bend) == is_positive(coefficients.pairing)
    return "supercritical" if same else "subcritical"


def _other_multipliers(
    claim: PeriodicBifurcation, equations: PointEquations, place: BifurcationPoint, is_fixed: bool | None
) -> Multipliers:
    """Multipliers other than 1 for the flow, 1 for the levels, and the one that bifurcates (section 25.7)."""
    system, sigma = claim.system, multiplier_of(claim)
    trivial = 1 if claim.level is None else 2
    matrix = [function.gradient(place.where, 0)[:-1] for function in equations.returns]
    if is_fixed:
        matrix = [[sign * ball for ball in row] for sign, row in zip(signs_on_box(claim) or (), matrix, strict=True)]
    kernel = list(place.kernel)
    dropped = equations.replaced
    if dropped is not None:
        matrix = on_level(matrix, equations.functions[dropped].gradient(place.where, 0)[:-1], dropped)
        kernel = [ball for position, ball in enumerate(kernel) if position != dropped]
    is_area = len(matrix) == 2 and keeps_volume(system)
    if is_area and is_fixed is None and len(system.given_state) == 2 + trivial:
        return Multipliers((acb(sigma),), 0, 1, 0, 0, trivial)
    rest = quotient(matrix, kernel)
    return multipliers_of(_squared(rest) if is_fixed is False else rest, trivial, keeps_volume=False)


def quotient(matrix: Sequence[Sequence[arb]], kernel: Sequence[arb]) -> list[list[arb]]:
    """A matrix on the quotient by an eigenvector, in the coordinates but one (Lemma 25.7)."""
    dropped = max(range(len(kernel)), key=lambda i: float(abs(kernel[i].mid())))
    kept = [i for i in range(len(kernel)) if i != dropped]
    return [[matrix[i][j] - kernel[i] / kernel[dropped] * matrix[dropped][j] for j in kept] for i in kept]


def _squared(matrix: Sequence[Sequence[arb]]) -> list[list[arb]]:
    columns = list(zip(*matrix, strict=True))
    return [[sum((a * b for a, b in zip(row, column, strict=True)), arb(0)) for column in columns] for row in matrix]
