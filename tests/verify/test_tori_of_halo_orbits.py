"""Invariant tori near halo orbits: proved of a near-rectilinear one, from both of its points; refused of others."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from flint import arb
from support.balls import agree

from orbitproof.shared.formats import INVARIANT_TORI, Candidate, read_candidates
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.certificate import Certificate, Limits, certify
from orbitproof.verify.evidence import exact_value
from orbitproof.verify.tori import ToriResults

DATA = Path(__file__).resolve().parents[1] / "data"
LIMITS = Limits(digits=10)
CLAIM = read_candidates(DATA / "tori-candidates.json")[0]

pytestmark = pytest.mark.slow


def results(claim: Candidate) -> ToriResults:
    proof = certify(claim, LIMITS)
    assert isinstance(proof.results, ToriResults), proof.reason
    return proof.results


def invariant(found: ToriResults) -> arb:
    """tau_12 tau_21 / (tau_11 tau_22), which no choice of coordinates changes (Lemma 30.4)."""
    tau = found.torsion
    return tau[0][1] * tau[1][0] / (tau[0][0] * tau[1][1])


def test_both_points_of_an_orbit_have_the_same_torsion() -> None:
    here = results(CLAIM)
    bits, radius = 160, Fraction(1, 2**80)
    centre = tuple(round_dyadic(exact_value(ball.mid()), bits) for ball in here.other_point.values())
    there = results(replace(CLAIM, centre=centre, radii=(radius,) * 3))
    assert agree(invariant(here), invariant(there))
    for found in (here, there):
        assert float(invariant(found).rad()) < 1e-3
    assert all(agree(a, b) for a, b in zip(here.rotation_numbers, there.rotation_numbers, strict=True))
    for rotation, parameter in zip(here.rotation_numbers, here.stability.parameters, strict=True):
        assert agree((2 * rotation).cos_pi(), parameter.real)


def test_of_an_orbit_with_a_multiplier_off_the_circle_nothing_is_proved() -> None:
    halo = read_candidates(DATA / "orbit-candidates.json")[0]
    assert certify(halo, LIMITS).proved
    proof: Certificate = certify(replace(halo, kind=INVARIANT_TORI), LIMITS)
    assert not proof.proved
    assert proof.reason is not None
    assert proof.reason.condition == "elliptic"
