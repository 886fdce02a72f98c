"""Orbits that are stable for ever: closed forms, rotation numbers in floats, refusals, forgeries."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any, Literal

import mpmath
import numpy as np
import pytest
from flint import arb
from support.balls import agree
from support.springs import BITS, SMALL, SPRINGS, contains, half, spring

import orbitproof.verify.twist.proved_stable_orbit as proved
from orbitproof.explore.refinement import OrbitTask, refine_orbit
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import (
    COORDINATE,
    ORBIT,
    STABLE_ORBIT,
    Candidate,
    Equation,
    candidate_from_json,
    candidate_to_json,
    read_candidates,
)
from orbitproof.shared.systems import FALKNER_SKAN, Defined, FixedLevel, ParameterRange
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify, is_proof_of
from orbitproof.verify.evidence import Checklist, NotProved, Proved, Reason, guarded
from orbitproof.verify.newton import Jet
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import IntegratorSettings
from orbitproof.verify.twist import (
    StableOrbitEnclosures,
    StableOrbitResults,
    StableOrbitTheorem,
    check_stable_orbit_exactly,
    enclose_stable_orbit,
    prove_stable_orbit,
    stable_orbit_theorem,
)
from orbitproof.verify.words.stable_orbit import stable_orbit_in_words

DATA = Path(__file__).resolve().parents[1] / "data"
HALO = read_candidates(DATA / "orbit-candidates.json")[0]
LIMITS = Limits(digits=10)
QUARTER = Fraction("679.95415507296894514696277375979")
"""Of the published table: a resonance of order 4."""


def falkner_skan(beta: Fraction, y: float, kind: Literal["orbit", "stable_orbit"] = STABLE_ORBIT) -> Candidate:
    task = OrbitTask(
        "stable", FALKNER_SKAN, {}, Equation(COORDINATE, beta, "beta"), (float(beta), y), 30, {}, kind=kind
    )
    return refine_orbit(task)


@cache
def skan() -> Candidate:
    return falkner_skan(Fraction(400), 0.9408)


@cache
def proof() -> Certificate:
    found = certify(skan(), LIMITS)
    assert found.proved, found.reason
    return found


def results(certificate: Certificate) -> StableOrbitResults:
    assert isinstance(certificate.results, StableOrbitResults)
    return certificate.results


@cache
def spring_enclosures() -> StableOrbitEnclosures:
    return enclose_stable_orbit(spring(), IntegratorSettings(128), ORACLE)


def spring_proof(claimed: Candidate, found: StableOrbitEnclosures | None) -> Any:
    checklist = Checklist()
    with guarded(128):
        check_stable_orbit_exactly(checklist, claimed)
        return prove_stable_orbit(claimed, checklist, found)


def test_the_twist_of_a_spring_beside_another_is_a_derivative_of_an_elliptic_integral() -> None:
    """z = y + i vy / w^(1/2) turns back by theta(|z|^2), and w^(1/2) |z|^2 is |w|^2 of section 28.2."""
    outcome = spring_proof(spring(), spring_enclosures())
    assert isinstance(outcome, Proved)
    found = outcome.results
    with mpmath.workprec(BITS):
        root, a = mpmath.sqrt(2), mpmath.mpf(3) / 2

        def angle(rho: Any) -> Any:
            level = a**2 + a**4 / 2 - 2 * rho
            return 2 * root * half(mpmath.sqrt(mpmath.sqrt(1 + 2 * level) - 1))

        turn = angle(mpmath.mpf(0)) % (2 * mpmath.pi)
        sign = 1 if turn < mpmath.pi else -1
        omega = turn if sign > 0 else 2 * mpmath.pi - turn
        assert contains(found.rotation_number, omega / (2 * mpmath.pi), 1e-25)
        assert contains(found.twist, sign * mpmath.diff(angle, 0) / root, 1e-15)
        assert found.twist.rad() < 1e-6
        assert found.defect.contains(0)
        assert (found.twist_coordinate, found.twist_momentum) == ("y", "vy")


def test_hypotheses_are_those_of_the_theorem() -> None:
    assert StableOrbitTheorem(spring()).hypotheses == (
        "symmetries", "frames", "plane", "poincare-map", "orbit", "level", "return-map", "elliptic",
        "non-resonance", "twist",
    )  # fmt: skip
    assert tuple(each.name for each in proof().hypotheses) == StableOrbitTheorem(skan()).hypotheses


def test_rotation_numbers_of_orbits_near_by_are_those_of_an_integration_in_floats() -> None:
    """omega + tau |w|^2 for orbits of the Falkner-Skan equation that begin on Fix(R) beside the proved one."""
    found = results(proof())
    numbers = {each.name: each.enclosures for each in proof().hypotheses}["return-map"]
    slope, omega = float(numbers["dp/dq"].mid()), 2 * math.pi * float(found.rotation_number.mid())
    scale = math.sqrt(abs(slope) / math.sin(omega))
    size = np.array([5e-7, 1e-6])
    # On both sides: what the curve is bent cancels in the mean.
    angles = rotation_numbers(400.0, float(found.point["y"].mid()), scale, np.sqrt([size, size]) * [[1], [-1]])
    slopes = (angles.mean(axis=0) - omega) / size
    assert abs(2 * slopes[0] - slopes[1] - float(found.twist.mid())) < 0.01 * abs(float(found.twist.mid()))


def rotation_numbers(beta: float, y: float, scale: float, radii: Any) -> Any:
    """Mean angles of a return, by classical Runge-Kutta steps and Newton's method onto the section z = 0."""

    def field(s: Any) -> Any:
        return np.array([s[1], s[2], beta * (s[1] ** 2 - 1) - s[0] * s[2]])

    def step(s: Any, h: Any) -> Any:
        a = field(s)
        b = field(s + h / 2 * a)
        c = field(s + h / 2 * b)
        return s + h / 6 * (a + 2 * b + 2 * c + field(s + h * c))

    def returned(s: Any) -> Any:
        for _ in range(2):
            time = np.zeros(s.shape[1:])
            for _ in range(140):
                s = step(s, 0.2123334707432424 / 140)
            for _ in range(4):
                move = -s[2] / field(s)[2]
                s, time = step(s, move), time + move
        return s

    state = np.array([np.zeros_like(radii), y + scale * radii, np.zeros_like(radii)])
    count = 80
    total, weights = np.zeros_like(radii), 0.0
    last = np.angle((state[1] - y) / scale + 1j * state[0] * scale)
    for number_ in range(1, count):
        state = returned(state)
        angle = np.angle((state[1] - y) / scale + 1j * state[0] * scale)
        weight = math.exp(-1 / (number_ / count * (1 - number_ / count)))
        total, weights = total + weight * ((angle - last) % (2 * math.pi)), weights + weight
        last = angle
    mean = total / weights
    return np.minimum(mean, 2 * math.pi - mean)


