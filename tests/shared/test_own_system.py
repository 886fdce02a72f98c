"""A system is a file of the user: read as data, refused with one line that names what is wrong."""

from __future__ import annotations

import json
import pickle
import random
from contextlib import suppress
from fractions import Fraction
from math import cos, exp, log, sin
from pathlib import Path
from typing import Any

import pytest

from orbitproof.explore.__main__ import main as explore_main
from orbitproof.shared import CR3BP, SYSTEMS, InputError, ReversibleSystem, System, define_system, load_system
from orbitproof.shared.systems import (
    AROUND,
    DescriptionError,
    FormulaError,
    describe,
    described,
    described_plainly,
    evaluate_formula,
    fault,
)

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"

MICHELSON: dict[str, Any] = {
    "name": "michelson-test",
    "state": ["x", "y", "z"],
    "parameters": {"c": [None, "3/2"]},
    "field": {"x": "y", "y": "z", "z": "c**2 - y - x**2/2"},
    "R": [-1, 1, -1],
    "section": "x",
    "family_parameter": "c",
}
HENON: dict[str, Any] = {
    "name": "henon-test",
    "state": "x y vx vy",
    "field": {"x": "vx", "y": "vy", "vx": "-x - 2*x*y", "vy": "-y - x**2 + y**2"},
    "R": {"x": -1, "vy": -1},
    "section": "x",
    "symmetries": {"S": {"x": -1, "vx": -1}},
    "where": {"square": "x**2 + y**2"},
    "first_integral": "(vx**2 + vy**2 + square)/2 + x**2*y - y**3/3",
}


def changed(entry: dict[str, Any], **more: Any) -> dict[str, Any]:
    return {**entry, **more}


def write(path: Path, entry: dict[str, Any]) -> Path:
    path.write_text(json.dumps({"format": "orbitproof-system", "version": 1, **entry}), "utf-8")
    return path


def test_a_json_file_and_a_python_file_of_the_same_formulas_are_the_same_system(tmp_path: Path) -> None:
    text = "\n".join(f"{key} = {value!r}" for key, value in MICHELSON.items())
    source = tmp_path / "own.py"
    source.write_text(text, "utf-8")
    assert load_system(source) is load_system(write(tmp_path / "own.json", MICHELSON))


def test_a_python_function_and_a_formula_give_the_same_values() -> None:
    def field(x: Any, y: Any, z: Any, c: Any) -> Any:
        return y, z, c**2 - y - x**2 / 2

    one, other = described(MICHELSON), described(changed(MICHELSON, name="by-function", field=field))
    assert one.vector_field([1.5, 2.0, 3.0], [0.5]) == other.vector_field([1.5, 2.0, 3.0], [0.5])
    assert list(one.vector_field([1.5, 2.0, 3.0], [0.5])) == [2.0, 3.0, 0.25 - 2.0 - 1.125]


FAR = changed(HENON, name="henon-far", squared_distance="square", distance_name="the origin")


@pytest.mark.parametrize("entry", [MICHELSON, HENON, FAR], ids=["michelson", "henon-heiles", "with a distance"])
def test_a_system_that_goes_through_a_pipe_or_a_file_comes_out_as_itself(entry: dict[str, Any]) -> None:
    system = described(entry)
    assert fault(system) is None
    assert pickle.loads(pickle.dumps(system)) is system
    assert described(json.loads(json.dumps(describe(system)))) is system


def test_a_known_system_goes_through_a_pipe_by_name() -> None:
    for system in (*SYSTEMS.values(), *AROUND.values()):
        assert describe(system) == system.name
        assert pickle.loads(pickle.dumps(system)) is system
    assert isinstance(describe(ReversibleSystem(**{**vars_of(CR3BP), "title": "another"})), dict)


