"""Births of orbits that R does not map to themselves: hypotheses and results (sections 27.2 to 27.6)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from flint import arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim import (
    LevelEquation,
    check_frames,
    check_level,
    check_symmetries,
    inverse,
    on_box,
    point_on_fixed_set,
)
from orbitproof.verify.evidence import (
    MAX_ORDER,
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    Outcome,
    Reason,
    all_finite,
    concluded,
    dot,
    enclose,
    excludes_zero,
    indices_up_to,
    is_positive,
    symmetric,
)
from orbitproof.verify.newton import BoxFunction, enclose_zero, is_regular
from orbitproof.verify.poincare import check_half_orbit
from orbitproof.verify.reversor_breaking.equations import Coefficients, LossEquations, equations_of
from orbitproof.verify.reversor_breaking.following import BreakingEnclosures, variables_of


@dataclass(frozen=True)
class BreakingResults:
    """What is known of a proved birth, in nondimensional units.

    Attributes:
        point, other_point: enclosures of the two points of the symmetric orbit on Fix(R), by coordinate name.
        parameter_name, parameter: what varies, and its value at the birth.
        side: the values for which there are the two new orbits: above or below that of the birth.
        period: the least period of the symmetric orbit.
        direction: of the new orbits from Fix(R), by the names of the coordinates that R negates: q = y direction + ..
        opening: kappa: what varies differs from its value at the birth by kappa y^2 + .. along the new orbits.
        gamma, beta: the coefficients of Lemma 27.2.
    """

    point: Mapping[str, arb]
    other_point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    side: Literal["above", "below"]
    period: arb
    direction: Mapping[str, arb]
    opening: arb
    gamma: arb
    beta: arb


@dataclass(frozen=True)
class BreakingTheorem:
    """The box of a claim contains exactly one point at which R is lost, and two orbits are born (Theorem 27.3)."""

    claim: Candidate

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        on_level, later = self.claim.uses_level, self.claim.crossings > 1
        return (
            "symmetries", "frames", *(["level"] if on_level else []), "poincare-map",
            *(["half-orbit"] if later else []), *(["sheet"] if on_level else []), "curve", "kernel", "point", "side",
        )  # fmt: skip


def theorem_of(candidate: Candidate) -> BreakingTheorem | Reason:
    """The theorem that a candidate claims, or why none applies."""
    if not candidate.loses_reversor:
        return Reason("theorem", f"{candidate.kind} is about symmetric orbits", "claim another kind")
    return not_about_maps(candidate) or BreakingTheorem(candidate)


def not_about_maps(candidate: Candidate) -> Reason | None:
    """Why no theorem about a family of half returns applies to a candidate, if none does."""
    system = candidate.system
    if not candidate.is_family_of_maps:
        message = "the points of the box have no common parameter"
        return Reason("theorem", message, "claim it with the first integral as parameter (section 27.1)")
    if system.normalised:
        return Reason("theorem", f"{system.name} is a form of other orbits", "claim it in the original coordinates")
    return None


def check_breaking_exactly(checklist: Checklist, candidate: Candidate) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_maps_exactly(checklist, candidate, theorem_of(candidate))


def check_maps_exactly(checklist: Checklist, candidate: Candidate, theorem: object) -> None:
    """The theorem about a family of half returns, or the reason why there is none."""
    if isinstance(theorem, Reason):
        raise NotEstablishedError(theorem)
    check_symmetries(checklist, candidate.system, None)
    check_frames(checklist, candidate)
    if candidate.uses_level:
        check_level(checklist, candidate)


def prove_breaking(
    candidate: Candidate, checklist: Checklist, enclosures: BreakingEnclosures | None
) -> Outcome[BreakingResults]:
    """Check that R is lost at exactly one point of the box, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> BreakingResults:
        found = check_half_return(checklist, candidate, enclosures)
        check_half_orbit(checklist, found.iterates[:-1])
        if candidate.uses_level:
            check_sheet(checklist, candidate, found)
        equations = equations_of(found)
        check_curve(checklist, candidate, equations.slopes(_sides(candidate)))
        _check_kernel(checklist, candidate, equations)
        where = _check_point(checklist, candidate, equations)
        coefficients = _check_side(checklist, equations, where)
        return _results(candidate, found, equations, where, coefficients)

    return concluded(theorem_of(candidate), checklist, check)


def _power(candidate: Candidate) -> str:
    return "P" if candidate.crossings == 1 else f"P^{candidate.crossings}"


def _sides(candidate: Candidate) -> list[arb]:
    return [symmetric(radius) for radius in candidate.radii]


