"""Steps and numbers from which Coq proves that orbits of k times the period branch off in the Falkner-Skan equation.

Nothing here is trusted: the theorems stand in `solutions/FalknerSkan.v`, and what does not prove them is refused.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor

from orbitproof.formal import writing as w
from orbitproof.formal.arithmetic import Element, Format, Poly, Program, down, l1, up
from orbitproof.formal.initial_values import taylor
from orbitproof.formal.recording import recorded
from orbitproof.formal.steps import Step, check_step
from orbitproof.shared import define_system

_BETWEEN = 12
_PRECISION = 120

# x, y, z; their derivatives by the beginning, by the parameter; second ones by the beginning, by both; the third one.
FIELD = {
    "x": "y", "y": "z", "z": "b*(y*y-1)-x*z",
    "x1": "y1", "y1": "z1", "z1": "2*b*y*y1-x1*z-x*z1",
    "x2": "y2", "y2": "z2", "z2": "y*y-1+2*b*y*y2-x2*z-x*z2",
    "x3": "y3", "y3": "z3", "z3": "2*b*(y1*y1+y*y3)-x3*z-2*x1*z1-x*z3",
    "x4": "y4", "y4": "z4", "z4": "2*y*y1+2*b*(y2*y1+y*y4)-x4*z-x1*z2-x2*z1-x*z4",
    "x5": "y5", "y5": "z5", "z5": "2*b*(3*y1*y3+y*y5)-x5*z-3*x3*z1-3*x1*z3-x*z5",
}  # fmt: skip


@dataclass(frozen=True)
class Tupling:
    """A point where orbits of `len(signs)` times the period branch off.

    Attributes:
        parameter, beginning: about the point.
        near: how far from these the theorem goes; solutions are followed in a box of twice the size.
        half: about half the period there.
        clock: times of returns are between j n and j (n + 1) over 2^clock.
        fine: times of returns from the centre are known up to 3 / 2^fine.
        form: of the steps.
        signs: so that x at a return rises with the beginning, and at the last return its derivative with the parameter.
        side: 1 if the parameter rises along the second curve, or up to a maximum; -1 if it falls.
        slopes: bounds of the slopes of the two curves.
        name: of the theorem.
    """

    parameter: Fraction
    beginning: Fraction
    near: tuple[Fraction, Fraction]
    half: Fraction
    clock: int
    fine: int
    form: Format
    signs: tuple[int, ...]
    side: int
    slopes: tuple[Fraction, Fraction]
    name: str

    @property
    def radii(self) -> tuple[Fraction, Fraction]:
        """Of the box in which solutions are followed."""
        return 2 * self.near[0], 2 * self.near[1]


TUPLINGS = {
    2: Tupling(
        Fraction(34018753498914353231, 10**17),
        Fraction(939792756949623004649, 10**21),
        (Fraction(1, 10**9), Fraction(1, 10**13)),
        Fraction(230262140455007259939502902726, 10**30),
        12,
        50,
        Format((), 0, 128, 0, 31, 188),
        (1, 1),
        1,
        (Fraction(4, 10**6), Fraction(300)),
        "period_doubling",
    ),
    3: Tupling(
        Fraction(45344258682138482263, 10**17),
        Fraction(939848585715971576541, 10**21),
        (Fraction(1, 10**9), Fraction(1, 10**13)),
        Fraction(19941830166249483, 10**17),
        14,
        50,
        Format((), 0, 128, 0, 31, 188),
        (1, 1, 1),
        1,
        (Fraction(4, 10**6), Fraction(8000)),
        "period_tripling",
    ),
    4: Tupling(
        Fraction(67995415507296894513, 10**17),
        Fraction(939904499164097608213, 10**21),
        (Fraction(1, 10**11), Fraction(1, 10**15)),
        Fraction(162828662021492706387831223553, 10**30),
        14,
        60,
        Format((), 0, 160, 0, 41, 220),
        (1, 1, 1, 1),
        -1,
        (Fraction(4, 10**6), Fraction(600)),
        "period_quadrupling",
    ),
}


def _program() -> Program:
    system = {"name": "variations", "state": " ".join(FIELD), "parameters": "b", "field": FIELD}
    return recorded(define_system(system).program)


def _wide(form: Format, centre: Fraction, radius: Fraction) -> Element:
    """As `wide` of `solutions/Boxes.v`."""
    x = form.const(centre)
    return Element(form, x.known, [x.unknown[0] + ceil(radius * (1 << form.eps)), *x.unknown[1:]])


def steps_to(about: Tupling, times: Sequence[Fraction], radii: tuple[Fraction, Fraction]) -> list[Step]:
    """Steps that begin in a box and have these times among their ends.

    Args:
        times: rising, dyadic; before and after each return.
        radii: of the parameter and of the beginning.
    """
    program, form = _program(), about.form
    constants = [_wide(form, about.parameter, radii[0])]
    state = [form.const(Fraction(int(name == "y1"))) for name in FIELD]
    state[1] = _wide(form, about.beginning, radii[1])
    found: list[Step] = []
    now = Fraction(0)
    for place, end in enumerate(times):
        for left in range(1 if place % 2 or place == 2 * len(about.signs) else _BETWEEN, 0, -1):
            length = end - now if left == 1 else Fraction(round((end - now) / left * 4096), 4096)
            begin = [x.known[0][0] if x.known[0] else 0 for x in state]
            solution = [[p] for p in taylor(program, form, begin, [c.known[0][0] for c in constants], length)]
            found.append(check_step(program, form, state, constants, length, solution, []))
            state, now = found[-1].at_end(), now + length
    return found


def _reach(form: Format, p: Poly, error: int) -> str:
    """An interval over 2^_PRECISION, around `reach` of `solutions/Boxes.v`."""
    to_eps, less = form.bits - form.eps, form.eps - _PRECISION
    low, high = (p[0] - l1(p[1:]), p[0] + l1(p[1:])) if p else (0, 0)
    return f"({w.z(down(down(low, to_eps) - error, less))}, {w.z(up(up(high, to_eps) + error, less))})"


def _passage(steps: Sequence[Step], number: int) -> tuple[str, str, str]:
    """All coordinates on the step of a return, and z before and after it."""
    place = (_BETWEEN + 1) * number + _BETWEEN
    on = steps[place]
    form = on.form
    everything = ";\n     ".join(_reach(form, x[0], sum(e)) for x, e in zip(on.solution, on.errors, strict=True))
    before, after = (steps[n].at_end()[2] for n in (place - 1, place))
    return (
        f"[{everything}]",
        _reach(form, before.known[0], sum(before.unknown)),
        _reach(form, after.known[0], sum(after.unknown)),
    )


def _ratio(x: Fraction) -> str:
    return f"({w.z(x.numerator)}, {w.z(x.denominator)})"


def coq_file(k: int = 2) -> str:
    """The text of a file whose last theorem is the bifurcation, for k = 2, 3 or 4."""
    about = TUPLINGS[k]
    first, unit = floor(about.half * 2**about.clock), 2**about.clock
    last = k * (first + 1) + 1
    wide = [Fraction(j * (first + n), unit) for j in range(1, k + 1) for n in (0, 1)]
    fine = [floor(j * about.half * 2**about.fine) - 1 for j in range(1, k + 1)]
    around = steps_to(about, [*wide, Fraction(last, unit)], about.radii)
    centre = steps_to(about, [Fraction(t + n, 2**about.fine) for t in fine for n in (0, 3)], (Fraction(0), Fraction(0)))
    passages = []
    for j in range(k):
        ends, before, after = _passage(around, j)
        fine_ends, fine_before, fine_after = _passage(centre, j)
        passages.append(
            f"Passage {about.signs[j]}%Z\n    {ends}\n    {before} {after}\n    {w.z(fine[j])}\n    {fine_ends}\n"
            f"    {fine_before} {fine_after}"
        )
    proofs = ("around_checked", "centre_checked", "numbers_checked")
    ratios = " ".join(map(_ratio, (about.parameter, about.beginning, *about.radii, *about.near, *about.slopes)))
    return (
        "From Coq Require Import List ZArith Reals.\nFrom Bignums Require Import BigZ.\n"
        "From Orbitproof Require Import Polynomials Elements Formats Programs Steps.\n"
        "From Solutions Require Import Statements FalknerSkan.\n"
        "Import ListNotations.\nLocal Open Scope bigZ_scope.\nLocal Open Scope list_scope.\n\n"
        + f"Definition the_case : case := Case {k}%nat {ratios}\n  ({about.side})%Z "
        + f"{' '.join(map(w.z, (about.clock, first, last, about.fine, _PRECISION)))} ({w.form(about.form)})\n  ["
        + ";\n   ".join(passages)
        + "].\n\n"
        + "".join(
            f"Definition {name} : list step :=\n  [" + ";\n   ".join(map(w.step, steps)) + "].\n\n"
            for name, steps in (("around", around), ("centre", centre))
        )
        + "".join(
            f"Lemma {name} : {claim} = true.\nProof. vm_cast_no_check (eq_refl true). Qed.\n"
            for name, claim in (
                (proofs[0], "good_around the_case around"),
                (proofs[1], "good_centre the_case centre"),
                (proofs[2], "good_numbers the_case"),
            )
        )
        + f"\nTheorem solution : {about.name}.\n"
        + f"Proof. exact ({about.name}_proved the_case eq_refl around centre {' '.join(proofs)}). Qed.\n"
    )
