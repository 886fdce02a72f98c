"""Krein collisions: hypotheses and results (sections 31.1 to 31.5)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from flint import arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import KREIN_COLLISION, Candidate
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    Reason,
    all_finite,
    concluded,
    dot,
    excludes_zero,
    is_positive,
    show,
    symmetric,
)
from orbitproof.verify.krein.equations import SIZE, CollisionEquations, equations_of
from orbitproof.verify.krein.normal_form import cubic_coefficient
from orbitproof.verify.newton import Jet, enclose_zero, is_regular, newton_image
from orbitproof.verify.newton.jets import unit
from orbitproof.verify.orbit import full_return_jets
from orbitproof.verify.poincare import IntegratorSettings, WideOracle, check_half_orbit
from orbitproof.verify.reversor_breaking import (
    BreakingEnclosures,
    both_points,
    check_curve,
    check_half_return,
    check_maps_exactly,
    check_sheet,
    enclose_breaking,
    not_about_maps,
    parameter_of,
    period_of,
)


@dataclass(frozen=True)
class KreinResults:
    """What is known of a proved collision, in nondimensional units.

    Attributes:
        point, other_point: enclosures of the two points of the orbit on Fix(R), by coordinate name.
        parameter_name, parameter: what varies, and its value at the collision.
        side: the values next to it for which the orbits are linearly stable: above or below.
        type: whether b > 0 or b < 0 (section 31.4).
        period: the least period of the orbit.
        cosine: s, the double eigenvalue of Sigma; in (-1, 1).
        rotation_number: omega / (2 pi) in (0, 1/2), s = cos omega.
        speed: the derivative of the discriminant of Sigma along the curve of symmetric orbits.
        unfolding, coefficient: a and b of Lemma 31.3; the sign of b does not depend on coordinates.
    """

    point: Mapping[str, arb]
    other_point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    side: Literal["above", "below"]
    type: Literal["subcritical", "supercritical"]
    period: arb
    cosine: arb
    rotation_number: arb
    speed: arb
    unfolding: arb
    coefficient: arb


@dataclass(frozen=True)
class KreinTheorem:
    """The box of a claim contains exactly one Krein collision, and its type is known (Theorem 31.5)."""

    claim: Candidate

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        on_level, later = self.claim.uses_level, self.claim.crossings > 1
        return (
            "symmetries", "frames", *(["level"] if on_level else []), "poincare-map",
            *(["half-orbit"] if later else []), *(["sheet"] if on_level else []), "curve", "regular", "point",
            "circle", "non-resonance", "side", "type",
        )  # fmt: skip


def theorem_of_krein(candidate: Candidate) -> KreinTheorem | Reason:
    """The theorem that a candidate claims, or why none applies."""
    n = len(candidate.kernel_frame)
    if candidate.kind != KREIN_COLLISION:
        return Reason("theorem", f"{candidate.kind} is about other points", "claim another kind")
    if n != SIZE:
        message = f"two pairs of multipliers are needed, {candidate.system.name} has {n}"
        return Reason("theorem", message, "claim another kind")
    return not_about_maps(candidate) or KreinTheorem(candidate)


def check_krein_exactly(checklist: Checklist, candidate: Candidate) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_maps_exactly(checklist, candidate, theorem_of_krein(candidate))


def enclose_krein(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: WideOracle,
    progress: Callable[[float], None] | None = None,
) -> BreakingEnclosures:
    """Follow the box of a candidate, and points beside it, with all derivatives. As `enclose_breaking`."""
    return enclose_breaking(candidate, settings, oracle, progress, alike=True)


def prove_krein(
    candidate: Candidate, checklist: Checklist, enclosures: BreakingEnclosures | None
) -> Outcome[KreinResults]:
    """Check that there is one collision in the box, and of which type, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> KreinResults:
        found = check_half_return(checklist, candidate, enclosures)
        check_half_orbit(checklist, found.iterates[:-1])
        if candidate.uses_level:
            check_sheet(checklist, candidate, found)
        equations, sides = equations_of(found), [symmetric(radius) for radius in candidate.radii]
        check_curve(checklist, candidate, equations.slopes(sides))
        _check_regular(checklist, equations, sides)
        where = _check_point(checklist, candidate, equations)
        jets = full_return_jets(equations.jets(where))
        cosine = _check_circle(checklist, jets)
        _check_resonances(checklist, cosine)
        speed = _check_side(checklist, equations, where)
        coefficient = _check_type(checklist, jets, cosine)
        return _results(candidate, found, where, cosine, speed, coefficient)

    return concluded(theorem_of_krein(candidate), checklist, check)


