"""Onto the section: a few steps of `verify.flow.step` with the section coordinate as time (section 5.1)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from math import ceil, log2

from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series
from orbitproof.verify.evidence import IntegrationFailure
from orbitproof.verify.flow import advance, dyadic_below
from orbitproof.verify.poincare.oracle import Oracle

_MOST_STEPS = 16
_SPARE_DEGREES = 2


def onto_section(
    program: PreparedProgram,
    section: int,
    arithmetic: Arithmetic,
    state: Sequence[Series],
    parameters: Sequence[Series],
    oracle: Oracle,
) -> tuple[list[Series], Series]:
    """The state where the orbit meets the section, and the time that this takes (of either sign).

    Arguments:
        program: from `section_field.build_section_program`, with the same `section`.

    Raises `IntegrationFailure` if the velocity across the section is not bounded away from zero.
    """
    wide = arithmetic.width > 0

    def begun(degree: int) -> tuple[Arithmetic, list[Series], list[Series]]:
        inner = replace(arithmetic, degree=degree, grade_loss=0)
        current = [*(Series(inner, x.coefs, x.errors) for x in state), inner.constant(Fraction(0))]
        return inner, current, [*(Series(inner, p.coefs, p.errors) for p in parameters), current[section]]

    # Next to the section one step of low degree is enough; with a wide variable y_0 is not small.
    inner, current, constants = begun(arithmetic.degree if wide else 2 * arithmetic.grading.top + 4)
    if wide:
        size = oracle.expand(program, inner, current, constants).step_size
        inner, current, constants = begun(_degree(inner, size))
    way, share = Fraction(0), 1.0
    for _ in range(_MOST_STEPS):
        expansion = oracle.expand(program, inner, current, constants)
        step = min(dyadic_below(share * expansion.step_size), 1 - way)
        try:
            current = list(advance(program, current, constants, expansion, step).end)
        except IntegrationFailure:
            if not wide:
                raise
            share /= 2
            continue
        way += step
        if way == 1:
            return [Series(arithmetic, x.coefs, x.errors) for x in current[:-1]], current[-1]
    raise IntegrationFailure(
        "section",
        f"the orbits were not brought onto the section in {_MOST_STEPS} steps",
        "the times of their returns differ too much: give a narrower piece",
    )


def _degree(arithmetic: Arithmetic, size: float) -> int:
    """The degree that suits a step of length 1, where that of the arithmetic suits one of length `size`."""
    if not size > 1:
        return arithmetic.degree
    decay = arithmetic.bits / arithmetic.degree + log2(size)
    return min(arithmetic.degree, ceil(arithmetic.bits / decay) + _SPARE_DEGREES)
