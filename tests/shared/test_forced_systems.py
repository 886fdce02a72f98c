"""Formulas with the time: what is read of them is the same field, at every time; what cannot be read is refused."""

from __future__ import annotations

import math
import random
from typing import Any

import pytest

from orbitproof.explore.names import start_values
from orbitproof.shared import System, define_system
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import describe, described_plainly, functions_in_floats

PARAMETERS = {"a": 0.7, "r": 1.3, "k": 2.0}
FORCES: tuple[tuple[str, dict[str, str], float], ...] = (
    ("a*cos(r*t)", {}, 1.3),
    ("sin(t*r)**2 - a*cos(-3*r*t)", {}, 1.3),
    ("cos(3*r*t/2) + sin(r*t)", {}, 0.65),
    ("a*cos(k*x - r*t) + sin(2*r*t + a)", {}, 1.3),
    ("cos(phase)*cos(2*phase) + g", {"phase": "r*t + x", "g": "a*sin(r*t)"}, 1.3),
    ("exp(cos(2*t)) + 1/(2 + sin(t))", {}, 1.0),
    ("cos(sqrt(k/a)*t) + cos(x + a*sin(sqrt(k/a)*t))", {}, math.sqrt(2.0 / 0.7)),
    ("cos((r + a)*t) + sin(2*(a + r)*t - 3)", {}, 2.0),
    ("cos(w*t/(2*k)) - cos(w*t/k)", {"w": "r*k"}, 0.65 / 1.0),
    ("sin(-r*t) + cos(r*t + r*t)*v", {}, 1.3),
    ("sin(2 - r*t + 1/k) + cos(r*t - x/v**2)", {}, 1.3),
)
"""A force, what stands under where, and how fast the pair of coordinates turns."""


def forced(force: str, where: dict[str, str]) -> System:
    return define_system({
        "name": "forced", "state": "x v", "parameters": list(PARAMETERS), "where": where,
        "field": {"x": "v", "v": f"-x + {force}"},
    })  # fmt: skip


def value(text: str, names: dict[str, Any]) -> float:
    functions = {name: getattr(math, name) for name in ("sin", "cos", "exp", "log", "sqrt")}
    return float(eval(text, {"__builtins__": {}}, functions | names))


@pytest.mark.parametrize(("force", "where", "rate"), FORCES, ids=[force for force, _, _ in FORCES])
def test_what_is_read_is_the_same_field_at_every_time(force: str, where: dict[str, str], rate: float) -> None:
    system = forced(force, where)
    source = random.Random(force)
    assert system.given_state == ("x", "v", "force_cos", "force_sin")
    for _ in range(20):
        x, v, t = (source.uniform(-2, 2) for _ in range(3))
        names: dict[str, Any] = {"x": x, "v": v, "t": t, **PARAMETERS}
        for name, text in where.items():
            names[name] = value(text, names)
        turn = math.cos(rate * t), math.sin(rate * t)
        given = [x, v, *turn, *[0.0] * len(system.defined)]
        state = functions_in_floats(system, given, list(PARAMETERS.values()))
        slopes = system.program.evaluate([*state, *PARAMETERS.values()], float, lambda base, e: base ** float(e))
        expected = (v, -x + value(force, names), -rate * turn[1], rate * turn[0])
        assert slopes[:4] == pytest.approx(expected, abs=1e-12)


def test_the_circle_attracts_in_the_direction_of_time() -> None:
    system = forced("cos(r*t)", {})
    for radius in (0.5, 0.9, 1.1, 2.0):
        _, _, u, v = system.program.evaluate([0.0, 0.0, radius, 0.0, 0.7, 1.3, 2.0], float, lambda b, e: b ** float(e))
        assert (u > 0) == (radius < 1)
        assert v == pytest.approx(1.3 * radius)


@pytest.mark.parametrize(
    ("force", "said"),
    [
        ("t", "cannot be read"),
        ("cos(r*t)*t", "cannot be read"),
        ("exp(t)", "cannot be read"),
        ("cos(x*t)", "a product with the time"),
        ("cos(t*t)", "a product with the time"),
        ("cos(r*t**2)", "a power or quotient of the time"),
        ("cos(1/t)", "a power or quotient of the time"),
        ("cos(r*t) + cos(a*t)", "no common period"),
        ("cos(r*t) + cos(sqrt(2*r)*t)", "no common period"),
        ("cos(r*t + a*t) + cos(r*t)", "no common period"),
        ("cos(t) + cos(17*t)", "harmonics"),
        ("cos(r*t + exp(x))", "under where"),
        ("cos(q*t)", "'q'"),
    ],
)
def test_what_cannot_be_read_is_refused_with_what_to_do(force: str, said: str) -> None:
    with pytest.raises(InputError, match=r"^field: ") as caught:
        forced(force, {})
    assert said in str(caught.value)
    # Rates and harmonics are of all formulas together.
    assert ("field: in the formula of v: " in str(caught.value)) is (said not in ("no common period", "harmonics"))
    assert "\n" not in str(caught.value)
    with pytest.raises(InputError, match="in the formula of k: the time in"):
        forced("k", {"k": "cos(r*t)*t"})


