"""The steps from which Coq proves that orbits of twice the period branch off in the Falkner-Skan equation.

Nothing here is trusted: the theorem stands in `solutions/FalknerSkan.v`, and steps that do not prove it are refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import ceil, floor

from orbitproof.formal import writing as w
from orbitproof.formal.arithmetic import Element, Format, Program
from orbitproof.formal.initial_values import taylor
from orbitproof.formal.recording import recorded
from orbitproof.formal.steps import Step, check_step
from orbitproof.shared import define_system

PARAMETER = Fraction(34018753498914353231, 10**17)
BEGINNING = Fraction(939792756949623004649, 10**21)
RADII = (Fraction(2, 10**9), Fraction(2, 10**13))
FORM = Format((), 0, 128, 0, 31, 188)
# About the time of half an orbit, and where it is looked for.
_HALF = Fraction(230262140455007259939502902726, 10**30)
_WINDOWS = tuple(Fraction(n, 4096) for n in (943, 944, 1886, 1888, 1889))
_FINE = 2**50
_BETWEEN = 12

# x, y, z; their derivatives by the beginning, by the parameter; second ones by the beginning, by both; the third one.
FIELD = {
    "x": "y", "y": "z", "z": "b*(y*y-1)-x*z",
    "x1": "y1", "y1": "z1", "z1": "2*b*y*y1-x1*z-x*z1",
    "x2": "y2", "y2": "z2", "z2": "y*y-1+2*b*y*y2-x2*z-x*z2",
    "x3": "y3", "y3": "z3", "z3": "2*b*(y1*y1+y*y3)-x3*z-2*x1*z1-x*z3",
    "x4": "y4", "y4": "z4", "z4": "2*y*y1+2*b*(y2*y1+y*y4)-x4*z-x1*z2-x2*z1-x*z4",
    "x5": "y5", "y5": "z5", "z5": "2*b*(3*y1*y3+y*y5)-x5*z-3*x3*z1-3*x1*z3-x*z5",
}  # fmt: skip


def _program() -> Program:
    system = {"name": "variations", "state": " ".join(FIELD), "parameters": "b", "field": FIELD}
    return recorded(define_system(system).program)


def _wide(centre: Fraction, radius: Fraction) -> Element:
    """As `wide` of `solutions/Boxes.v`."""
    x = FORM.const(centre)
    return Element(FORM, x.known, [x.unknown[0] + ceil(radius * (1 << FORM.eps)), *x.unknown[1:]])


def steps_to(times: Sequence[Fraction], radii: tuple[Fraction, Fraction]) -> list[Step]:
    """Steps that begin in a box and have these times among their ends: before and after both returns.

    Args:
        times: rising, dyadic.
        radii: of the parameter and of the beginning.
    """
    program = _program()
    constants = [_wide(PARAMETER, radii[0])]
    state = [FORM.const(Fraction(int(name == "y1"))) for name in FIELD]
    state[1] = _wide(BEGINNING, radii[1])
    found: list[Step] = []
    now = Fraction(0)
    for end, count in zip(times, (_BETWEEN, 1, _BETWEEN, 1, 1), strict=False):
        for left in range(count, 0, -1):
            length = end - now if left == 1 else Fraction(round((end - now) / left * 4096), 4096)
            begin = [x.known[0][0] if x.known[0] else 0 for x in state]
            solution = [[p] for p in taylor(program, FORM, begin, [c.known[0][0] for c in constants], length)]
            found.append(check_step(program, FORM, state, constants, length, solution, []))
            state, now = found[-1].at_end(), now + length
    return found


def coq_file() -> str:
    """The text of a file whose last theorem is the bifurcation."""
    fine = [Fraction(floor(n * _HALF * _FINE) - 1, _FINE) for n in (1, 2)]
    ends = [t + Fraction(3, _FINE) for t in fine]
    around = steps_to(_WINDOWS, RADII)
    centre = steps_to([fine[0], ends[0], fine[1], ends[1]], (Fraction(0), Fraction(0)))
    return (
        "From Coq Require Import List ZArith Reals.\nFrom Bignums Require Import BigZ.\n"
        "From Orbitproof Require Import Polynomials Elements Formats Programs Steps.\n"
        "From Solutions Require Import FalknerSkan.\n"
        "Import ListNotations.\nLocal Open Scope bigZ_scope.\nLocal Open Scope list_scope.\n\n"
        + "".join(
            f"Definition {name} : list step :=\n  [" + ";\n   ".join(map(w.step, steps)) + "].\n\n"
            for name, steps in (("around", around), ("centre", centre))
        )
        + "Lemma around_checked : good_around around = true.\nProof. vm_cast_no_check (eq_refl true). Qed.\n"
        + "Lemma centre_checked : good_centre centre = true.\nProof. vm_cast_no_check (eq_refl true). Qed.\n\n"
        + "Theorem solution : period_doubling.\n"
        + "Proof. exact (doubling around centre around_checked centre_checked). Qed.\n"
    )
