"""The first precision and the step sizes are right at the first attempt, also where orbits lose more digits than usual.

None of this carries proof: a guess that is wrong costs an attempt.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest

from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import read_candidates
from orbitproof.shared.systems import record
from orbitproof.verify.algebra import Arithmetic, Grading, prepare
from orbitproof.verify.attempt import first_precision, steps_of_centre
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate import certify
from orbitproof.verify.flow import dyadic_below
from orbitproof.verify.oracle.solution import CentreExpansion
from orbitproof.verify.poincare import PHYSICAL

ROWS = {row.id: row for row in read_candidates(Path(__file__).parents[1] / "data" / "far-arc-candidates.json")}
EARTH_MOON, SUN_JUPITER = "earth-moon-L1-halo-k3-5", "sun-jupiter-L1-halo-k3-5"
BITS, DEGREE = 176, 88


def expansion(weak: float) -> CentreExpansion:
    """Of t' = 1, x' = 1/(3 - t) + weak/(1 - t) at t = 0: a second, closer singularity that the first terms hide."""

    def field(state: Any, parameters: Any) -> Any:
        t, _ = state
        return t * 0 + 1, (3 - t) ** -1 + Fraction(weak) * (1 - t) ** -1

    program = prepare(record(field, ("t", "x"), ()))
    arithmetic = Arithmetic(Grading((1,), 1), BITS, 0, DEGREE)
    return CentreExpansion(program, arithmetic, [arithmetic.constant(Fraction(0))] * 2, [])


def step_of(found: CentreExpansion) -> Fraction:
    """The step that is taken."""
    return found.shortened(dyadic_below(found.step_size))


def last_term(step: Fraction, weak: float) -> float:
    """The size of the Taylor term of order `DEGREE` of x after a step, in units of the format."""
    h = float(step)
    return (h**DEGREE / 3**DEGREE + weak * h**DEGREE) / DEGREE * 2.0**BITS


def test_a_singularity_that_the_first_terms_hide_shortens_the_step() -> None:
    plain, hidden = step_of(expansion(0.0)), step_of(expansion(1e-12))
    assert last_term(plain, 0.0) < 2**10
    assert last_term(plain, 1e-12) > 2**60
    assert hidden < plain
    assert last_term(hidden, 1e-12) < 2**10


def test_what_the_format_does_not_see_changes_no_step() -> None:
    found = expansion(2.0**-400)
    assert step_of(found) == dyadic_below(found.step_size) == step_of(expansion(0.0))


def test_more_steps_of_a_regularised_return_ask_for_more_bits() -> None:
    row = ROWS[SUN_JUPITER]
    bits = [first_precision(row, 30, steps) for steps in (0, 8, 12, 30)]
    assert bits[0] == bits[1] < bits[2] < bits[3]


def test_the_steps_of_a_half_return_are_counted_where_it_is_regularised() -> None:
    assert steps_of_centre(ROWS[EARTH_MOON], BITS) == 0
    assert 9 <= steps_of_centre(ROWS[SUN_JUPITER], BITS) <= 13


def test_a_centre_that_cannot_be_followed_counts_no_steps() -> None:
    row = ROWS[SUN_JUPITER]
    mass = row.parameters["mu"]
    assert steps_of_centre(replace(row, centre=(1 - mass, Fraction(0), Fraction(0))), BITS) == 0
    form = level_form(row)
    assert form is not None
    assert steps_of_centre(replace(form, centre=(Fraction(10**6), *form.centre[1:])), BITS) == 0


@pytest.mark.slow
@pytest.mark.parametrize("name", [EARTH_MOON, SUN_JUPITER])
def test_a_row_of_the_far_arc_is_proved_in_the_first_attempt(name: str) -> None:
    row: Candidate = ROWS[name]
    certificate = certify(row)
    assert certificate.verdict == "proved"
    assert certificate.computation.attempts == 1
    assert certificate.computation.coordinates == (PHYSICAL if name == EARTH_MOON else "Kustaanheimo-Stiefel")
