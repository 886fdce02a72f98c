"""Periodic orbits without symmetry of fields with sin, cos, exp and log (sections 1.7 and 24.7)."""

from __future__ import annotations

import copy
import random
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from flint import acb, arb
from scipy.integrate import solve_ivp
from support import function_cases as cases
from support.balls import agree

from orbitproof.shared import define_system
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import PeriodicOrbit
from orbitproof.shared.systems import Defined, System, described_plainly
from orbitproof.verify import second_proof
from orbitproof.verify.certificate import Certificate, Limits, certify
from orbitproof.verify.certificate.rechecking import derived
from orbitproof.verify.claim import keeps_integral, keeps_volume, respects
from orbitproof.verify.claim.related_functions import functions_of
from orbitproof.verify.evidence import Checklist, NotEstablishedError, NotProved, Outcome, Proved, enclose, guarded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.periodic import (
    PeriodicResults,
    check_periodic_exactly,
    enclose_periodic,
    prove_periodic,
)
from orbitproof.verify.periodic.box import gradient_on, state_on_box, values_on
from orbitproof.verify.poincare import IntegratorSettings

Q = Fraction
BITS = 128


def _outcome(claim: PeriodicOrbit) -> Outcome[PeriodicResults]:
    checklist = Checklist()
    with guarded(BITS):
        try:
            check_periodic_exactly(checklist, claim)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
        return prove_periodic(claim, checklist, enclose_periodic(claim, IntegratorSettings(BITS), ORACLE))


def _proved(claim: PeriodicOrbit) -> PeriodicResults:
    outcome = _outcome(claim)
    assert isinstance(outcome, Proved), outcome.reason
    return outcome.results


def _refused(claim: PeriodicOrbit) -> NotProved[PeriodicResults]:
    outcome = _outcome(claim)
    assert isinstance(outcome, NotProved)
    return outcome


CYCLE = 2 * arb.pi() / arb(1).agm(arb(2).rsqrt())
"""4 K(1/sqrt 2)."""


def test_the_limit_cycle_of_a_pendulum_has_the_period_and_the_multiplier_of_its_closed_form() -> None:
    found = _proved(cases.swing())
    action = 2 * (2 * arb.pi()).sqrt() * (arb(3) / 4).gamma() / (arb(5) / 4).gamma()
    assert list(found.point) == ["x", "y"]
    assert agree(found.point["y"], arb(2).sqrt())
    assert agree(found.period, CYCLE)
    assert found.period.rad() < 1e-10
    (multiplier,) = found.multipliers.values
    assert agree(multiplier, acb((-action / 10).exp()))
    assert found.multipliers.is_attracting


def test_on_a_level_of_an_energy_with_a_cosine() -> None:
    found = _proved(cases.pendulum())
    assert agree(found.period, CYCLE)
    assert found.multipliers.trivial == 2
    assert found.level is not None
    other = _refused(cases.pendulum(level=Q(1, 10**6)))
    assert other.reason.condition == "periodic"


@pytest.mark.parametrize("kind", cases.OTHERS)
def test_circles_in_other_coordinates_have_their_period_and_multiplier(kind: str) -> None:
    chance = random.Random(kind)
    for _ in range(2):
        w, a = Q(chance.randint(4, 12), 4), Q(chance.randint(-8, 8), 20)
        found = _proved(cases.circle(kind, w, a))
        assert agree(found.period, 2 * arb.pi() / enclose(w)), (w, a)
        (multiplier,) = found.multipliers.values
        assert agree(multiplier, acb((-arb.pi() / enclose(w)).exp())), (w, a)
        assert found.multipliers.is_attracting


@pytest.mark.parametrize("kind", cases.OTHERS)
def test_a_box_beside_the_circle_has_no_orbit(kind: str) -> None:
    claim = cases.circle(kind, Q(3, 2), Q(1, 5))
    outcome = _refused(replace(claim, centre=(claim.centre[0] + 10 * cases.RADIUS, claim.centre[1])))
    assert outcome.reason.condition == "periodic"
    assert outcome.reason.excluded


