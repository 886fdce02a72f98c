"""Programs of certificates in second proofs: values, jets, gradients, parities and dependence, at random."""

from __future__ import annotations

import random
from fractions import Fraction as F
from importlib import import_module
from typing import Any

import pytest
from support.balls import agree
from support.random_programs import Dual, dual, function_of, place, recorded, whole_power

from orbitproof.shared.systems import record
from orbitproof.verify import second_proof as package

jets, stating, statement = (
    import_module(f"{package.__name__}.{name}") for name in ("jets", "periodic_statement", "statement")
)
EXACT = statement.ARITHMETIC | {"**": whole_power}
SEEDS = range(16)


@pytest.mark.parametrize("seed", SEEDS)
def test_a_text_computes_its_function_with_all_derivatives(seed: int) -> None:
    chance = random.Random(seed)
    text, function = recorded(seed, 3), function_of(seed, 3)
    program = statement.Program.from_text(text.text())
    assert program.inputs == text.inputs
    x = place(chance, 3)
    known = dict(zip(text.inputs, x, strict=True))
    assert program.run(known, lambda value: value, EXACT) == function(x)
    slopes = [dual(function([Dual(v, F(int(i == j))) for i, v in enumerate(x)])[0]).slope for j in range(3)]
    gradient = stating.gradient(program, text.inputs)
    assert gradient.run(known, lambda value: value, EXACT) == slopes
    with jets.precision(200):
        inputs = {name: jets.Jet({(): jets.ball(v), (j,): jets.ball(F(1))}, 2)
                  for j, (name, v) in enumerate(known.items())}  # fmt: skip
        (found,) = program.at(inputs, next(iter(inputs.values())))
        assert agree(found[()], jets.ball(function(x)[0]))
        assert all(agree(found[j,], jets.ball(slope)) for j, slope in enumerate(slopes))
        assert all(c.rad() < 1e-30 for c in found.values())
        (number,) = program.at({name: jets.ball(v) for name, v in known.items()}, jets.ball(F(0)))
        assert agree(number, found[()])


@pytest.mark.parametrize("seed", SEEDS)
def test_parity_and_dependence_are_told_where_they_are_so(seed: int) -> None:
    chance = random.Random(seed)
    text = recorded(seed, 3, 3)
    program = statement.Program.from_text(text.text())
    for _ in range(6):
        signs = dict(zip(text.inputs, (chance.choice((-1, 1)) for _ in range(3)), strict=True))
        told = program.run(signs, lambda _: 1, statement.PARITY)
        x = place(chance, 3)
        turned = [signs[name] * value for name, value in zip(text.inputs, x, strict=True)]
        values, others = (text.evaluate(at, F, whole_power) for at in (x, turned))
        for parity, a, b in zip(told, values, others, strict=True):
            assert parity == 0 or b == parity * a
    names = {name: frozenset({name}) for name in text.inputs}
    for used, place_of in zip(program.run(names, lambda _: frozenset(), stating.DEPENDENCE), range(3), strict=True):
        for number, name in enumerate(text.inputs):
            if name in used:
                continue
            x = place(chance, 3)
            moved = [value + (i == number) for i, value in enumerate(x)]
            values, others = (text.evaluate(at, F, whole_power) for at in (x, moved))
            assert values[place_of] == others[place_of]


@pytest.mark.parametrize("size", [2, 3, 4])
def test_volume_is_kept_where_no_component_depends_on_its_own_coordinate(size: int) -> None:
    """It takes one component alone that does, whichever it is."""
    names = tuple(f"x{i}" for i in range(size))

    def field(x: Any, own: int | None) -> list[Any]:
        return [x[i - 1] ** 2 + (x[i] ** 3 if i == own else x[(i + 1) % size] if size > 2 else 0) for i in range(size)]

    for own in (None, *range(size)):
        program = record(lambda x, own=own: field(x, own), names)
        claim = stating.PeriodicStatement(
            names, {}, statement.Program.from_text(program.text()), None, None, None, (F(1),) * size, F(0), 1, 1,
            (F(0),) * size, ((F(0),),) * size,
        )  # fmt: skip
        assert claim.keeps_volume() is (own is None)
