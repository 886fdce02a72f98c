"""The checks of `theory/Crossings.v` once more: parts of steps on which a sign is shown, and what they count."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from orbitproof.formal.arithmetic import Element, Format, Node, NotShownError, Program, down, l1, recentred, up

FINEST = 14


@dataclass(frozen=True)
class Part:
    """As `part` of `theory/Crossings.v`: from place / 2^depth to (place + 1) / 2^depth."""

    is_side: bool
    sign: int
    place: int
    depth: int


def sign_on(x: Element, place: int, depth: int) -> int:
    """1 or -1 if an element of which only the centre is known has that sign on a part, else 0."""
    form = x.form
    q, moved = recentred(2 * place + 1, depth + 1, x.known[0])
    scale = form.bits + moved
    away = form.bound(l1(q[1:]), scale) + sum(x.unknown)
    for sign in (1, -1):
        if away < down(sign * (q[0] if q else 0), scale - form.eps):
            return sign
    return 0


@dataclass(frozen=True)
class Counter:
    """As `counter` of `theory/Crossings.v`."""

    crossings: int = 0
    side: int = 0
    velocity: int = 0
    clear: int | None = None
    previous: int | None = None
    fresh: bool = True

    def after(self, part: Part, until: int) -> Counter:
        """With one more part. Raises `NotShownError`."""
        sign = part.sign
        if not part.is_side:
            if self.velocity not in (0, sign):
                raise NotShownError("the velocity changes its sign next to the section")
            side = sign if self.fresh else self.side
            return replace(self, side=side, velocity=sign, fresh=False)
        if self.fresh:
            raise NotShownError("the orbit does not start on the section")
        if self.side == sign:
            return replace(self, velocity=0, clear=until)
        if self.velocity != sign:
            raise NotShownError("a crossing against the velocity")
        return Counter(self.crossings + 1, sign, 0, until, self.clear, False)

    def arrival(self, number: int) -> tuple[int, bool]:
        """After which time crossing `number` is the only one; whether it has to lie behind."""
        if self.crossings + 1 == number and self.velocity in (0, -self.side) and self.clear is not None:
            return self.clear, False
        if self.crossings == number and self.velocity in (0, self.side) and self.previous is not None:
            return self.previous, self.velocity == 0
        raise NotShownError(f"it is not crossing {number}")


def cover(
    y: Element, dy: Element, clock_bits: int, clock: int, length: Fraction, counter: Counter
) -> tuple[list[Part], Counter]:
    """Parts that cover a step, and what is counted then. Raises `NotShownError`."""
    num, den = length.numerator, length.denominator.bit_length() - 1
    parts: list[Part] = []

    def halves(place: int, depth: int) -> None:
        nonlocal counter
        for is_side, x in ((True, y), (False, dy)):
            if sign := sign_on(x, place, depth):
                part = Part(is_side, sign, place, depth)
                parts.append(part)
                counter = counter.after(part, clock + (num * (place + 1) << clock_bits - den - depth))
                return
        if depth == FINEST:
            raise NotShownError("the orbit may touch the section")
        halves(2 * place, depth + 1)
        halves(2 * place + 1, depth + 1)

    halves(0, 0)
    return parts, counter


def section_field(field: Program, size: int, section: int) -> Program:
    """The field with the section coordinate as time, as `section_field` of `theory/Crossings.v` makes it."""
    k = field.inputs

    def moved(i: int) -> int:
        return i if i < size else i + 1 if i < k else i + 2

    outs = [moved(i) for i in field.outputs]
    before = [replace(node, places=tuple(map(moved, node.places))) for node in field.nodes]
    distance, n = k + 1, k + 2 + len(before)
    more = [
        Node("power", (outs[section],), Fraction(-1)),
        Node("mul", (distance, n)),
        Node("scale", (n + 1,), Fraction(-1)),
        Node("scale", (distance,), Fraction(-1)),
    ]
    products = [Node("mul", (n + 2, o)) for o in outs]
    outputs = [n + 3 if i == section else n + 4 + i for i in range(size)]
    return Program(k + 2, (*before, *more, *products), (*outputs, n + 2))


def range_of(x: Element) -> tuple[int, int]:
    """Ends of an interval of scale eps that contains the values of an element without theta."""
    form = x.form
    c = sum(x.known[0])
    away = sum(form.bound(l1(p), form.scale(g)) for g, p in list(zip(form.grades, x.known, strict=True))[1:])
    r = away + sum(x.unknown)
    return down(c, form.bits - form.eps) - r, up(c, form.bits - form.eps) + r


def onto_section(state: Sequence[Element], form: Format) -> list[Element]:
    """The state from which the section is reached, with the elapsed time, in another format."""
    moved = [Element(form, x.known, x.unknown) for x in state]
    return [*moved, form.const(Fraction(0))]