def _check_regular(checklist: Checklist, equations: CollisionEquations, sides: list[arb]) -> None:
    """The derivative of the half return is regular, so that Sigma is a function on the box."""
    statement = "the derivative of the half return at fixed p_0 is regular on the box"
    with checklist.hypothesis("regular", "31.2", statement, "smaller radii or more precision") as evidence:
        half = equations.half(sides)
        evidence.record("its determinant", half.det())
        size = range(2 * SIZE)
        regular = is_regular([[half[i, j] for j in size] for i in size])
        evidence.require(regular, "it may be singular in the box", needs_precision=True)


def _check_point(checklist: Checklist, candidate: Candidate, equations: CollisionEquations) -> list[arb]:
    """One zero of (pi_q P^m, discriminant of Sigma) in the box."""
    power = "P" if candidate.crossings == 1 else f"P^{candidate.crossings}"
    statement = f"interval Newton: pi_q {power} = 0 and (tr Sigma)^2 - 4 det Sigma = 0 have one solution inside the box"
    remedy = "move the centre to the point, or choose smaller radii"
    with checklist.hypothesis("point", "31.2", statement, remedy) as evidence:
        zero = [arb(0) for _ in candidate.radii]
        residual = [*equations.values(zero), equations.discriminant(zero)]
        names = [f"p_{place}" for place in range(len(zero))]
        where = enclose_zero(evidence, equations.matrix, residual, candidate.radii, names)
    return where


def _check_circle(checklist: Checklist, jets: Sequence[Jet]) -> arb:
    """The double eigenvalue of Sigma is in (-1, 1): the multipliers are on the unit circle, and not 1 or -1."""
    statement = "the double eigenvalue s of Sigma lies in (-1, 1)"
    remedy = "nothing: these multipliers do not meet on the unit circle"
    with checklist.hypothesis("circle", "31.2", statement, remedy) as evidence:
        balls = [value for jet in jets for value in jet.coefficients.values()]
        evidence.require(all_finite(balls), "a derivative of the full return is not finite", needs_precision=True)
        cosine = evidence.record("s", (jets[0][unit(2 * SIZE, 0)] + jets[1][unit(2 * SIZE, 1)]) / 2)
        rest = 1 - cosine * cosine
        evidence.require(is_positive(rest), f"s is in {show(cosine)}", needs_precision=not is_positive(-rest))
    return cosine


def _check_resonances(checklist: Checklist, cosine: arb) -> None:
    """lambda^k is not 1 for k <= 4."""
    statement = "lambda^3 and lambda^4 are not 1: s is neither -1/2 nor 0"
    remedy = "nothing: the theorem is about other collisions"
    with checklist.hypothesis("non-resonance", "31.3", statement, remedy) as evidence:
        evidence.require(excludes_zero(evidence.record("2 s + 1", 2 * cosine + 1)), "s may be -1/2", True)
        evidence.require(excludes_zero(evidence.record("s", cosine)), "s may be 0", True)


def _check_side(checklist: Checklist, equations: CollisionEquations, where: list[arb]) -> arb:
    """The derivative of the discriminant along the curve of symmetric orbits is not 0."""
    statement = "the discriminant of Sigma has a derivative other than 0 along the curve of symmetric orbits"
    with checklist.hypothesis("side", "31.2", statement, "more precision") as evidence:
        *rows, last = equations.matrix(where)
        along = [arb(1), *newton_image([row[1:] for row in rows], [row[0] for row in rows])]
        speed = evidence.record("its derivative", dot(last, along))
        evidence.require(excludes_zero(speed), "it may vanish", needs_precision=True)
    return speed


def _check_type(checklist: Checklist, jets: Sequence[Jet], cosine: arb) -> arb:
    """b is not 0; that it is real, as reversibility says, is not contradicted."""
    statement = "the coefficient b of the normal form of order 3 is not 0"
    remedy = "more precision or smaller radii, or nothing where it degenerates"
    with checklist.hypothesis("type", "31.3", statement, remedy) as evidence:
        found = cubic_coefficient(jets, cosine)
        evidence.record("b", found.real)
        evidence.record("imaginary part that vanishes", found.imag)
        evidence.require(not excludes_zero(found.imag), "the map is not shown to be reversible")
        evidence.require(excludes_zero(found.real), f"b is in {show(found.real)}", needs_precision=True)
    coefficient: arb = found.real
    return coefficient


def _results(
    candidate: Candidate, found: BreakingEnclosures, where: list[arb], cosine: arb, speed: arb, coefficient: arb
) -> KreinResults:
    point, other_point = both_points(candidate, found, where)
    return KreinResults(
        point,
        other_point,
        candidate.titles[0],
        parameter_of(candidate, where),
        "above" if is_positive(speed) else "below",
        "subcritical" if is_positive(coefficient) else "supercritical",
        period_of(found, where),
        cosine,
        cosine.acos() / (2 * arb.pi()),
        speed,
        -speed / (4 * (1 - cosine * cosine)),
        coefficient,
    )