THOMAS = define_system(
    {
        "name": "thomas", "state": "x y z", "parameters": "b",
        "field": {"x": "sin(y) - b*x", "y": "sin(z) - b*y", "z": "sin(x) - b*z"},
    }
)  # fmt: skip
NEURON = define_system(
    {
        "name": "neuron", "state": "v w", "parameters": "I",
        "where": {
            "m": "1/(1 + exp(-(v + 1.2)/9))", "n": "1/(1 + exp(-(v - 2)/15))",
            "r": "(exp((v - 2)/60) + exp(-(v - 2)/60))/2",
        },
        "field": {"v": "(I - 2*(v + 60) - 4.4*m*(v - 120) - 8*w*(v + 84))/20", "w": "0.04*r*(n - w)"},
    }
)  # fmt: skip
"""Morris and Lecar's, in mV and ms."""


def _thomas(_time: float, state: np.ndarray) -> np.ndarray:
    return np.sin(np.roll(state, -1)) - 0.3 * state


def _neuron(_time: float, state: np.ndarray) -> np.ndarray:
    v, w = state
    m, n = 1 / (1 + np.exp(-(v + 1.2) / 9)), 1 / (1 + np.exp(-(v - 2) / 15))
    current = 100 - 2 * (v + 60) - 4.4 * m * (v - 120) - 8 * w * (v + 84)
    return np.array([current / 20, 0.04 * np.cosh((v - 2) / 60) * (n - w)])


@pytest.mark.parametrize(
    ("system", "parameters", "place", "texts", "rates"),
    [
        (THOMAS, {"b": Q(3, 10)}, 0, ("2.2", "1.725514369020055", "2.903535087413425"), _thomas),
        (NEURON, {"I": Q(100)}, 0, ("-9", "0.1539105282314114"), _neuron),
    ],
)
def test_published_systems_are_proved_with_the_period_of_another_integrator(
    system: System, parameters: dict[str, Q], place: int, texts: tuple[str, ...], rates: Any
) -> None:
    centre = [Q(text) for text in texts]
    claims = (
        cases.in_plane(system, place, centre, cases.RADIUS, parameters=parameters, direction=direction)
        for direction in (1, -1)
    )
    (found,) = (outcome.results for outcome in map(_outcome, claims) if isinstance(outcome, Proved))

    def height(_time: float, state: np.ndarray) -> float:
        return float(state[place]) - float(centre[place])

    point = [float(value) for value in centre]
    height.direction = np.sign(rates(0.0, np.array(point))[place])  # type: ignore[attr-defined]
    other = solve_ivp(rates, (0.0, 200.0), point, method="DOP853", rtol=1e-12, atol=1e-12, events=height)
    first = next(time for time in other.t_events[0] if time > 1)
    assert float(found.period.mid()) == pytest.approx(first, abs=1e-8)
    assert found.period.rad() < 1e-8
    assert found.multipliers.is_attracting


def _by_hand(rates: Any, defined: tuple[tuple[str, str, Any], ...]) -> System:
    """x' = y, y' = -s - y (y^2/2 - c)/10, further coordinates s and c as given."""
    state = ("x", "y", *(name for name, _, _ in defined))

    def field(values: Any, parameters: Any) -> Any:
        x, y, s, c = values
        return (y, -s - y * (y * y / 2 - c) / 10, *rates(x, y, s, c))

    return System("hand", "by hand", state, {}, field, defined=tuple(Defined(*each) for each in defined))


def _angle(values: Any, parameters: Any) -> Any:
    return (values[0],)


SINE_AND_COSINE = (("s", "sin", _angle), ("c", "cos", _angle))


