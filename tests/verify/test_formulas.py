"""The formulas of a statement say what the programs compute, and what is said in full is derived."""

from __future__ import annotations

import random
import re
from dataclasses import replace
from fractions import Fraction
from itertools import product
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support.claims import coordinates_in_box, known
from support.told import in_full as told_in_full

from orbitproof.shared.systems import (
    BRANCH_SYSTEMS,
    LEVEL_NAME,
    SYSTEMS,
    Program,
    program_from_text,
    record,
)
from orbitproof.verify.bifurcation import BifurcationTheorem
from orbitproof.verify.certificate import Certificate, Limits, certify, digest, is_proof_of, recheck
from orbitproof.verify.claim import level_program
from orbitproof.verify.words.formulas import equations, setting

PROGRAMS = {
    **{name: system.program for name, system in BRANCH_SYSTEMS.items()},
    **{
        f"H of {name}": system.first_integral_program
        for name, system in BRANCH_SYSTEMS.items()
        if system.first_integral_program is not None
    },
    "level coordinate": program_from_text(level_program(SYSTEMS["cr3bp"], 1).text().replace(LEVEL_NAME, "height")),
    "signs and quotients": record(
        lambda s, p: (s[0] - (s[1] - p[0]), s[0] / (s[1] / p[0]), -(s[0] - s[1]) * -s[0], (s[0] * s[1]) ** -2,
                      s[0] ** 2 / (s[1] * p[0]), -(s[0] ** -0.5) + Fraction(1, 3) * s[1], Fraction(-2) ** 3 * s[0]),
        ("x", "a"), ("b",),
    ),
}  # fmt: skip


def values(lines: list[str], inputs: dict[str, float]) -> list[float]:
    """What the formulas give, read as a reader of mathematics reads them: Python differs in the power sign only."""
    definitions = [line.split(" = ", 1) for line in lines]
    known_values: dict[str, Any] = dict(inputs)
    outputs = [body for name, body in definitions if name.startswith("out")]
    for name, body in definitions:
        if not name.startswith("out"):
            known_values[name] = eval(body.replace("^", "**"), {}, known_values)
    return [eval(body.replace("^", "**"), {}, known_values) for body in outputs]


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS.keys())
def test_formulas_compute_what_the_program_computes(program: Program) -> None:
    source = random.Random(7)
    lines = equations(program, [f"out{i}" for i in range(len(program.outputs))])
    for _ in range(20):
        arguments = {name: -20.0 if name == "height" else source.uniform(0.1, 0.9) for name in program.inputs}
        assert values(lines, arguments) == pytest.approx(program.evaluate(list(arguments.values())), rel=1e-9)


@pytest.mark.parametrize("program", PROGRAMS.values(), ids=PROGRAMS.keys())
def test_a_formula_of_another_program_differs(program: Program) -> None:
    """One operation changed in the program changes what is printed."""
    text = program.text()
    other = re.sub(r" (\+) ", " - ", text, count=1)
    if other == text:
        other = text.replace(" - ", " + ", 1)
    left = [f"out{i}" for i in range(len(program.outputs))]
    assert equations(program_from_text(other), left) != equations(program, left)


def test_each_letter_of_a_system_of_ones_own_has_one_meaning() -> None:
    """In Hill's units the field and the integral are written with letters."""
    lines = setting(replace(BRANCH_SYSTEMS["cr3bp-hill"], name="own"), {}, None)
    left = [line.partition(" = ")[0].strip() for line in lines if line.startswith("  ")]
    assert len({*left}) == len(left) > len(SYSTEMS["cr3bp"].state) + 4


def test_the_images_of_a_point_under_the_symmetries_are_printed_with_their_signs() -> None:
    lines = setting(SYSTEMS["cr3bp"], {}, "S")
    assert "R(x, y, z, vx, vy, vz) = (x, -y, z, -vx, vy, -vz) reverses the flow." in lines
    assert "S(x, y, z, vx, vy, vz) = (x, y, -z, vx, vy, -vz) commutes with it." in lines


@pytest.fixture(scope="module", params=["fs2", "fs3", "em1"])
def certificate(request: pytest.FixtureRequest) -> Certificate:
    return certify(known(request.param), Limits(max_precision=256))


def in_full(certificate: Certificate) -> str:
    return str(certificate.statement["in_full"])


def test_what_is_said_in_full_names_system_box_meaning_and_results(certificate: Certificate) -> None:
    text, claim = in_full(certificate), certificate.candidate
    for name in claim.system.state:
        assert f"  {name}' = " in text
    assert f"{{{claim.system.section} = 0}}" in text
    assert certificate.theorem is not None
    assert certificate.theorem in text
    assert " means: " in text
    for name, value in claim.parameters.items():
        assert f"  {name} = {float(value):.17g} (exactly 0x" in text
    assert ("A first integral" in text) == (claim.system.first_integral is not None)
    assert ("The candidate's own box:" in text) == ("level_form" in certificate.statement)
    for name, ball in certificate.point.items():
        assert (f"{name} = 0," if ball == 0 else f"{name} in ") in text.split("The bifurcation point has")[1]


def test_decimals_of_the_box_are_rounded_to_the_right_side(certificate: Certificate) -> None:
    """Outward where the box is enclosed, inward where points are said to lie in it."""
    claim = certificate.candidate
    text = in_full(certificate).split("The candidate's own box:")[-1]
    corners = [
        tuple(sum((a * b for a, b in zip(row, p, strict=True)), middle)
              for middle, row in zip(claim.centre, claim.frame, strict=True))
        for signs in product((1, -1), repeat=len(claim.radii))
        for p in [tuple(sign * radius for sign, radius in zip(signs, claim.radii, strict=True))]
    ]  # fmt: skip
    for name, *ends in zip(claim.coordinates, *corners, strict=True):
        low, high = (Fraction(end) for end in re.search(
            rf"on the box {name} lies in \[(\S+), (\S+)\]\.", text).groups())  # type: ignore[union-attr]  # fmt: skip
        assert all(low <= end <= high for end in ends)
    reach = Fraction(re.search(r"by at most (\S+)\.", text).group(1))  # type: ignore[union-attr]
    for signs in product((1, -1), repeat=len(claim.centre)):
        corner = tuple(c + sign * reach for c, sign in zip(claim.centre, signs, strict=True))
        inside = coordinates_in_box(claim, corner)
        assert all(abs(value) <= radius for value, radius in zip(inside, claim.radii, strict=True))
    assert reach > min(claim.radii) / 10


@pytest.mark.parametrize(
    ("side", "words"), [("above", "greater than"), ("below", "less than"), ("both", "on both sides of")]
)
def test_the_side_of_the_new_orbits_is_said_as_it_is(side: str, words: str) -> None:
    found = SimpleNamespace(point={}, parameter=arb(1), parameter_name="H", side=side)
    text = told_in_full(known("fs2"), BifurcationTheorem(known("fs2")), found)
    assert f"The new orbits exist for values of the parameter {words} that." in text


def test_a_changed_word_is_said_and_is_no_proof_of_the_candidate(certificate: Certificate) -> None:
    assert is_proof_of(certificate, certificate.candidate)
    entry = certificate.to_json()
    entry["statement"]["in_full"] = entry["statement"]["in_full"].replace("reverses", "preserves")
    entry["digest"] = digest(entry)
    changed = Certificate.from_json(entry)
    assert recheck(changed).word == "DOES NOT STAND"
    assert not is_proof_of(changed, certificate.candidate)