def test_a_certificate_says_what_is_proved() -> None:
    certificate = proof()
    assert str(certificate).startswith("stable orbit, proved, period = 0.42466694148648482345")
    theorem, told = certificate.theorem or "", certificate.statement["in_full"]
    for sentence in (
        "contains closed curves around x that this map leaves invariant",
        "stable for ever in the system with exactly the coordinates x, y, z at the value of beta at x",
        "Nothing is said of other systems: of motion in further coordinates",
    ):
        assert sentence in theorem
    assert "The rotation number omega/(2 pi) lies in [0.37354682431" in told
    assert "The twist, in the coordinates (y, x), lies in [-3296.33067" in told
    assert "the angle falls with the distance from the orbit" in told
    assert is_proof_of(certificate, skan())
    assert not is_proof_of(certificate, replace(skan(), twist=-1))
    assert not is_proof_of(certificate, replace(skan(), kind=ORBIT))


def test_with_a_first_integral_all_neighbouring_levels_are_meant() -> None:
    certificate = certify(spring(), LIMITS)
    assert certificate.proved
    theorem = certificate.theorem or ""
    assert "on the level of the energy through x, is not 0" in theorem
    assert "from which no solution, whatever its value of the energy, leaves the first one" in theorem
    assert "the system with exactly the coordinates x, y, vx, vy:" in theorem


