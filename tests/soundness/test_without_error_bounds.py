"""An integrator that claims to be exact: what it proves is false, and containment tests find it."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import ctx
from support.claims import (
    ACCURACY,
    coordinates_in_box,
    distances,
    known,
    to_the_end,
    verdict_of,
)
from support.flow_checks import contains, initial_state, kernel_values, orbits

import orbitproof.verify.certificate.certifying
import orbitproof.verify.flow.step
from orbitproof.shared.claims import Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.evidence import exact_value
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import Enclosures, IntegratorSettings, enclose_iterates

LITTLE = 1e-250
HONEST = orbitproof.verify.flow.step._tube


def without_errors(*arguments: Any) -> Any:
    """What `verify.flow.step` finds, with every error bound replaced by one that is as good as zero."""
    bound, slopes = HONEST(*arguments)
    return np.full_like(bound, LITTLE), slopes


LOW = Limits(max_precision=64, digits=5)
WIDE = (Fraction(1, 2**14), Fraction(1, 2**30))


def low_precision_certificate(claim: Candidate) -> Certificate:
    """The verdict at 64 bits, which are too few for anything here, on claims that are followed to the end."""
    return certify(claim, LOW, integrate=to_the_end)


def false_claim(monkeypatch: pytest.MonkeyPatch) -> tuple[Candidate, Certificate]:
    """A box around the bifurcation that the sabotaged integrator sees, without the true one, and its verdict."""
    with monkeypatch.context() as patch:
        patch.setattr(orbitproof.verify.flow.step, "_tube", without_errors)
        seen = low_precision_certificate(replace(known("fs3"), radii=WIDE))
        assert verdict_of(seen) == "proved"
        middle = tuple(exact_value(ball.mid()) for ball in seen.point.values())
        claim = replace(known("fs3"), centre=middle)
        truth = coordinates_in_box(claim, known("fs3").centre)
        # What the sabotaged integrator sees moves by rounding errors with the radii: not every such box holds it.
        for fraction in range(8, 20):
            radii = (round_dyadic(abs(truth[0]) / 3, 20), round_dyadic(abs(truth[1]) / fraction, 20))
            claim = replace(claim, radii=radii)
            certificate = low_precision_certificate(claim)
            if verdict_of(certificate) == "proved":
                break
        return claim, certificate


def test_without_error_bounds_something_false_is_claimed_and_the_sound_integrator_refuses_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    claim, sabotaged = false_claim(monkeypatch)
    truth = coordinates_in_box(claim, known("fs3").centre)
    assert all(abs(value) > 2 * radius for value, radius in zip(truth, claim.radii, strict=True))
    assert verdict_of(sabotaged) == "proved"
    assert min(distances(sabotaged, known("fs3").centre)) > ACCURACY
    assert low_precision_certificate(claim).verdict == "not proved"
    assert verdict_of(certify(claim, Limits(max_precision=256))) == "family"


@pytest.mark.parametrize("name", ["fs2", "fs4"])
def test_without_error_bounds_enclosures_contradict_each_other(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """G_01 and G_01 + G_11 p_1' are equal at the point because G_11 = 0 there; false enclosures need not meet."""
    monkeypatch.setattr(orbitproof.verify.flow.step, "_tube", without_errors)
    certificate = low_precision_certificate(replace(known(name), radii=WIDE))
    assert verdict_of(certificate) == "G_01"
    assert "disjoint" in certificate.reason.message


def holds_for_the_centre(claim: Candidate, found: Enclosures) -> bool:
    """Whether the enclosures contain the orbit of the centre, integrated independently at 200 bits."""
    crossings = orbits(claim.system, 200).crossings(*initial_state(claim, (Fraction(0), Fraction(0))), claim.k)
    tolerance = Fraction(1, 2**150)
    with ctx.workprec(300):
        return all(
            contains(table.centre[0, 0], value, tolerance)
            for crossing, tables in zip(crossings, found.iterates, strict=True)
            for table, value in zip(tables, kernel_values(claim, crossing.state), strict=True)
        )


def test_containment_catches_an_integrator_without_error_bounds(monkeypatch: pytest.MonkeyPatch) -> None:
    claim = replace(known("fs3"), radii=WIDE)
    assert holds_for_the_centre(claim, enclose_iterates(claim, IntegratorSettings(64), ORACLE))
    monkeypatch.setattr(orbitproof.verify.flow.step, "_tube", without_errors)
    assert not holds_for_the_centre(claim, enclose_iterates(claim, IntegratorSettings(64), ORACLE))