def vars_of(system: ReversibleSystem) -> dict[str, Any]:
    return {name: getattr(system, name) for name in system.__dataclass_fields__}


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (changed(MICHELSON, field={"x": "y", "y": "z", "z": "c - x"}), ("field.z", "f(R x) = -R f(x)")),
        (changed(MICHELSON, field={"x": "y", "y": "z + y", "z": "c - y"}), ("field.y", "not reversible under R")),
        (changed(HENON, symmetries={"S": [1, -1, 1, -1]}), ("field.vx", "does not commute with S")),
        (changed(HENON, R=[1, -1, -1, 1], section="y", symmetries={}), ("field.v", "not reversible under R")),
        (changed(MICHELSON, R=[-1, -1, -1]), ("Fix(R) has the wrong dimension", "one less")),
        (changed(HENON, R=[-1, 1, 1, 1]), ("Fix(R) has the wrong dimension",)),
        (changed(HENON, first_integral="(vx**2 + vy**2 + square)/2 + x**2*y"), ("first_integral", "not conserved")),
        (changed(HENON, first_integral="vx*vy"), ("first_integral", "R changes it")),
        (changed(HENON, first_integral="square"), ("first_integral", "not conserved", "correct it or the field")),
        (changed(HENON, level_coordinate="y"), ("level_coordinate", "A + b y^2")),
        (changed(HENON, level_coordinate="x"), ("level_coordinate", "that R fixes")),
        (changed(MICHELSON, section="w"), ("section", "'w'", "x, y, z")),
        (changed(MICHELSON, section="y"), ("R must negate the section", "x, z")),
        ({k: v for k, v in MICHELSON.items() if k != "family_parameter"}, ("first_integral", "neither is there")),
        (changed(MICHELSON, field={"x": "y", "y": "z", "z": "abs(x)"}), ("field.z", "'abs(x)' is not allowed")),
        (changed(MICHELSON, family_parameter="d"), ("unknown family parameter 'd'",)),
        (changed(MICHELSON, field={"x": "y", "y": "z"}), ("field", "x, y, z")),
        (changed(MICHELSON, field={"x": "y", "y": "z", "z": "tan(x)"}), ("field.z", "'tan(x)' is not allowed")),
        (changed(MICHELSON, field={"x": "y", "y": "z", "z": "q"}), ("field.z", "'q'", "unknown")),
        (changed(MICHELSON, field={"x": "y", "y": "z", "z": "x^2"}), ("field.z", "'x^2' is not allowed")),
        (changed(MICHELSON, field={"x": "y", "y": "z", "z": "(x"}), ("field.z", "no formula")),
        (changed(MICHELSON, name="cr3bp"), ("name", "another system")),
        (changed(MICHELSON, name="a b"), ("name",)),
        (changed(MICHELSON, state=["x", "y", "y"]), ("state", "twice")),
        (changed(MICHELSON, parameters=["x"]), ("parameters", "twice")),
        (changed(MICHELSON, parameters={"c": ["2", "1"]}), ("parameters.c", "empty range")),
        (changed(MICHELSON, R={"u": -1}), ("R.u",)),
        (changed(HENON, squared_distance="(x - 1)**2 + y**2"), ("squared_distance", "R changes it")),
        (changed(HENON, squared_distance="x**2 + y**2 - 9"), ("squared_distance", "negative")),
        (changed(HENON, squared_distance="x**2 + q**2"), ("squared_distance", "'q'", "unknown")),
        (changed(HENON, squared_distance="square", distance_name=""), ("distance_name",)),
        (changed(MICHELSON, colour="red"), ("colour",)),
    ],
)  # fmt: skip
def test_what_is_wrong_is_named_in_one_line(entry: dict[str, Any], words: tuple[str, ...], tmp_path: Path) -> None:
    path = write(tmp_path / "wrong.json", entry)
    with pytest.raises(InputError) as error:
        load_system(path)
    line = str(error.value)
    assert line.startswith(str(path))
    assert "\n" not in line
    for word in words:
        assert word in line


@pytest.mark.parametrize(
    "text",
    [
        "__import__('os').system('true')", "x.real", "[x][0]", "lambda: x", "(x := 2)", "x if x else y", "'a'", "1j",
        "f'{x}'", "x @ y", "x // 2", "x % 2", "-x < 2", "not x", "x**y", "2**(1/2)", "x**1000", "9**99999", "1e99999",
        "((10**90)**90)**90", "1/0", "sqrt(x, y)", "sqrt", "*x", "x; y", "", "\0", "(" * 5000 + "x" + ")" * 5000,
        "x" * 30_000, "x # + y", "x #\n+ y", "#", "abs(x)", "open('a')", "x" + "+x" * 9000, "--" * 9000 + "x",
    ],
)  # fmt: skip
def test_what_is_no_formula_is_refused_and_never_run(text: str) -> None:
    with pytest.raises(FormulaError):
        evaluate_formula(text, {"x": 1.0, "y": 2.0})


@pytest.mark.parametrize(
    ("text", "value"),
    [("0.1", Fraction(1, 10)), ("1/3", Fraction(1, 3)), ("-2**2", Fraction(-4)), ("2e-3", Fraction(1, 500))],
)  # fmt: skip
def test_numbers_of_a_formula_are_exact(text: str, value: Fraction) -> None:
    assert evaluate_formula(text, {}) == value


