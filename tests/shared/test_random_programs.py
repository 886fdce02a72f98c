"""Programs that are made at random: what they compute, their texts, derivatives, parities; coordinates of systems."""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction as F
from typing import Any

import pytest
from support.random_programs import Dual, dual, function_of, place, recorded, whole_power

from orbitproof.shared.systems import ParameterRange, ReversibleSystem, record
from orbitproof.shared.systems.parity import has_parities, parities
from orbitproof.shared.systems.program_text import program_from_text
from orbitproof.shared.systems.slopes import with_slope

SEEDS = range(24)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_program_computes_its_function_and_is_read_from_its_text(seed: int) -> None:
    chance = random.Random(seed)
    program = recorded(seed, 3, 2)
    function = function_of(seed, 3, 2)
    assert program_from_text(program.text()) == program
    for _ in range(4):
        x = place(chance, 3)
        values = program.evaluate(x, F, whole_power)
        assert values == function(x)
        # It depends on no input but those that are said to be used.
        others = [
            value if name in program.used_inputs else value + 1 for name, value in zip(program.inputs, x, strict=True)
        ]
        assert program.evaluate(others, F, whole_power) == values


@pytest.mark.parametrize("seed", SEEDS)
def test_the_derivative_of_a_program_is_that_of_its_function_in_each_input(seed: int) -> None:
    chance = random.Random(seed)
    program = recorded(seed, 3)
    function = function_of(seed, 3)
    x = place(chance, 3)
    for number, name in enumerate(program.inputs):
        both = with_slope(program, name)
        assert both.inputs == program.inputs
        (exact,) = function([Dual(value, F(int(i == number))) for i, value in enumerate(x)])
        assert both.evaluate(x, F, whole_power) == [dual(exact).value, dual(exact).slope]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_parity_that_is_told_is_one_at_all_points(seed: int) -> None:
    chance = random.Random(seed)
    program = recorded(seed, 4, 3)
    for _ in range(8):
        signs = [chance.choice((-1, 1)) for _ in range(3)]
        found = parities(program, signs)
        for _ in range(2):
            x = place(chance, 4)
            turned = [s * value for s, value in zip([*signs, 1], x, strict=True)]
            for parity, a, b in zip(
                found, program.evaluate(x, F, whole_power), program.evaluate(turned, F, whole_power), strict=True
            ):
                assert parity == 0 or b == parity * a
    assert parities(program, [1, 1, 1]) == [1, 1, 1]


@pytest.mark.parametrize("size", [1, 2, 3])
def test_every_output_has_the_parity_that_is_wanted(size: int) -> None:
    """Of powers with a fraction only even ones of something even are known."""
    chance = random.Random(size)
    for _ in range(10):
        signs = [chance.choice((-1, 1)) for _ in range(size)]
        wanted = [chance.choice((-1, 1)) for _ in range(size)]
        signs[0] = -1

        def field(x: Sequence[Any], spoiled: int | None = None, signs: Any = signs, wanted: Any = wanted) -> list[Any]:
            even = (1 + sum((y * y for y in x[1:]), x[0] * x[0])) ** F(1, 2)
            rows = [even * (x[0] if w < 0 else x[0] * x[0]) for w in wanted]
            if spoiled is not None:
                rows[spoiled] = rows[spoiled] + (even if wanted[spoiled] < 0 else x[0])
            return rows

        names = [f"x{i}" for i in range(size)]
        assert has_parities(record(field, names), signs, wanted)
        for spoiled in range(size):
            assert not has_parities(record(lambda x, s=spoiled, f=field: f(x, s), names), signs, wanted)
            turned = [-w if i == spoiled else w for i, w in enumerate(wanted)]
            assert not has_parities(record(field, names), signs, turned)
        assert not has_parities(record(field, names), signs, wanted[:-1])
    for exponent, parity in ((F(2), 1), (F(3), -1), (F(-1), -1), (F(-2), 1), (F(1, 2), 0), (F(2, 3), 0), (F(0), 1)):
        assert parities(record(lambda x, e=exponent: (x[0] ** e,), ("x",)), [-1]) == [parity]


def test_coordinates_are_those_that_an_involution_fixes_or_negates() -> None:
    chance, made = random.Random(1), 0
    while made < 30:
        size = chance.randint(3, 7)
        names = tuple(f"x{i}" for i in range(size))
        signs = [chance.choice((-1, 1)) for _ in range(size)]
        negated, fixed = ([i for i, sign in enumerate(signs) if sign == s] for s in (-1, 1))
        if len(negated) < 2 or len(fixed) not in (len(negated) - 1, len(negated)):
            continue
        made += 1
        section = chance.choice(negated)
        family = len(fixed) == len(negated) - 1
        more: dict[str, Any] = {"family_parameter": "b"} if family else {"first_integral": lambda x, _: (x[0],)}
        if not family:
            more["level_coordinate"] = names[fixed[-1]]
        system = ReversibleSystem(
            name="any", title="any", state=names,
            parameters=dict.fromkeys(("c", "b", "a"), ParameterRange(None, None)), vector_field=lambda x, _: x,
            reversing_symmetry=tuple(signs), section=names[section], **more,
        )  # fmt: skip
        assert system.section_index == section
        assert list(system.fixed_coordinates) == fixed
        assert list(system.kernel_coordinates) == [i for i in negated if i != section]
        centre = [*(["b"] if family else []), *(names[i] for i in fixed)]
        assert list(system.centre_coordinates) == centre
        assert system.fixed_parameters == (("c", "a") if family else ("c", "b", "a"))
        if not family:
            assert list(system.level_coordinates[1:]) == [names[i] for i in fixed[:-1]]


def test_a_range_is_open_at_both_ends() -> None:
    both = ParameterRange(F(-1, 2), F(3))
    for value, inside in ((F(-1, 2), False), (F(3), False), (F(-1, 3), True), (F(29, 10), True), (F(4), False)):
        assert both.contains(value) is inside
    assert ParameterRange(None, F(0)).contains(F(-(10**9)))
    assert not ParameterRange(None, F(0)).contains(F(0))
    assert not ParameterRange(F(0), None).contains(F(-1))