def test_coordinates_that_do_not_stay_the_functions_they_are_called_are_refused() -> None:
    claim, right = cases.pendulum(level=None), _by_hand(lambda x, y, s, c: (c * y, -s * y), SINE_AND_COSINE)
    assert isinstance(_outcome(replace(claim, system=right)), Proved)
    for rates, defined in (
        (lambda x, y, s, c: (c * y, s * y), SINE_AND_COSINE),
        (lambda x, y, s, c: (c, -s), SINE_AND_COSINE),
        (lambda x, y, s, c: (0 * c, 0 * s), SINE_AND_COSINE),
        (lambda x, y, s, c: (c * y, -s * y), (("s", "cos", _angle), ("c", "sin", _angle))),
        (lambda x, y, s, c: (c * y, -s * y), (("s", "exp", _angle), ("c", "cos", _angle))),
        (lambda x, y, s, c: (c * y, -s * y), (("s", "sin", lambda v, p: (2 * v[0],)), ("c", "cos", _angle))),
        # Rates of the sine and the cosine of one angle, and not of these two.
        (lambda x, y, s, c: (c * y, -s * y), (("s", "sin", _angle), ("c", "cos", lambda v, p: (v[0] + 1,)))),
        (lambda x, y, s, c: (c * y, -s * y), (("s", "sin", lambda v, p: (v[0] + 0 * v[3],)), ("c", "cos", _angle))),
    ):
        assert _refused(replace(claim, system=_by_hand(rates, defined))).reason.condition == "functions"


def test_functions_under_other_names_than_their_coordinates_are_refused() -> None:
    """One of itself among them: w = exp(5 w) has no solution, and w' = 0 is the rate of both sides."""
    right = _by_hand(lambda x, y, s, c: (c * y, -s * y), SINE_AND_COSINE)
    exchanged = replace(right, state=("x", "y", "c", "s"))
    assert _refused(replace(cases.pendulum(level=None), system=exchanged)).reason.condition == "functions"

    def field(values: Any, parameters: Any) -> Any:
        x, y, w = values
        return (y, -x - y * (x * x + y * y - w) / 10, 0 * w)

    own = Defined("v", "exp", lambda values, parameters: (5 * values[2],))
    for state in (("x", "y", "w"), ("x", "y", "v")):
        system = System("own", "its own", state, {}, field, defined=(own,))
        assert _refused(cases.in_plane(system, 0, [Q(0), Q(1)], cases.RADIUS)).reason.condition == "functions"


def test_claims_know_the_given_coordinates_alone() -> None:
    claim = cases.swing()
    assert claim.coordinates == ("x", "y")
    with pytest.raises(InputError, match="centre: 4 numbers; give 2; the state is x, y"):
        replace(claim, centre=(*claim.centre, Q(0), Q(1)))
    with pytest.raises(InputError, match="normal: 4 numbers; give 2"):
        replace(claim, normal=(*claim.normal, Q(0), Q(0)))


def test_where_a_function_is_not_defined_nothing_is_proved() -> None:
    claim = cases.circle("logarithm", Q(3, 2), Q(0))
    negative = replace(claim, centre=(-claim.centre[0], claim.centre[1]))
    assert isinstance(_outcome(claim), Proved)
    assert not _refused(negative).reason.excluded
    # The other sign of a root is another orbit: there is none.
    claim = cases.circle("root", Q(3, 2), Q(0))
    assert isinstance(_outcome(claim), Proved)