def check_half_return(
    checklist: Checklist, candidate: Candidate, found: BreakingEnclosures | None
) -> BreakingEnclosures:
    """Every enclosure that is used is there and finite, and the half period is positive."""
    m, n = candidate.crossings, len(candidate.kernel_frame)
    power = "P exists" if m == 1 else f"P, .., P^{m} exist"
    statement = f"{power} on the box and beside it, with finite enclosures of derivatives in p and q to order 3"
    with checklist.hypothesis("poincare-map", "27.4", statement, "smaller radii or more precision") as evidence:
        evidence.require(found is not None, "there are no enclosures")
        if found is not None:
            shape = *(len(components) for components in found.iterates), len(found.image), len(found.sheet)
            evidence.require(shape == (*[n] * m, n, int(candidate.uses_level)), "an iterate or a component is missing")
            indices = indices_up_to(variables_of(candidate), MAX_ORDER)
            parts = [part for table in found.tables for part in (table.box, table.centre)]
            complete = all(set(indices) == set(part) for part in parts)
            evidence.require(complete, "a derivative is missing")
            balls = [*found.sheet, *(ball for part in parts for ball in part.values())]
            evidence.require(all_finite(balls), "an enclosure is not finite", needs_precision=True)
            if complete:
                meet = all(part.box[i].overlaps(part.centre[i]) is True for part in found.tables for i in indices)
                evidence.require(meet, "an enclosure at the centre is disjoint from that over the box")
                time = evidence.record(f"time of crossing {m}", found.half_period.box[(0,) * variables_of(candidate)])
                evidence.require(is_positive(time), "the half period is not positive", needs_precision=True)
    assert found is not None
    return found


def _slope_at_images(candidate: Candidate, found: BreakingEnclosures) -> arb:
    """The derivative of H in the level coordinate w, by w, p' and q of all images."""
    system, zero = candidate.system, (0,) * variables_of(candidate)
    along = [table.box[zero] for table in found.image]
    across = [table.box[zero] for table in found.iterates[-1]]
    kernel = [dot([enclose(value) for value in row], across) for row in inverse(candidate.kernel_frame) or ()]
    named = dict(zip(candidate.coordinates[1:], along, strict=True))
    named |= {system.state[i]: ball for i, ball in zip(system.kernel_coordinates, kernel, strict=True)}
    return LevelEquation.of(system).at(on_box(candidate, named), found.sheet[0])[1]


def check_sheet(checklist: Checklist, candidate: Candidate, found: BreakingEnclosures) -> None:
    """The level coordinate follows from the level at the images too: the others are coordinates of the level there."""
    name, level = candidate.system.level_coordinate, candidate.system.fixed_level
    if level is not None and level.between is not None:
        statement = f"the derivative of the first integral in {name} is not 0 at the image of the box under "
        statement += _power(candidate)
        with checklist.hypothesis("sheet", "27.1", statement, "claim the other point of the orbit") as evidence:
            slope = _slope_at_images(candidate, found)
            evidence.record(f"dH/d{name}", slope)
            evidence.require(excludes_zero(slope), "it may vanish", needs_precision=True)
        return
    statement = f"{name} has one sign at the image of the box under {_power(candidate)}"
    with checklist.hypothesis("sheet", "27.1", statement, "claim the other point of the orbit") as evidence:
        (value,) = found.sheet
        evidence.record(f"{name} of {_power(candidate)}", value)
        evidence.require(excludes_zero(value), "it may vanish", needs_precision=True)


def check_curve(checklist: Checklist, candidate: Candidate, slopes: list[list[arb]]) -> None:
    """C is regular: for each value of the parameter at most one symmetric point; `slopes` of pi_q P^m over the box."""
    power = _power(candidate)
    statement = (
        f"C = D_(p_1, ..) pi_q {power} is regular on the box: for each p_0 at most one point has {power} in Fix(R)"
    )
    remedy = "claim a fold or a symmetry breaking where curves of symmetric orbits turn or meet, or smaller radii"
    with checklist.hypothesis("curve", "27.2", statement, remedy) as evidence:
        matrix = [row[1:] for row in slopes]
        for row, entries in enumerate(matrix, start=1):
            for place, ball in enumerate(entries, start=1):
                evidence.record(f"d q_{row} / d p_{place}", ball)
        evidence.require(is_regular(matrix), "it may be singular in the box", needs_precision=True)


