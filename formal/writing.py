"""Coq text of data: numbers, polynomials, elements, steps."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from orbitproof.formal.arithmetic import Element, Format, Node, Norm, Poly, Program
from orbitproof.formal.crossings import Counter, Part
from orbitproof.formal.rows import Affine
from orbitproof.formal.steps import Step


def z(x: int) -> str:
    """An integer."""
    text = str(abs(x)) if abs(x) < 10 else hex(abs(x))
    return text if x >= 0 else f"(-{text})"


def listed(parts: Sequence[str], nat: bool = False) -> str:
    """A list."""
    return "[" + "; ".join(parts) + "]" + ("%nat" if nat else "")


def poly(p: Poly) -> str:
    """A polynomial, without zeros at its end."""
    length = len(p)
    while length and not p[length - 1]:
        length -= 1
    return listed([z(c) for c in p[:length]])


def polys(ps: Sequence[Poly]) -> str:
    """One polynomial a line."""
    return "[" + ";\n   ".join(map(poly, ps)) + "]"


def norm(e: Norm) -> str:
    """A vector of bounds."""
    return listed([z(x) for x in e])


def norms(es: Sequence[Norm]) -> str:
    """One vector a line."""
    return "[" + ";\n   ".join(map(norm, es)) + "]"


def node(n: Node) -> str:
    """One operation."""
    places = " ".join(map(str, n.places))
    match n.operation:
        case "const":
            return f"Const {z(n.value.numerator)} {z(n.value.denominator)}"
        case "scale":
            return f"Scale {places} {z(n.value.numerator)} {z(n.value.denominator)}"
        case "power":
            return f"Power {places} {-n.value.numerator} {n.value.denominator}"
        case _:
            return f"{n.operation.capitalize()} {places}"


def program(p: Program) -> str:
    """A straight-line program."""
    nodes = ";\n   ".join(map(node, p.nodes))
    return f"Program {p.inputs}\n  [{nodes}]\n  {listed([str(i) for i in p.outputs], nat=True)}"


def form(f: Format) -> str:
    """A format."""
    weights = listed([str(w) for w in f.weights], nat=True)
    return f"format_of {weights} {f.top} {z(f.bits)} {z(f.grade_bits)} {f.kept - 1} {z(f.eps)}"


def step(s: Step) -> str:
    """A step."""
    solution = "[" + ";\n  ".join(map(polys, s.solution)) + "]"
    powers = "[" + ";\n  ".join(map(polys, s.powers)) + "]"
    return f"Step {z(s.length.numerator)} {z(s.den)}\n  {solution}\n  {powers}\n  {norms(s.tube)} {s.terms}"


def rational(x: Fraction) -> str:
    """A rational number."""
    return f"(Q {z(x.numerator)} {z(x.denominator)})"


def rationals(xs: Sequence[Fraction]) -> str:
    """A list of these."""
    return listed([rational(x) for x in xs])


def affine(a: Affine | None) -> str:
    """Where an input begins."""
    return "OfLevel" if a is None else f"Affine {rational(a.centre)} {rationals(a.row)}"


def guesses(gs: Sequence[Sequence[Poly]]) -> str:
    """About the powers of a program."""
    return "[" + ";\n   ".join(map(polys, gs)) + "]"


def state(name: str, elements: Sequence[Element]) -> str:
    """A state, by its known parts and bounds."""
    known = "[" + ";\n  ".join(polys(x.known) for x in elements) + "]"
    return f"{name}\n  {known}\n  {norms([x.unknown for x in elements])}"


def counter(c: Counter) -> str:
    """What was counted."""

    def maybe(x: int | None) -> str:
        return "None" if x is None else f"(Some {z(x)})"

    fresh = "true" if c.fresh else "false"
    return f"(Counter {c.crossings} {z(c.side)} {z(c.velocity)} {maybe(c.clear)} {maybe(c.previous)} {fresh})"


def part(p: Part) -> str:
    """A part of a step."""
    return f"Part {'true' if p.is_side else 'false'} {z(p.sign)} {z(p.place)} {z(p.depth)}"