def test_functions_on_a_box_are_enclosed_with_their_slopes() -> None:
    chance = random.Random(5)
    field = {"x": "exp(-x*a)*log(2 + x*x)", "y": "sin(x + cos(y)) - y"}
    integral = "x*sin(x + cos(y)) + exp(-x*a)*log(2 + x*x)"
    system = described_plainly(
        {"name": "mixed", "state": "x y", "parameters": "a", "field": field, "first_integral": integral}
    )
    assert system.first_integral_program is not None
    claim = replace(
        cases.swing(), system=system, parameters={"a": Q(3, 4)}, radii=(Q(1, 50),), frame=((Q(0),), (Q(1),))
    )

    def value(x: arb, y: arb, a: arb) -> arb:
        return x * (x + y.cos()).sin() + (-x * a).exp() * (2 + x * x).log()

    with guarded(BITS):
        for _ in range(50):
            centre = (Q(chance.randint(-20, 20), 10), Q(chance.randint(-20, 20), 10))
            claim = replace(claim, centre=centre, offset=centre[0])
            where = state_on_box(claim)
            point = [enclose(centre[0]), enclose(centre[1] + claim.radii[0] * Q(chance.randint(-9, 9), 10))]
            a = enclose(Q(3, 4))
            (found,) = values_on(system.first_integral_program, claim, where)
            assert agree(found, value(*point, a))
            x, y = point
            (slope,) = gradient_on(system.first_integral_program, claim, where)
            assert agree(slope, -x * (x + y.cos()).cos() * y.sin())
            assert slope.rad() < 0.2


DOUBLE: dict[str, Any] = {
    "name": "double", "state": "a b p q",
    "where": {"d": "2 - cos(a - b)**2"},
    "field": {
        "a": "p", "b": "q",
        "p": "(-2*sin(a) + sin(b)*cos(a - b) - sin(a - b)*(q**2 + p**2*cos(a - b)))/d",
        "q": "(2*sin(a)*cos(a - b) - 2*sin(b) + 2*p**2*sin(a - b) + q**2*sin(a - b)*cos(a - b))/d",
    },
    "first_integral": "p**2 + q**2/2 + p*q*cos(a - b) - 2*cos(a) - cos(b)",
}  # fmt: skip
"""Two pendulums of length and mass 1, one at the other."""


def test_the_energy_of_a_double_pendulum_is_recognised() -> None:
    system = define_system(DOUBLE)
    assert keeps_integral(system)
    # As books have it, with the angle a - 2b in place of some of the products.
    rates = {
        **DOUBLE["field"],
        "p": "(-3*sin(a) - sin(a - 2*b) - 2*sin(a - b)*(q**2 + p**2*cos(a - b)))/(2*d)",
        "q": "2*sin(a - b)*(2*p**2 + 2*cos(a) + q**2*cos(a - b))/(2*d)",
    }
    assert keeps_integral(define_system({**DOUBLE, "field": rates}))
    for key, text in (
        ("first_integral", "p**2 + q**2/2 + p*q*cos(a - b) - 2*cos(a) - cos(b)/2"),
        ("first_integral", "p**2 + q**2/2 + p*q*cos(a + b) - 2*cos(a) - cos(b)"),
        ("field", rates | {"p": "(-3*sin(a) + sin(a - 2*b) - 2*sin(a - b)*(q**2 + p**2*cos(a - b)))/(2*d)"}),
    ):
        assert not keeps_integral(described_plainly({**DOUBLE, key: text}))


IDENTITIES = (
    "sin(x + y) - sin(x)*cos(y) - cos(x)*sin(y)",
    "cos(x - y) - cos(x)*cos(y) - sin(x)*sin(y)",
    "sin(2*x) - 2*sin(x)*cos(x)",
    "cos(x*y)**4 - sin(x*y)**4 - 1 + 2*sin(x*y)**2",
    "exp(x)*exp(-x) - 1",
    "exp(2*y) - exp(y)**2",
    "exp(x)**2*exp(-x) - exp(x)",
    "y*exp(x)*exp(-x)**3 - y*exp(-x)**2",
    "exp(x + y)*exp(-x)*exp(-y) - 1",
    "exp(3*x)*exp(-x)**3 + exp(x - 2*y)*exp(-x)*exp(y)**2 - 2",
    "sin(x + y)**2 + cos(y + x)**2 - 1",
    "sin(-x) + sin(x)",
    "1/(2 + sin(x)) - (2 - sin(x))/(3 + cos(x)**2)",
)
WRONG = (
    "sin(x + y) - sin(x)*cos(y) + cos(x)*sin(y)",
    "cos(x - y) - cos(x)*cos(y) + sin(x)*sin(y)",
    "sin(2*x) - sin(x)*cos(x)",
    "cos(x)**2 - sin(x)**2 - 1",
    "exp(x)*exp(-y) - 1",
    "exp(2*y) - exp(y)",
    "exp(2*x)*exp(-x) - 1",
    "exp(x)**2*exp(-x) - exp(-x)",
    "exp(x + y)*exp(-x)*exp(y) - 1",
    "exp(x - 2*y)*exp(-x)*exp(y) - 1",
    "sin(-x) - sin(x)",
    "exp(x)*exp(x) - 1",
    "sin(x)**2 + cos(y)**2 - 1",
)