def test_a_quotient_by_a_power_is_a_power() -> None:
    texts = ("1/sqrt(x**2 + 1)**3", "1/(x**2 + 1)**(3/2)", "(x**2 + 1)**-1.5")
    one, two, three = (evaluate_formula(text, {"x": 2.0}) for text in texts)
    assert one == pytest.approx(two)
    assert two == three
    forms = [described(changed(HENON, name="power", symmetries={}, where={}, R=[-1, 1, 1, -1], **entry)) for entry in (
        {"first_integral": "vx*0 + 2/sqrt(y**2)", "field": {"x": "vx", "y": "0*y", "vx": "0*x", "vy": "vy*0"}},
        {"first_integral": "vx*0 + 2*(y**2)**(-1/2)", "field": {"x": "vx", "y": "0*y", "vx": "0*x", "vy": "vy*0"}},
    )]  # fmt: skip
    assert forms[0] is forms[1]


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    broken = tmp_path / "broken.py"
    broken.write_text("raise RuntimeError('no')", "utf-8")
    for path in (tmp_path / "absent.py", tmp_path / "absent.json", broken):
        with pytest.raises(InputError, match=path.name):
            load_system(path)


@pytest.mark.parametrize("value", [5, [1], {"a": {}}, None, True, {"name": []}])
def test_what_is_no_description_is_refused(value: Any) -> None:
    for key in (*MICHELSON, "where", "symmetries", "first_integral", "level_coordinate", "title"):
        if key == "level_coordinate" and value is None:
            continue
        with suppress(DescriptionError):
            assert described(changed(MICHELSON, **{key: value})).state == ("x", "y", "z")


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_the_examples_are_short_and_hold(path: Path) -> None:
    assert len(path.read_text("utf-8").splitlines()) <= 30
    assert load_system(path).name == path.stem


@pytest.mark.parametrize(
    ("name", "right", "wrong", "line"),
    [
        ("michelson", 'name = "michelson"\n', "", "name: missing"),
        ("michelson", 'title = "Michelson system"', "title = 3", "title: 3 is no title"),
        ("michelson", "family_parameter", "famly_parameter", "famly_parameter: is no key; write family_parameter"),
        ("michelson", "title =", 'reversor = {"T": {"x": -1}}\ntitle =', "reversor: {'T': {'x': -1}} is no name"),
        ("michelson", "title =", 'symmetrys = {"T": {"x": -1}}\ntitle =', "symmetrys: is no key; write symmetries"),
        ("michelson", "c**2 - y", "c**x", "R: exp_1 in the formulas neither stays nor changes its sign"),
        ("hill", 'where = {"pull"', 'where = {"x"', "where.x: is a coordinate"),
        ("hill", "y**2 + z**2)**(-3/2)", "y**2 + q**2)**(-3/2)", "where.pull: the name 'q'"),
        ("hill", '"S": {"z": -1, "vz": -1}', '"S": {"z": -1}', "field.z: does not commute with S"),
        ("hill", '"S": {"z": -1', '"S": {"z": 0', "symmetries.S: [1, 1, 0, 1, 1, -1] is no list of signs"),
        ("hill", '"3*x**2 - z**2', '"2*x**2 - z**2', "first_integral: it is not conserved"),
        ("hill", '"Jacobi constant"', "4", "first_integral_name: 4 is no title"),
        ("hill", 'coordinate = "vy"', 'coordinate = "x"', "level_coordinate: the first integral is not A + b x^2"),
        ("henon-heiles", '"T": {"vx": -1, "vy": -1}', '"T": {"vx": -1}', "reversors.T: section: R must negate"),
        ("henon-heiles", '"T": {"vx": -1', '"T": {"q": 1, "vx": -1', "reversors.T.q: no state coordinate"),
        ("henon-heiles", '"T": {"vx": -1', '"T": {"y": -1, "vx": -1', "reversors.T: Fix(R) has the wrong dimension"),
        ("beam-level", '"sign": 1', '"sign": 2', "fixed_level: {'value': 0, 'sign': 2} is no level"),
        ("beam-level", '"value": 0', '"value": "h"', "fixed_level.value: the name 'h' in 'h' is unknown; known: none"),
        ("beam-level", 'level_coordinate = "u2"\n', "", "fixed_level: needs family_parameter, level_coordinate"),
        ("beam-level", 'fixed_level = {"value": 0, "sign": 1}\n', "", "family_parameter and first_integral; more than"),
    ],
)
def test_an_error_in_any_clause_of_an_example_is_named_in_one_line(
    name: str, right: str, wrong: str, line: str, tmp_path: Path
) -> None:
    text = (EXAMPLES / f"{name}.py").read_text("utf-8")
    assert right in text
    file = tmp_path / f"{name}.py"
    file.write_text(text.replace(right, wrong), "utf-8")
    with pytest.raises(InputError) as error:
        load_system(file)
    assert str(error.value).startswith(str(file))
    assert line in str(error.value)
    assert "\n" not in str(error.value)