@pytest.mark.parametrize("stiffness", [Fraction(2), Fraction(1, 2)])
def test_on_a_fixed_level_the_twist_is_that_of_the_other_spring(stiffness: Fraction) -> None:
    """x'' = - nu x - x^3 beside y'' = - k y, which returns after 2 pi k^(-1/2) at every level: 3/(8 nu) times that."""
    k = Fraction(7, 2)
    system = replace(
        SPRINGS,
        parameters={"nu": ParameterRange(None, None)},
        vector_field=lambda s, p: (s[2], s[3], -p[0] * s[0] - s[0] ** 3, -k * s[1]),
        first_integral=lambda s, p: (s[2] ** 2 + s[3] ** 2 + p[0] * s[0] ** 2 + s[0] ** 4 / 2 + k * s[1] ** 2,),
        first_integral_name="energy",
        squared_distance=None,
        distance_name=None,
        section="vy",
        family_parameter="nu",
        level_coordinate="y",
        fixed_level=FixedLevel(Fraction(4), 1),
    )
    claimed = replace(
        spring(), system=system, parameters={}, centre=(stiffness, SMALL[1] / 2),
        equation=Equation(COORDINATE, stiffness, "nu"),
    )  # fmt: skip
    outcome = spring_proof(claimed, enclose_stable_orbit(claimed, IntegratorSettings(128), ORACLE))
    assert isinstance(outcome, Proved)
    period = 2 * math.pi / math.sqrt(k)
    turn = math.sqrt(stiffness) * period % (2 * math.pi)
    sign = 1 if turn < math.pi else -1
    assert contains(outcome.results.twist, sign * 3 * period / (8 * float(stiffness)), 1e-12)
    assert contains(outcome.results.rotation_number, (turn if sign > 0 else 2 * math.pi - turn) / (2 * math.pi), 1e-12)
    assert (outcome.results.twist_coordinate, outcome.results.twist_momentum) == ("x", "vx")
    words = stable_orbit_in_words(StableOrbitTheorem(claimed))
    assert "on the level of the energy through x at the value of nu at x" in words
    assert "in the system with exactly the coordinates x, y, vx, vy at the value of nu at x" in words


def test_a_claimed_sign_has_to_be_that_of_the_twist() -> None:
    outcome = spring_proof(spring(), spring_enclosures())
    sign = 1 if outcome.results.twist > 0 else -1
    assert isinstance(spring_proof(replace(spring(), twist=sign), spring_enclosures()), Proved)
    wrong = spring_proof(replace(spring(), twist=-sign), spring_enclosures())
    assert isinstance(wrong, NotProved)
    assert wrong.reason.condition == "twist"
    assert wrong.reason.excluded


def test_orbits_in_space_are_refused_before_anything_is_computed() -> None:
    claimed = replace(HALO, kind=STABLE_ORBIT)
    assert isinstance(stable_orbit_theorem(claimed), Reason)
    certificate = certify(claimed, LIMITS)
    assert not certificate.proved
    assert certificate.reason is not None
    assert certificate.reason.condition == "plane"
    assert "n = 2, of which it is not known" in certificate.reason.message
    assert certificate.computation.steps == 0
    checklist = Checklist()
    with pytest.raises(Exception, match="n = 2"):
        check_stable_orbit_exactly(checklist, claimed)


@pytest.mark.parametrize(
    ("beta", "y", "condition"),
    [
        (Fraction(300), 0.93976, "elliptic"),
        (QUARTER, 0.93990, "non-resonance"),
    ],
)
def test_orbits_that_are_unstable_or_resonant_are_not_proved(beta: Fraction, y: float, condition: str) -> None:
    certificate = certify(falkner_skan(beta, y), Limits(digits=10, max_precision=200))
    assert not certificate.proved
    assert certificate.reason is not None
    assert certificate.reason.condition == condition
    # That s is beyond -1 no precision changes, so no more of it is tried.
    assert certificate.computation.attempts == (1 if condition == "elliptic" else 2)


def test_orbits_are_stable_among_states_whose_further_coordinates_are_functions_of_the_others() -> None:
    system = replace(
        FALKNER_SKAN,
        state=(*FALKNER_SKAN.state, "sine"),
        reversing_symmetry=(*FALKNER_SKAN.reversing_symmetry, 1),
        defined=(Defined("sine", "sin", lambda state, _: (state[1],)),),
    )
    words = stable_orbit_in_words(StableOrbitTheorem(replace(skan(), system=system)))
    assert "in the system with exactly the coordinates x, y, z at the value of beta" in words


def _wider(ball: arb, factor: float) -> arb:
    return ball + arb(0, factor)