def _with_rate(text: str) -> System:
    """z' is this function of x and y, and z is called a first integral."""
    field = {"x": "y", "y": "-x", "z": text}
    return described_plainly({"name": "rate", "state": "x y z", "field": field, "first_integral": "z"})


@pytest.mark.parametrize(("text", "holds"), [*((t, True) for t in IDENTITIES), *((t, False) for t in WRONG)])
def test_relations_between_functions_are_known_and_no_others(text: str, holds: bool) -> None:
    assert keeps_integral(_with_rate(text)) is holds


def test_what_relations_show_is_true_of_numbers() -> None:
    """Of random polynomials in functions of sums those that are shown to vanish do, and others do not all the time."""
    chance, shown = random.Random(11), 0
    angles = ["x", "y", "x + y", "x - 2*y", "2*x", "-y", "x - y"]
    for _ in range(60):
        first, second = chance.choice(angles), chance.choice(angles)
        total = f"({first}) {chance.choice('+-')} ({second})"
        form = chance.choice([
            "sin({t}) - sin({a})*cos({b}) - cos({a})*sin({b})", "cos({t}) - cos({a})*cos({b}) + sin({a})*sin({b})",
            "exp({t}) - exp({a})*exp({b})", "exp({a})*exp({b}) - 1",
            "exp({t})*exp(-({a}))*exp(-({b})) - 1", "sin({a})**2 - 1 + cos({b})**2",
        ])  # fmt: skip
        text = form.format(t=total, a=first, b=second)
        system = _with_rate(text)
        with guarded(BITS):
            x, y = arb("0.7"), arb("-1.3")
            names = {"x": x, "y": y, "sin": arb.sin, "cos": arb.cos, "exp": arb.exp}
            value = eval(text, {"__builtins__": {}}, names)
            if keeps_integral(system):
                shown += 1
                assert value.contains(0), text
    assert shown > 10


@pytest.mark.parametrize(
    ("field", "free"),
    [
        ({"x": "sin(z) + cos(y)", "y": "sin(x) + cos(z)", "z": "sin(y) + cos(x)"}, True),
        ({"x": "exp(x + y)", "y": "-exp(y + x)", "z": "log(2 + x*x)"}, True),
        ({"x": "log(z)*x", "y": "-log(z)*y", "z": "0*z"}, True),
        ({"x": "sin(x)*cos(x)", "y": "-y*cos(2*x)", "z": "0*z"}, True),
        ({"x": "log(x)", "y": "-y/x", "z": "0*z"}, True),
        ({"x": "sin(x)", "y": "cos(z)", "z": "y"}, False),
        ({"x": "exp(x + y)", "y": "exp(y + x)", "z": "x"}, False),
        ({"x": "log(x)", "y": "y/x", "z": "0*z"}, False),
        ({"x": "sin(y)", "y": "cos(x)", "z": "exp(z)"}, False),
        ({"x": "sin(y)", "y": "exp(y)", "z": "cos(x)"}, False),
        ({"x": "sin(x)*cos(x)", "y": "y*cos(2*x)", "z": "0*z"}, False),
    ],
)
def test_the_divergence_is_that_of_the_given_coordinates(field: dict[str, str], free: bool) -> None:
    assert keeps_volume(define_system({"name": "any", "state": "x y z", "field": field})) is free