def _check_kernel(checklist: Checklist, candidate: Candidate, equations: LossEquations) -> None:
    """B has corank one at most, with a kernel on which q_1 does not vanish."""
    name = f"e_{equations.column + 1}"
    statement = f"B = D_q p' o {_power(candidate)}, bordered by {name} and by the first unit row, is regular on the box"
    remedy = "give a kernel_frame whose first row does not vanish on the kernel of B, or smaller radii"
    with checklist.hypothesis("kernel", "27.3", statement, remedy) as evidence:
        matrix = equations.crossing(_sides(candidate))
        for row, entries in enumerate(matrix, start=1):
            for place, ball in enumerate(entries, start=1):
                evidence.record(f"d p_{row} / d q_{place}", ball)
        regular = is_regular(equations.bordered(_sides(candidate)))
        evidence.require(regular, "it may be singular in the box", needs_precision=True)


def _check_point(checklist: Checklist, candidate: Candidate, equations: LossEquations) -> list[arb]:
    """One zero of (pi_q P^m, g) in the box."""
    power = _power(candidate)
    statement = f"interval Newton: pi_q {power} = 0 and g = 0, where B is singular, have one solution inside the box"
    remedy = "move the centre to the point, or choose smaller radii"
    with checklist.hypothesis("point", "27.3", statement, remedy) as evidence:
        zero = [arb(0) for _ in candidate.radii]
        residual = [*equations.values(zero), equations.kernel_over(zero).defect]
        names = [f"p_{place}" for place in range(len(zero))]
        where = enclose_zero(evidence, equations.matrix, residual, candidate.radii, names)
    return where


def _check_side(checklist: Checklist, equations: LossEquations, where: list[arb]) -> Coefficients:
    """On which side of the birth the new orbits are."""
    statement = "the coefficients gamma and beta of the bifurcation equation are not 0"
    with checklist.hypothesis("side", "27.5", statement, "smaller radii, or more precision") as evidence:
        found = equations.coefficients(where)
        evidence.record("gamma", found.gamma)
        evidence.record("beta", found.beta)
        evidence.record("kappa", found.opening)
        for ball in (found.gamma, found.beta, found.opening):
            evidence.require(excludes_zero(ball), "a coefficient may be 0", needs_precision=True)
    return found


def _results(
    candidate: Candidate,
    found: BreakingEnclosures,
    equations: LossEquations,
    where: list[arb],
    coefficients: Coefficients,
) -> BreakingResults:
    system = candidate.system
    point, other_point = both_points(candidate, found, where)
    rows = inverse(candidate.kernel_frame) or []
    right = equations.kernel_over(where).right
    names = [system.state[index] for index in system.kernel_coordinates]
    return BreakingResults(
        point,
        other_point,
        candidate.titles[0],
        parameter_of(candidate, where),
        "above" if is_positive(coefficients.opening) else "below",
        period_of(found, where),
        {name: dot([enclose(value) for value in row], right) for name, row in zip(names, rows, strict=True)},
        coefficients.opening,
        coefficients.gamma,
        coefficients.beta,
    )


def both_points(
    candidate: Candidate, found: BreakingEnclosures, where: Sequence[arb]
) -> tuple[Mapping[str, arb], Mapping[str, arb]]:
    """The points of Fix(R) with p in `where` and their images, by coordinate name."""
    point = {
        name: enclose(origin) + dot([enclose(value) for value in row], where)
        for name, origin, row in zip(candidate.coordinates, candidate.centre, candidate.frame, strict=True)
    }
    first, *others = candidate.coordinates
    image = {first: point[first]}
    image |= {name: _value(table, where) for name, table in zip(others, found.image, strict=True)}
    return _on_fixed_set(candidate, point), _on_fixed_set(_on_other_sheet(candidate, found), image)


def parameter_of(candidate: Candidate, where: Sequence[arb]) -> arb:
    """h at points with p in `where`, row 0 of the frame being (1, 0, .., 0)."""
    return enclose(candidate.centre[0]) + where[0]


def period_of(found: BreakingEnclosures, where: Sequence[arb]) -> arb:
    """The period of the orbits of these points, if they are symmetric."""
    return 2 * _value(found.half_period, where)


def _value(table: DerivativeTable, where: Sequence[arb]) -> arb:
    return BoxFunction(table).value([*where, *(arb(0) for _ in where[1:])])


def _on_fixed_set(candidate: Candidate, point: Mapping[str, arb]) -> Mapping[str, arb]:
    return point if candidate.level_sign is None else point_on_fixed_set(candidate, point)


def _on_other_sheet(candidate: Candidate, found: BreakingEnclosures) -> Candidate:
    if candidate.level_sign is None:
        return candidate
    (value,) = found.sheet
    return replace(candidate, level_sign=1 if is_positive(value) else -1)