def test_a_file_may_have_names_of_its_own(tmp_path: Path) -> None:
    text = (EXAMPLES / "michelson.py").read_text("utf-8")
    file = tmp_path / "own.py"
    file.write_text(f"import math\n_names = 3\nspeed = 2\n\ndef states():\n    return math.pi\n\n{text}", "utf-8")
    assert load_system(file).state == ("x", "y", "z")


LORENZ = {
    "name": "lorenz", "state": "x y z", "parameters": "sigma rho beta",
    "field": {"x": "sigma*(y - x)", "y": "x*(rho - z) - y", "z": "x*y - beta*z"},
}  # fmt: skip


def test_a_system_needs_no_symmetry(tmp_path: Path) -> None:
    system = load_system(write(tmp_path / "lorenz.json", LORENZ))
    assert type(system) is System
    assert repr(system) == "<System lorenz: state x y z, parameters sigma rho beta>"
    assert list(system.vector_field([1, 2, 3], [10, 28, Fraction(8, 3)])) == [10, 23, -6]
    assert pickle.loads(pickle.dumps(system)) is system is define_system(LORENZ)
    by_function = define_system(
        changed(LORENZ, field=lambda x, y, z, s, r, b: (s * (y - x), x * (r - z) - y, x * y - b * z))
    )
    assert by_function.program.evaluate([1, 2, 3, 10, 28, 1]) == [10, 23, -1]
    assert define_system(changed(LORENZ, name="other", parameters={"sigma": ["0", None], "rho": [None, None],
        "beta": [None, None]})).parameters["sigma"].lower == 0  # fmt: skip


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (changed(LORENZ, R={"x": -1}), "section: missing"),
        (changed(LORENZ, section="x"), "R: missing"),
        (changed(LORENZ, symmetries={"S": [-1, -1, 1]}), "symmetries: not without symmetry; it takes R and section"),
        (changed(LORENZ, name="cr3bp"), "another system"),
        (changed(LORENZ, colour="red"), "colour: unknown"),
        (changed(LORENZ, field={"x": "y"}), "field"),
        ({"name": "lorenz", "state": "x y z"}, "field: missing"),
    ],
)  # fmt: skip
def test_half_a_symmetry_is_none(entry: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words):
        define_system(entry)