def test_a_coordinate_of_ones_own_may_be_called_t() -> None:
    system = define_system({"name": "own", "state": "x t", "field": {"x": "cos(t)", "t": "1 - x"}})
    assert system.given_state == ("x", "t")


def test_names_of_the_force_are_free() -> None:
    with pytest.raises(InputError, match="force_sin begins like"):
        define_system({"name": "own", "state": "x force_sin", "field": {"x": "cos(t)", "force_sin": "1 - x"}})
    # Under this name the second harmonic stands.
    field = {"x": "v", "v": "cos(t) + cos(2*t) + force_cos_2"}
    with pytest.raises(InputError, match="force_cos_2 begins like"):
        define_system({"name": "own", "state": "x v", "where": {"force_cos_2": "x"}, "field": field})


def test_a_reversible_system_writes_its_force_as_coordinates() -> None:
    with pytest.raises(InputError, match="forced-systems"):
        define_system({
            "name": "own", "state": "x v", "field": {"x": "v", "v": "-x + cos(t)"}, "R": {"x": -1}, "section": "x",
        })  # fmt: skip


def test_the_description_of_a_forced_system_is_of_the_system_without_time() -> None:
    system = forced("a*cos(r*t)", {})
    entry = describe(system)
    assert isinstance(entry, dict)
    assert described_plainly(entry) is system


def test_a_force_begins_with_its_phase_at_0() -> None:
    system = forced("a*cos(r*t)", {})
    assert list(start_values("start", ["x=1", "v=2"], system).values()) == [1, 2, 1, 0]
    other = start_values("start", ["x=1", "v=2", "force_cos=0", "force_sin=-1"], system)
    assert list(other.values()) == [1, 2, 0, -1]


def test_one_coordinate_with_a_force_is_a_system_and_none_without() -> None:
    system = define_system({"name": "leak", "state": "x", "field": {"x": "cos(2*t) - x*exp(x)"}})
    assert system.given_state == ("x", "force_cos", "force_sin")
    for field in ("-x", "sin(x)", "sin(x + sin(x))"):
        with pytest.raises(InputError, match="two coordinates or more"):
            define_system({"name": "leak", "state": "x", "field": {"x": field}})


def test_a_power_with_a_parameter_is_an_exponential() -> None:
    power = {"x": "v", "v": "1 - x**n*v/(1 + x**n) - 2**(k*n) + x**m"}
    system = define_system({
        "name": "hill", "state": "x v", "parameters": "n k", "where": {"m": "3"}, "field": power,
    })  # fmt: skip
    assert [each.function for each in system.defined] == ["log", "exp", "log", "exp"]
    source = random.Random(3)
    for _ in range(20):
        x, v, n, k = (source.uniform(0.1, 2) for _ in range(4))
        state = functions_in_floats(system, [x, v, *[0.0] * 4], [n, k])
        slopes = system.program.evaluate([*state, n, k], float, lambda base, e: base ** float(e))
        assert slopes[1] == pytest.approx(value(power["v"], {"x": x, "v": v, "n": n, "k": k, "m": 3}))
    constant = define_system({"name": "cube", "state": "x v", "where": {"m": "3"}, "field": {"x": "v", "v": "-x**m"}})
    assert not constant.defined


def test_rates_are_made_of_parameters_and_numbers_alone() -> None:
    for force in ("cos(w*t)", "cos(w*t + x)", "sin(2*t*w)"):
        for rate in ("x", "r*v", "r + x*0", "sin(r)", "1/x"):
            with pytest.raises(InputError, match=r"a product with the time|cannot be read"):
                forced(force, {"w": rate})


@pytest.mark.parametrize(
    "power", ["x**(n + 1)", "x**(n - 1)", "(x + v)**(n - k)", "x**n**k", "-x**-n", "x**(2*n)/x**n"]
)
def test_exponents_and_bases_stay_together(power: str) -> None:
    system = define_system({"name": "hill", "state": "x v", "parameters": "n k", "field": {"x": "v", "v": power}})
    source = random.Random(power)
    for _ in range(5):
        x, v, n, k = (source.uniform(0.1, 2) for _ in range(4))
        state = functions_in_floats(system, [x, v, *[0.0] * len(system.defined)], [n, k])
        slopes = system.program.evaluate([*state, n, k], float, lambda base, e: base ** float(e))
        assert slopes[1] == pytest.approx(value(power, {"x": x, "v": v, "n": n, "k": k}))