def _diagonal(*signs: int) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(tuple(Q(sign * (i == j)) for j in range(len(signs))) for i, sign in enumerate(signs))


SWAP = ((Q(0), Q(1)), (Q(1), Q(0)))


@pytest.mark.parametrize(
    ("field", "symmetry", "holds"),
    [
        ({"x": "sin(y) - x", "y": "sin(x) - y"}, _diagonal(-1, -1), True),
        ({"x": "sin(y) - x", "y": "sin(x) - y"}, SWAP, True),
        ({"x": "sin(y) - 2*x", "y": "sin(x) - y"}, SWAP, False),
        ({"x": "cos(y) - x", "y": "sin(x) - y"}, _diagonal(-1, -1), False),
        ({"x": "x*cos(y)", "y": "y*cos(x)"}, _diagonal(-1, 1), True),
        ({"x": "x*cos(y)", "y": "y*cos(x)"}, _diagonal(1, -1), True),
        ({"x": "exp(x) - exp(-x)", "y": "-y"}, _diagonal(-1, -1), True),
        ({"x": "exp(x) - 1", "y": "-y"}, _diagonal(-1, -1), False),
        ({"x": "exp(y) - x", "y": "exp(x) - y"}, SWAP, True),
        ({"x": "log(1 + x*x)*y", "y": "-x"}, _diagonal(-1, -1), True),
        ({"x": "log(2 + x)*y", "y": "-x"}, _diagonal(-1, -1), False),
        ({"x": "sin(sin(x))", "y": "cos(sin(x))*y"}, _diagonal(-1, 1), True),
        ({"x": "sin(x + y) - y", "y": "sin(x - y)"}, _diagonal(1, -1), False),
    ],
)
def test_a_symmetry_is_one_of_the_given_coordinates(field: dict[str, str], symmetry: Any, holds: bool) -> None:
    system = define_system({"name": "any", "state": "x y", "field": field})
    assert respects(system, symmetry, with_integral=False) == (holds, True)


def test_a_symmetry_is_shown_where_steps_of_an_argument_divide_by_later_functions() -> None:
    for rate, holds in (("x*r", True), ("x*r + y**2/10**9", False)):
        where, field = {"r": "sin(y)/exp(x)"}, {"x": "r*r", "y": rate}
        system = described_plainly({"name": "any", "state": "x y", "where": where, "field": field})
        assert respects(system, _diagonal(1, -1), with_integral=False) == (holds, True)


def test_arguments_are_written_by_those_that_stay() -> None:
    field = {"x": "sin(x) + sin(x - 2*y) + sin(x - y) + cos(y)", "y": "exp(x)*exp(2*x)*exp(-x)"}
    system = described_plainly({"name": "sums", "state": "x y", "field": field})
    inputs = [each.value for each in functions_of(system)(system.program).inputs]
    # x and y; sine and cosine of two of the four angles; two of the three exponentials, which are inverse.
    assert sum(value in inputs[0].context().gens() for value in inputs) == 2 + 4 + 2


@pytest.fixture(scope="module")
def certificate() -> Certificate:
    found = certify(cases.swing(), Limits(digits=12))
    assert found.proved
    return found


def test_the_second_proof_says_that_it_does_not_follow_functions(certificate: Certificate) -> None:
    with pytest.raises(second_proof.CannotFollow, match="functions of others"):
        second_proof.second_proof(certificate.to_json())


def test_a_system_with_other_functions_is_not_derived_anew(certificate: Certificate) -> None:
    """Of all that follows from a description in which a cosine is called an exponential, nothing is proved."""
    entry = copy.deepcopy(certificate.to_json())
    described = entry["statement"]["candidate"]["system"]
    described["defined"] = [[name, {"cos": "exp"}.get(kind, kind), e] for name, kind, e in described["defined"]]
    forged = derived(entry)
    assert forged["verdict"] != "proved"
    assert forged["reason"]["condition"] == "functions"
