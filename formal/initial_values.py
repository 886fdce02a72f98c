"""An initial value problem as a file that Coq checks: a solution exists and ends in the balls that are written down.

Nothing here is trusted: `solutions/InitialValues.v` says what the file proves.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import ceil

from orbitproof.formal import writing as w
from orbitproof.formal.arithmetic import Element, Format, NotShownError, Poly, Program, psub
from orbitproof.formal.recording import recorded
from orbitproof.formal.steps import Step, check_step
from orbitproof.shared.systems import System

_SPARE_BITS = 100
_MOST_HALVINGS = 12
_SIGNS = {"add": "+", "sub": "-", "mul": "*"}
_TAKEN = frozenset(
    (
        "t",
        "R",
        "Rabs",
        "as",
        "at",
        "by",
        "do",
        "else",
        "end",
        "fix",
        "for",
        "fun",
        "if",
        "in",
        "is",
        "let",
        "then",
        "with",
    )
)

_HEAD = """\
From Coq Require Import List ZArith Reals Lra Lia.
From Coquelicot Require Import Coquelicot.
From Bignums Require Import BigZ.
From Orbitproof Require Import Polynomials Elements Formats Programs Steps Sound.
From Solutions Require Import Fields InitialValues.
Import ListNotations.
Local Open Scope bigZ_scope.
Local Open Scope list_scope.

