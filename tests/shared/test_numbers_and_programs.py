"""Exact numbers as text, formulas and programs mean one thing; what means none or another is refused."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from support.flow_checks import falkner_skan_box, halo
from support.wide_checks import TWIST, piece

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import (
    Candidate,
    InputError,
    candidate_from_json,
    candidate_to_json,
    piece_from_json,
    read_candidates,
    write_candidates,
)
from orbitproof.shared.formats.documents import validator
from orbitproof.shared.numbers import NUMBER, RATIONAL, dyadic, format_dyadic, format_rational, round_dyadic
from orbitproof.shared.systems import (
    CR3BP,
    IDENTIFIER,
    LEVEL_NAME,
    DescriptionError,
    ParameterRange,
    described,
    evaluate_formula,
    fits,
    own_name,
    program_from_text,
    record,
)

# Numbers


@pytest.mark.parametrize(
    "text, value",
    [
        ("0x1f", Fraction(31)), ("-0x3p-2", Fraction(-3, 4)), ("0x3p+4", Fraction(48)), ("-0x0", Fraction(0)),
        ("-1.25e-1", Fraction(-1, 8)), ("12e2", Fraction(1200)), ("0.1", Fraction(1, 10)), ("-6/4", Fraction(-3, 2)),
    ],
)  # fmt: skip
def test_a_number_is_what_its_text_says(text: str, value: Fraction) -> None:
    assert parse_exact(text) == value


@pytest.mark.parametrize("number", ["0x1f", "-0x3p-2", "12", "-0.5", "1e2", "3/4"])
@pytest.mark.parametrize("more", [" ", "\n", "g", "_0", "p", "p1.5", "p1234567", "e123456", "/0", "."])
def test_nothing_stands_before_or_after_a_number(number: str, more: str) -> None:
    # To hexadecimal digits an e belongs.
    texts = [more + number] if number == "0x1f" and more.startswith("e") else [number + more, more + number]
    for text in texts:
        with pytest.raises(ValueError, match="not an exact number"):
            parse_exact(text)


@given(st.integers(-(2**70), 2**70), st.integers(-2000, 2000))
def test_a_mantissa_and_an_exponent_are_a_dyadic_number(mantissa: int, exponent: int) -> None:
    assert dyadic(mantissa, exponent) == mantissa * Fraction(2) ** exponent


@given(st.integers(-(2**80), 2**80), st.integers(0, 40), st.integers(0, 40), st.integers(-60, 60))
def test_a_number_is_written_as_it_is_read(numerator: int, twos: int, fives: int, power: int) -> None:
    value = Fraction(numerator, 2**twos * 5**fives)
    assert parse_exact(format_exact(value)) == value
    assert parse_exact(format_rational(value / 7)) == value / 7
    dyadic = numerator * Fraction(2) ** power
    assert parse_exact(format_dyadic(dyadic)) == dyadic


@pytest.mark.parametrize("denominator", [3, 6, 7, 15, 24, 26, 624, 3126, 5**20 + 2, 5**20 - 4])
def test_what_is_neither_dyadic_nor_decimal_is_written_as_a_fraction_only(denominator: int) -> None:
    value = Fraction(1, denominator)
    with pytest.raises(ValueError, match="neither dyadic nor decimal"):
        format_exact(value)
    with pytest.raises(ValueError, match="not dyadic"):
        format_dyadic(value)
    assert format_rational(value) == f"1/{denominator}"


@given(st.fractions(max_denominator=10**30), st.integers(1, 60))
def test_the_rounded_number_is_the_nearest_one_of_so_many_bits(value: Fraction, bits: int) -> None:
    rounded = round_dyadic(value, bits)
    digits = format_dyadic(rounded).lstrip("-").partition("p")[0]
    assert int(digits, 16).bit_length() <= bits + 1
    assert abs(rounded - value) <= abs(value) / 2**bits


# Formulas and programs


def operations(x: Sequence[Any]) -> Sequence[Any]:
    """What the order of operands matters for, with numbers on either side, and what it does not."""
    a, b = x
    return (a - b, b - a, a / b, b / a, 3 - a, a - 3, 2 / a, a / 2, a + b, b + a, a * b, -a, a**-2, b**0.5, 1 - a / b)


def test_a_recorded_program_computes_what_the_function_does() -> None:
    program = record(operations, ("a", "b"))
    assert program.evaluate([1.75, 2.25]) == list(operations([1.75, 2.25]))
    assert program_from_text(program.text()) == program


@pytest.mark.parametrize("constant", [0.1, 1e-3, 0.25, True, "1"])
def test_a_constant_that_is_not_exact_is_refused(constant: Any) -> None:
    with pytest.raises(TypeError):
        record(lambda x: (x[0] + constant,), ("a",))


@pytest.mark.parametrize("constant", [2, 0.5, -1.5, Fraction(1, 10)])
def test_a_constant_that_is_exact_is_that_number(constant: Any) -> None:
    (value,) = record(lambda x: (x[0] * constant,), ("a",)).evaluate([Fraction(1)], lambda number: number)
    assert value == Fraction(constant)


@pytest.mark.parametrize(
    "lines",
    [
        ("v0 = a", "v1 = v1 + v0", "return v1"),
        ("v0 = a", "v1 = v2 + v0", "v2 = v0 * v0", "return v1"),
        ("v0 = a", "v2 = v0 + v0", "return v1"),
        ("v0 = a", "v1 = v0 + v0", "return v2"),
        ("v0 = a", "v1 = 2/4", "return v1"),
        ("v0 = a", "v1 = v0 + v0", "v2 = v0 + v0", "return v1, v2"),
        ("v0 = 1", "v1 = a", "return v1"),
        ("v0 = a", "v1 = a", "return v1"),
        ("v0 = v1", "v1 = v0 + v0", "return v1"),
        ("v0 = a", "v1 = v00 + v0", "return v1"),
        ("v0 = a", "v1 = 1/0", "return v1"),
    ],
)
def test_a_text_that_is_not_the_one_text_of_a_program_is_refused(lines: Sequence[str]) -> None:
    with pytest.raises(ValueError):
        program_from_text("\n".join(lines))


@pytest.mark.parametrize(
    "text, wanted",
    [
        ("0.1", Fraction(1, 10)), ("1/3 - 0.25", Fraction(1, 12)), ("2**-3/4", Fraction(1, 32)),
        ("3/2**2", Fraction(3, 4)), ("-2**2", Fraction(-4)), ("1e-3*5", Fraction(1, 200)),
    ],
)  # fmt: skip
def test_a_formula_without_names_is_an_exact_number(text: str, wanted: Fraction) -> None:
    assert evaluate_formula(text, {}) == wanted


@pytest.mark.parametrize(
    "text, wanted", [("3/a**2", 0.1875), ("a/sqrt(a)", 2.0), ("sqrt(a)", 2.0), ("a**(1/2) - a", -2.0)]
)
def test_a_formula_of_names_is_what_it_says(text: str, wanted: float) -> None:
    program = record(lambda x: (evaluate_formula(text, {"a": x[0]}),), ("a",))
    assert program.evaluate([4.0]) == [wanted]


# Systems


@pytest.mark.parametrize(
    "change, words",
    [
        ({"section": "a"}, "R must negate the section coordinate"),
        ({"reversing_symmetry": (2, -1, 1, -1)}, "R needs 4 signs"),
        ({"reversing_symmetry": (1, -1, 1)}, "R needs 4 signs"),
        ({"symmetries": {"S": (1, 1, 0, -1)}}, "S needs 4 signs"),
        ({"reversing_symmetry": (1, -1, -1, -1)}, "Fix.R. has the wrong dimension"),
        ({"reversing_symmetry": (1, -1, 1, 1)}, "Fix.R. has the wrong dimension"),
        ({"level_coordinate": "d"}, "a coordinate that R fixes"),
    ],
)
def test_a_system_that_does_not_fit_together_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        replace(TWIST, **change)


FOCUS: dict[str, Any] = {
    "name": "focus", "state": "a b c", "parameters": ["m"], "field": {"a": "b", "b": "m*a", "c": "b*c"},
    "R": {"b": -1, "c": -1}, "section": "b", "family_parameter": "m",
}  # fmt: skip


def test_signs_that_are_not_given_are_one() -> None:
    assert described(FOCUS).reversing_symmetry == (1, -1, -1)


@pytest.mark.parametrize("name", ["v0", "v17", "sqrt", "class", "1a", "a-b"])
def test_the_name_of_a_coordinate_is_no_line_of_a_program_and_no_other_word(name: str) -> None:
    entry = {**FOCUS, "state": [name, "b", "c"], "field": {name: "b", "b": "m", "c": "b*c"}}
    with pytest.raises(DescriptionError, match="state"):
        described(entry)


@pytest.mark.parametrize("name", ["(level)", "a b", "", "b"])
def test_names_of_a_system_are_identifiers_and_all_different(name: str) -> None:
    """A system that is made in Python too."""
    with pytest.raises(ValueError, match=f"called '{name}'|'{re.escape(name)}' is no name"):
        replace(TWIST, state=(name, *TWIST.state[1:]))
    with pytest.raises(ValueError, match=f"called '{name}'|'{re.escape(name)}' is no name"):
        replace(TWIST, parameters={**TWIST.parameters, name: ParameterRange(None, None)})


def test_names_of_our_own_are_no_identifiers_and_no_text_of_a_program_has_them() -> None:
    for name in (own_name("distance"), LEVEL_NAME):
        assert not name.isidentifier()
        assert not fits(IDENTIFIER, name)
        text = record(lambda a: a, [name]).text()
        with pytest.raises(ValueError, match="no operation"):
            program_from_text(text)


def test_two_inputs_of_a_program_have_two_names() -> None:
    with pytest.raises(ValueError, match="one name"):
        record(lambda a, b: [a[0] - b[0]], ["x"], ["x"])


def test_coordinates_of_a_claim_differ_whatever_the_first_integral_is_called() -> None:
    for name in ("vy", "x", "mu", "level", None):
        system = replace(CR3BP, first_integral_name=name)
        names = (*system.level_coordinates, *system.parameters)
        assert len(set(names)) == len(names)


def test_no_system_has_the_name_of_a_known_one() -> None:
    with pytest.raises(DescriptionError, match="the name of another system"):
        described({**FOCUS, "name": "cr3bp"})


# Claims and pieces


def claim() -> dict[str, Any]:
    return candidate_to_json(halo("earth-moon", "period_tupling", ("1e-9",) * 3))


@pytest.mark.parametrize(
    "change, words",
    [
        ({"radii": ["0x1", "0x0", "0x1"]}, "radii"),
        ({"radii": ["0x1", "-0x1", "0x1"]}, "radii"),
        ({"parameters": {}}, "parameters"),
        ({"parameters": {"mu": "0.1", "nu": "0.1"}}, "parameters"),
        ({"parameters": {"mu": "0"}}, r"parameters\.mu"),
        ({"parameters": {"mu": "1"}}, r"parameters\.mu"),
        ({"parameters": {"mu": "-1/3"}}, r"parameters\.mu"),
        ({"kind": "orbit", "k": 1, "equation": {"quantity": "half period", "value": "0"}}, r"equation\.value"),
        ({"kind": "orbit", "k": 1, "equation": {"quantity": "half period", "value": "-1"}}, r"equation\.value"),
    ],
)
def test_a_claim_that_says_nothing_is_refused(change: dict[str, Any], words: str) -> None:
    assert candidate_from_json(claim(), "here").system is CR3BP
    with pytest.raises(InputError, match=f"here.{words}"):
        candidate_from_json({**claim(), **change}, "here")


@pytest.mark.parametrize("more", [{"vx": Fraction(1)}, {"y": Fraction(1, 2)}, {"nu": Fraction(0)}])
def test_a_claim_gives_its_parameters_and_nothing_else_a_value(more: dict[str, Fraction]) -> None:
    """Values of a box are found by name: one for a coordinate would move its points."""
    good = halo("earth-moon", "period_tupling", ("1e-9",) * 3)
    with pytest.raises(InputError, match="parameters"):
        replace(good, parameters={**good.parameters, **more})


def test_two_claims_of_a_file_do_not_have_one_name(tmp_path: Any) -> None:
    one: Candidate = falkner_skan_box("period_tupling", 2, ("1e-9", "1e-9"))
    write_candidates(tmp_path / "two.json", [one, replace(one, id="other")])
    assert len(read_candidates(tmp_path / "two.json")) == 2
    write_candidates(tmp_path / "two.json", [one, one])
    with pytest.raises(InputError, match="appears twice"):
        read_candidates(tmp_path / "two.json")


TUBE = piece(("0.5", "0.3"), (("1", "1/8"), ("1/4", "1")), "1/4", (("0", "1/2", "1/4"),), ("1e-6",))


def test_a_piece_is_read_as_it_is_written_and_its_points_are_centre_plus_frame_times_p() -> None:
    assert piece_from_json(to_json(TUBE), TWIST, "here") == TUBE
    s = Fraction(-1, 2)
    p = (Fraction(1, 4) * s, s / 2 + s * s / 4)
    assert TUBE.local(s) == p
    assert TUBE.point(s) == (Fraction(1, 2) + p[0] + p[1] / 8, Fraction(3, 10) + p[0] / 4 + p[1])


@pytest.mark.parametrize(
    "change, words",
    [
        ({"tube": ["0"]}, "tube"),
        ({"tube": ["-1"]}, "tube"),
        ({"half_width": "0"}, "half_width"),
        ({"frame": [["1", "2"], ["2", "4"]]}, "frame: is singular"),
        ({"frame": [["3", "1"], ["2", "2/3"]]}, "frame: is singular"),
        ({"frame": [["0", "0"], ["1", "1"]]}, "frame: is singular"),
    ],
)
def test_a_piece_that_is_no_tube_about_a_curve_is_refused(change: dict[str, Any], words: str) -> None:
    with pytest.raises(InputError, match=f"here.{words}"):
        piece_from_json({**to_json(TUBE), **change}, TWIST, "here")


def test_a_frame_that_only_looks_singular_is_regular() -> None:
    for rows in ([["3", "2"], ["2", "2"]], [["0", "1"], ["1", "0"]], [["2", "4"], ["1", "1"]]):
        read = piece_from_json({**to_json(TUBE), "frame": rows}, TWIST, "here")
        assert read.frame == tuple(tuple(map(Fraction, row)) for row in rows)


@pytest.mark.parametrize(("kind", "pattern"), [("number", NUMBER), ("rational", RATIONAL)])
def test_numbers_of_claims_are_as_long_as_the_schemas_say(kind: str, pattern: str) -> None:
    assert validator("candidates").schema["$defs"][kind]["pattern"] == f"^({pattern})$"