def test_a_search_asks_for_the_symmetry(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write(tmp_path / "lorenz.json", LORENZ)
    assert explore_main(["candidates", "--system", str(path), "-k", "2", "-o", str(tmp_path / "out.json")]) == 2
    assert "has neither R nor section" in capsys.readouterr().err
    with pytest.raises(InputError, match="has no reversing symmetry"):
        load_system(f"{path}:other")


PULL = "(x**2 + y**2)**(-3/2)"
INTEGRALS = [
    ({"x": "y", "y": "-x"}, "x**2 + y**2", "x + y"),
    ({"x": "y", "y": "-x"}, "x**2 + y**2", "x**2 + y**2*1.0000000001"),
    ({"x": "y", "y": "-sin(x)"}, "y**2/2 - cos(x)", "y**2/2 - cos(x)**2"),
    ({"x": "y", "y": "-sin(100*x)"}, "50*y**2 - cos(100*x)", "50*y**2 + cos(100*x)"),
    ({"x": "x*(1 - y)", "y": "y*(x - 1)"}, "x + y - log(x) - log(y)", "x + y - log(x) + log(y)"),
    ({"x": "y", "y": "exp(-x)*log(3) - exp(x)"}, "y**2/2 + exp(x) + exp(-x)*log(3)", "y**2/2 + exp(x) + exp(-x)"),
    (
        {"x": "u", "y": "v", "u": f"-x*{PULL}", "v": f"-y*{PULL}"},
        "(u**2 + v**2)/2 - 1/sqrt(x**2 + y**2)",
        "(u**2 + v**2)/2 - 1/(x**2 + y**2)**(1/3)",
    ),
]


@pytest.mark.parametrize(("field", "integral", "none"), INTEGRALS)
def test_a_first_integral_that_changes_along_the_field_is_refused(
    field: dict[str, str], integral: str, none: str
) -> None:
    entry = {"name": "moving", "state": " ".join(field), "field": field}
    assert define_system({**entry, "first_integral": integral}).first_integral is not None
    with pytest.raises(InputError, match=r"^first_integral: it is not conserved: its rate of change is"):
        define_system({**entry, "first_integral": none})


WAVES = {
    "name": "waves", "state": "x y z", "parameters": "a", "where": {"r": "exp(-x**2)", "u": "r*y/(2 + z)"},
    "field": {"x": "sin(u) + cos( u )", "y": "log(2 + cos(0.12345678901234567890123*x))", "z": "exp(sin(a)*z)/2"},
    "first_integral": "z + sin(z)",
}  # fmt: skip


def true_values(state: list[float], a: float) -> tuple[dict[str, float], list[float]]:
    """The functions that stand in the formulas, and the field, in floating point."""
    x, y, z = state
    angle, r = 0.12345678901234567890123 * x, exp(-(x**2))
    u = r * y / (2 + z)
    field = [sin(u) + cos(u), log(2 + cos(angle)), exp(sin(a) * z) / 2]
    return {"sin": sin(u), "cos": cos(u), "exp": r, "log": field[1]}, field


def test_functions_in_formulas_become_coordinates_with_rates() -> None:
    system = described_plainly(WAVES)
    assert system.given_state == ("x", "y", "z")
    assert system.state[:3] == ("x", "y", "z")
    assert len(system.state) == 3 + len(system.defined)
    assert {each.function for each in system.defined} == {"sin", "cos", "exp", "log"}
    # sin and cos of three arguments, with their partners, exp of two, log of one.
    assert len(system.defined) == 2 * 4 + 2 + 1
    functions = {"sin": sin, "cos": cos, "exp": exp, "log": log}

    def extended(state: list[float], a: float) -> list[float]:
        values = list(state)
        for each in system.defined:
            padded = values + [float("nan")] * (len(system.state) - len(values))
            values.append(functions[each.function](each.argument(padded, [a])[0]))
        return values

    source = random.Random(1)
    for _ in range(20):
        state, a = [source.uniform(-1, 1) for _ in range(3)], source.uniform(-1, 1)
        known, field = true_values(state, a)
        values = extended(state, a)
        rates = system.vector_field(values, [a])
        assert list(rates[:3]) == pytest.approx(field)
        named = dict(zip(system.state, values, strict=True))
        assert all(any(abs(named[n] - value) < 1e-12 for n in named) for value in known.values())
        step = 1e-6
        ends = [extended([x + side * step * f for x, f in zip(state, field, strict=True)], a) for side in (1, -1)]
        slopes = [(right - left) / (2 * step) for right, left in zip(*ends, strict=True)]
        assert list(rates) == pytest.approx(slopes, abs=1e-7)
        assert system.first_integral is not None
        assert system.first_integral(values, [a])[0] == pytest.approx(state[2] + sin(state[2]))
    assert any("12345678901234567890123/" in program.text() for program in system.argument_programs)


def test_a_system_with_functions_goes_through_a_pipe_and_a_file() -> None:
    system = described_plainly(WAVES)
    assert pickle.loads(pickle.dumps(system)) is system
    assert described_plainly(json.loads(json.dumps(describe(system)))) is system
    assert described_plainly(WAVES) is system


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (changed(WAVES, field={**WAVES["field"], "x": "sin(x, y)"}), "not allowed"),
        (changed(WAVES, field={**WAVES["field"], "x": "tan(x)"}), "not allowed"),
        (changed(WAVES, field={**WAVES["field"], "x": "sin(q)"}), "unknown"),
        (changed(WAVES, field={**WAVES["field"], "x": "sin()"}), "not allowed"),
        (changed(WAVES, field={"x": "sin(x)"}), "field"),
        (changed(WAVES, field={**WAVES["field"], "x": "+".join(f"sin({n}*x)" for n in range(30))}), "more than 20"),
        (changed(WAVES, where={"x": "sin(y)"}), "where.x"),
        (changed(LORENZ, defined=[["z", "tan", "v0 = x"]]), "defined"),
        (changed(LORENZ, defined=[["y", "sin", "x"]]), "defined"),
        (changed(LORENZ, defined=5), "defined"),
        (changed(LORENZ, defined=[["z", "sin"]]), "defined: is no list"),
        (changed(LORENZ, defined=[5]), "defined: is no list"),
    ],
)  # fmt: skip
def test_functions_that_cannot_be_read_are_named_in_one_line(entry: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=words) as error:
        define_system(entry)
    assert "\n" not in str(error.value)


def test_functions_of_python_are_no_formulas_and_the_error_says_what_is() -> None:
    with pytest.raises(InputError, match="sin, cos, exp and log are for formulas as text"):
        define_system({**LORENZ, "field": lambda *values: (sin(values[0]),) * 3})
