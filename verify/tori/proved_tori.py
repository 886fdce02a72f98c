"""Invariant tori accumulate at a symmetric orbit: hypotheses and results (sections 30.1 to 30.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Annotated

from flint import acb, arb

from orbitproof.shared.formats import INVARIANT_TORI, Candidate
from orbitproof.shared.stored import rules
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    Reason,
    all_finite,
    concluded,
    excludes_zero,
    is_positive,
    show,
)
from orbitproof.verify.newton import Jet
from orbitproof.verify.orbit import OrbitResults, OrbitTheorem, check_orbit, full_return_jets, half_return_jets
from orbitproof.verify.tori.following import ToriEnclosures
from orbitproof.verify.tori.normal_form import (
    COMBINATIONS,
    EllipticPoint,
    combination,
    determinant_of,
    elliptic_point,
    in_coordinates,
    torsion,
    trace_and_determinant,
)

_N = 2
Pair = Annotated[tuple[arb, ...], rules(minItems=2, maxItems=2)]


@dataclass(frozen=True, kw_only=True)
class ToriResults(OrbitResults):
    """What is known of the orbit, and of the full return at its first point.

    Attributes:
        rotation_numbers: omega_j / (2 pi) in (0, 1/2), with multipliers exp(i omega_j); omega_1 > omega_2.
        torsion: tau_jl, rows, in the coordinates z of Lemma 30.1 with rows a of length 1.
        torsion_determinant: of tau; not 0. Its sign does not depend on the lengths of the z_j.
    """

    rotation_numbers: Pair
    torsion: Annotated[tuple[Pair, ...], rules(minItems=2, maxItems=2)]
    torsion_determinant: arb


@dataclass(frozen=True)
class ToriTheorem:
    """The orbit that the box contains is accumulated by invariant tori (Theorem 30.5)."""

    claim: Candidate

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return (*OrbitTheorem(self.claim).hypotheses, "full-return", "elliptic", "non-resonance", "torsion")


def theorem_of_tori(candidate: Candidate) -> ToriTheorem | Reason:
    """The theorem that a candidate claims, or why none applies: it is about two pairs of multipliers."""
    n = len(candidate.system.kernel_coordinates)
    if candidate.kind != INVARIANT_TORI or n != _N:
        return Reason(
            "theorem", f"the theorem is about n = {_N}, and {candidate.system.name} has n = {n}", "claim an orbit"
        )
    return ToriTheorem(candidate)


def prove_tori(candidate: Candidate, checklist: Checklist, enclosures: ToriEnclosures | None) -> Outcome[ToriResults]:
    """Check that invariant tori accumulate at the one orbit of a box, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> ToriResults:
        orbit = check_orbit(checklist, candidate, enclosures)
        assert enclosures is not None
        jets = _check_full_return(checklist, candidate, enclosures)
        point = _check_elliptic(checklist, jets)
        _check_resonances(checklist, point)
        tau, determinant = _check_torsion(checklist, jets, point)
        known = {each.name: getattr(orbit, each.name) for each in fields(OrbitResults)}
        angles = [s.acos() / (2 * arb.pi()) for s in point.cosines]
        return ToriResults(**known, rotation_numbers=tuple(angles), torsion=tau, torsion_determinant=determinant)

    return concluded(theorem_of_tori(candidate), checklist, check)


def _check_full_return(checklist: Checklist, candidate: Candidate, found: ToriEnclosures) -> tuple[Jet, ...]:
    """Jets of the full return on the level of the orbit."""
    statement = "the half return is regular in coordinates of the level, and has finite derivatives up to order 3"
    with checklist.hypothesis("full-return", "30.1", statement, "smaller radii or more precision") as evidence:
        half = found.half_return
        there = half.is_complete(_N, candidate.system.first_integral is not None)
        evidence.require(there, "a derivative is missing")
        try:
            out = half_return_jets(candidate, half) if there else ()
            evidence.record("determinant of the derivative of the half return", determinant_of(out))
            jets = full_return_jets(out) if there else ()
        except ZeroDivisionError:
            evidence.require(False, "it may be singular", needs_precision=True)
            jets = ()
        balls = [value for jet in jets for value in jet.coefficients.values()]
        evidence.require(all_finite(balls), "an enclosure is not finite", needs_precision=True)
    return jets


def _check_elliptic(checklist: Checklist, jets: Sequence[Jet]) -> EllipticPoint:
    """Two different cosines in (-1, 1)."""
    statement = "both stability parameters are real, in (-1, 1), and different"
    remedy = "claim an orbit that is linearly stable"
    with checklist.hypothesis("elliptic", "30.2", statement, remedy) as evidence:
        trace, determinant = trace_and_determinant(jets)
        quantities = {
            "discriminant": trace * trace - 4 * determinant,
            "(1 - s_1)(1 - s_2)": 1 - trace + determinant,
            "(1 + s_1)(1 + s_2)": 1 + trace + determinant,
            "2 - s_1 - s_2": 2 - trace,
            "2 + s_1 + s_2": 2 + trace,
        }
        for name, value in quantities.items():
            evidence.record(name, value)
            message = f"{name} is in {show(value)}, which is not positive"
            evidence.require(is_positive(value), message, needs_precision=not is_positive(-value))
    return elliptic_point(jets)


def _check_resonances(checklist: Checklist, point: EllipticPoint) -> None:
    """No combination of the two angles up to order 4 is a multiple of 2 pi."""
    statement = "k_1 omega_1 + k_2 omega_2 is no multiple of 2 pi for 0 < |k_1| + |k_2| <= 4"
    remedy = "claim an orbit away from resonances of order at most 4"
    with checklist.hypothesis("non-resonance", "30.2", statement, remedy) as evidence:
        for k in COMBINATIONS:
            distance = evidence.record(f"distance for k = ({k[0]}, {k[1]})", abs(combination(point.multipliers, k) - 1))
            message = f"for k = ({k[0]}, {k[1]}) it may be one"
            evidence.require(is_positive(distance), message, needs_precision=True)


def _check_torsion(
    checklist: Checklist, jets: Sequence[Jet], point: EllipticPoint
) -> tuple[tuple[tuple[arb, arb], ...], arb]:
    """The torsion of the normal form is regular; what reversibility says of it is not contradicted."""
    statement = "the determinant of the torsion is not 0"
    remedy = "more precision or smaller radii, or an orbit at which the torsion does not degenerate"
    with checklist.hypothesis("torsion", "30.4", statement, remedy) as evidence:
        found = torsion(in_coordinates(jets, point), point.multipliers)
        for j, row in enumerate(found, start=1):
            for position, value in enumerate(row, start=1):
                evidence.record(f"tau_{j}{position}", value.imag)
                evidence.record(f"real part that vanishes, {j}{position}", value.real)
                evidence.require(not excludes_zero(value.real), "the map is not shown to be reversible")
        tau = _real(found)
        determinant = evidence.record("determinant", tau[0][0] * tau[1][1] - tau[0][1] * tau[1][0])
        message = f"it is in {show(determinant)}"
        evidence.require(excludes_zero(determinant), message, needs_precision=True)
    return tau, determinant


def _real(found: Sequence[Sequence[acb]]) -> tuple[tuple[arb, arb], ...]:
    return tuple((row[0].imag, row[1].imag) for row in found)