def test_a_twist_that_may_be_0_or_is_not_finite_proves_nothing() -> None:
    found = spring_enclosures()
    for radius, conditions in ((1e3, {"twist", "elliptic", "return-map"}), (math.inf, {"return-map"})):
        image = tuple(tuple(_wider(ball, radius) for ball in row) for row in found.half_return.image)
        changed = replace(found, half_return=replace(found.half_return, image=image))
        outcome = spring_proof(spring(), changed)
        assert isinstance(outcome, NotProved)
        assert outcome.reason.condition in conditions


def _changed(
    found: StableOrbitEnclosures, change: Callable[[arb], arb], which: Callable[[tuple[int, ...]], bool]
) -> StableOrbitEnclosures:
    """With other derivatives of the image of the half return."""
    indices = sorted((i, j, k) for i in range(4) for j in range(4) for k in range(4) if i + j + k <= 3)
    image = tuple(
        tuple(change(ball) if which(index) else ball for index, ball in zip(indices, row, strict=True))
        for row in found.half_return.image
    )
    return replace(found, half_return=replace(found.half_return, image=image))


def test_third_derivatives_that_are_not_finite_are_no_jets() -> None:
    outcome = spring_proof(
        spring(), _changed(spring_enclosures(), lambda ball: arb("nan"), lambda index: sum(index) == 3)
    )
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "return-map"


def test_the_distances_of_four_powers_from_1_are_kept() -> None:
    found = {each.name: each.enclosures for each in proof().hypotheses}["non-resonance"]
    omega = 2 * math.pi * float(results(proof()).rotation_number.mid())
    assert len(found) == 4
    for order, ball in enumerate(found.values(), start=1):
        assert abs(float(ball.mid()) - 2 * abs(math.sin(order * omega / 2))) < 1e-10


def test_what_is_uncertain_in_order_three_leaves_the_sign_open() -> None:
    changed = _changed(spring_enclosures(), lambda ball: ball + arb(0, 1e2), lambda index: sum(index) == 3)
    outcome = spring_proof(spring(), changed)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "twist"
    assert outcome.reason.needs_precision


def test_a_derivative_that_is_not_that_of_the_orbit_is_noticed() -> None:
    changed = _changed(spring_enclosures(), lambda ball: ball + arb("0.01"), lambda index: index == (0, 0, 1))
    outcome = spring_proof(spring(), changed)
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition in ("elliptic", "return-map")
    assert "wrong" in outcome.reason.message


def test_a_map_that_is_not_reversible_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """With another third derivative of the full return its real part is not 0."""
    full = proved.full_return_jets

    def bent(jets: Sequence[Jet]) -> tuple[Jet, ...]:
        first, second = full(jets)
        changed = {index: ball + (1 if index == (2, 1) else 0) for index, ball in second.coefficients.items()}
        return first, Jet(2, 3, changed)

    monkeypatch.setattr(proved, "full_return_jets", bent)
    outcome = spring_proof(spring(), spring_enclosures())
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == "twist"
    assert "an enclosure is wrong" in outcome.reason.message


def test_the_twist_does_not_depend_on_the_frame() -> None:
    """Nor does its sign: in a frame that turns the other way round."""
    turned = replace(
        spring(),
        frame=((Fraction(1), Fraction(0)), (Fraction(1, 4), Fraction(-3))),
        radii=(SMALL[0], SMALL[1]),
        centre=(Fraction(3, 2) + SMALL[0] / 2, SMALL[0] / 8 - SMALL[1]),
    )
    outcome = spring_proof(turned, enclose_stable_orbit(turned, IntegratorSettings(128), ORACLE))
    assert isinstance(outcome, Proved)
    wanted = spring_proof(spring(), spring_enclosures()).results
    assert agree(outcome.results.twist, wanted.twist)
    assert outcome.results.twist_coordinate == "y"
    assert agree(outcome.results.rotation_number, wanted.rotation_number)


def test_claims_are_read_as_they_are_written() -> None:
    claimed = replace(skan(), twist=-1, provenance={})
    assert candidate_from_json(candidate_to_json(claimed), "row") == claimed
    for change, field in (
        ({"twist": 2}, "twist"),
        ({"kind": ORBIT, "twist": 1}, "twist"),
        ({"equation": None}, "equation"),
    ):
        with pytest.raises(InputError, match=f"^{field}: "):
            replace(skan(), **change)  # type: ignore[arg-type]