"""


def _padd(p: Poly, q: Poly, sign: int) -> Poly:
    return psub(p, [-sign * c for c in q])


def _field(program: Program, given: Sequence[Poly], bits: int, length: int) -> list[Poly]:
    """About the field along polynomials, the first coefficients."""
    values = [list(p) for p in given]
    for node in program.nodes:
        at = [values[i] for i in node.places]
        match node.operation:
            case "const":
                found = [(node.value.numerator << bits) // node.value.denominator]
            case "add" | "sub":
                found = _padd(at[0], at[1], 1 if node.operation == "add" else -1)
            case "scale":
                found = [node.value.numerator * c // node.value.denominator for c in at[0]]
            case _:
                found = [0] * length
                for i, a in enumerate(at[0]):
                    for j, b in enumerate(at[1][: length - i]):
                        found[i + j] += a * b
                found = [c >> bits for c in found]
        values.append(found[:length])
    return [values[i] for i in program.outputs]


def taylor(
    program: Program, form: Format, start: Sequence[int], constants: Sequence[int], step: Fraction
) -> list[Poly]:
    """About the solution over one step, as polynomials in theta that begin at `start`."""
    found = [[c] for c in start]
    for n in range(form.kept - 1):
        field = _field(program, [*found, *([c] for c in constants)], form.bits, n + 1)
        for p, q in zip(found, field, strict=True):
            p.append(step.numerator * (q[n] if n < len(q) else 0) // (step.denominator * (n + 1)))
    return found


def _steps(
    program: Program, form: Format, start: Sequence[Fraction], constants: Sequence[Fraction], time: Fraction, count: int
) -> tuple[list[Step], list[Element]]:
    """So many equal steps, and the state at their end. Raises `NotShownError`."""
    state, parameters = [form.const(x) for x in start], [form.const(x) for x in constants]
    first = [p.known[0][0] if p.known[0] else 0 for p in parameters]
    steps = []
    for _ in range(count):
        begin = [x.known[0][0] if x.known[0] else 0 for x in state]
        solution = [[p] for p in taylor(program, form, begin, first, time / count)]
        steps.append(check_step(program, form, state, parameters, time / count, solution, []))
        state = steps[-1].at_end()
    return steps, state


def _formula(program: Program, names: Sequence[str]) -> list[str]:
    """The field in formulas of Coq."""
    texts = list(names)
    for node in program.nodes:
        at = [texts[i] for i in node.places]
        number = f"({node.value.numerator} / {node.value.denominator})"
        if node.value.denominator == 1:
            number = f"({node.value.numerator})" if node.value < 0 else str(node.value.numerator)
        match node.operation:
            case "const":
                texts.append(number)
            case "scale":
                texts.append(f"({number} * {at[0]})")
            case _:
                texts.append(f"({at[0]} {_SIGNS[node.operation]} {at[1]})")
    return [texts[i] for i in program.outputs]


def _number(x: Fraction) -> str:
    text = f"{x.numerator}" if x.denominator == 1 else f"{x.numerator} / {x.denominator}"
    return text if x.denominator == 1 and x >= 0 else f"({text})"


def _balls(state: Sequence[Element], digits: int) -> list[tuple[int, int]]:
    """Centres and radii over 10^digits."""
    found = []
    for x in state:
        centre = Fraction(sum(x.known[0]), 1 << x.form.bits)
        error = Fraction(sum(x.unknown), 1 << x.form.eps)
        nearest = round(centre * 10**digits)
        away = abs(centre - Fraction(nearest, 10**digits)) + error
        found.append((nearest, ceil(away * 10**digits)))
    return found


def coq_file(
    system: System,
    values: Mapping[str, Fraction | int],
    time: Fraction | int,
    *,
    bits: int = 128,
    degree: int = 24,
    digits: int = 15,
) -> str:
    """The text of a Coq file with the solution of an initial value problem, of a field of sums, products and numbers.

    Args:
        values: of all state coordinates at time 0 and of all parameters, exact.
        time: positive and dyadic, in the system's units.
        bits, degree: of the polynomials in time.
        digits: after the decimal point, of the balls in which the solution ends.

    Raises `ValueError` for another field or time, and where no bound was found.
    """
    program, time = recorded(system.program), Fraction(time)
    if program.number_of_powers or time <= 0 or time.denominator & (time.denominator - 1):
        raise ValueError("the field has powers, or the time is not positive and dyadic")
    start = [Fraction(values[name]) for name in system.state]
    constants = [Fraction(values[name]) for name in system.parameters]
    form = Format((), 0, bits, 0, degree + 1, bits + _SPARE_BITS)
    for halvings in range(_MOST_HALVINGS):
        try:
            steps, end = _steps(program, form, start, constants, time, 1 << halvings)
        except NotShownError:
            continue
        balls = _balls(end, digits)
        if all(radius <= 1 for _, radius in balls):
            break
    else:
        raise ValueError("no bound was found; more bits, a higher degree or fewer digits may help")
    return _text(system, program, form, (start, constants, time), steps, balls, digits)


def _text(
    system: System,
    program: Program,
    form: Format,
    problem: tuple[Sequence[Fraction], Sequence[Fraction], Fraction],
    steps: Sequence[Step],
    balls: Sequence[tuple[int, int]],
    digits: int,
) -> str:
    start, constants, time = problem
    ratios = [
        "[" + "; ".join(f"({w.z(x.numerator)}, {w.z(x.denominator)})" for x in xs) + "]" for xs in (constants, start)
    ]
    pairs = "[" + "; ".join(f"({w.z(c)}, {w.z(r)})" for c, r in balls) + "]"
    names = [f"{name}_" if name in _TAKEN else name for name in system.state]
    inputs = [*(f"{name} t" for name in names), *map(_number, constants)]
    formulas = _formula(program, inputs)
    end = _number(time)
    begins = " /\\ ".join(f"{name} 0 = {_number(x)}" for name, x in zip(names, start, strict=True))
    slopes = " /\\\n    ".join(
        f"is_derive {name} t {text if text[0] == '(' else f'({text})'}"
        for name, text in zip(names, formulas, strict=True)
    )
    ends = " /\\\n  ".join(
        f"Rabs ({name} {end} - {_number_over(c, digits)}) <= {_number_over(r, digits)}"
        for name, (c, r) in zip(names, balls, strict=True)
    )
    data = "[" + ";\n   ".join(map(w.step, steps)) + "]"
    size = len(names)
    parts = "refine " + "(conj _ " * (size - 1) + "_" + ")" * (size - 1) + "."
    return (
        _HEAD
        + f"Definition the_problem : problem := Problem\n  ({w.program(program)})\n  {ratios[0]} {ratios[1]} "
        + f"({w.z(time.numerator)}, {w.z(time.denominator)})\n  ({pairs}, {w.z(10**digits)})\n"
        + f"  ({w.form(form)})\n  {data}.\n\n"
        + "Lemma checked : solved the_problem = true.\nProof. vm_cast_no_check (eq_refl true). Qed.\n\n"
        + "Local Open Scope R_scope.\n\n"
        + f"Theorem solution : exists {' '.join(names)} : R -> R,\n  ({begins}) /\\\n"
        + f"  (forall t, 0 <= t <= {end} ->\n    {slopes}) /\\\n  {ends}.\nProof.\n"
        + "  destruct (solved_sound the_problem checked) as [y [Y0 [Y [B _]]]].\n"
        + f"  assert (L : length (the_start the_problem) = {size}%nat) by reflexivity. rewrite L in Y0, Y, B.\n"
        + f"  assert (T : real_of (the_time the_problem) = {end}) by same_number. rewrite T in Y, B.\n"
        + f"  exists {', '.join(f'(y {i}%nat)' for i in range(size))}.\n"
        + "  split; [|split].\n  - "
        + "repeat split; rewrite Y0 by lia; same_number.\n"
        + f"  - intros t Ht. {parts}\n"
        + "".join(f"    + derivative (Y {i}%nat t ltac:(lia) Ht).\n" for i in range(size))
        + f"  - {parts}\n"
        + "".join(
            f"    + pose proof (B {i}%nat ltac:(lia)) as E. revert E. in_formulas. intros E. exact E.\n"
            for i in range(size)
        )
        + "Qed.\n\nPrint Assumptions solution.\n"
    )


def _number_over(x: int, digits: int) -> str:
    return f"({x} / {10**digits})"
