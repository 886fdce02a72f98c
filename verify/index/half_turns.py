"""How often the Lagrangian planes of a half orbit turn, and the index of the orbit (sections 35.2 and 35.3)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import acb, arb

from orbitproof.verify.evidence import IntegrationFailure, excludes_zero, is_positive

Vectors = tuple[tuple[acb, ...], ...]
"""Complex vectors, the coordinates of each in a row."""


@dataclass(frozen=True)
class HalfTurns:
    """Whole half turns of two Lagrangian planes along a half orbit, and what the index is by them (Lemma 35.3).

    Attributes:
        fixed, negated: m_+ and m_-, those of the plane that R fixes at first, and of the one that it negates.
        planes: n, the dimension of the planes.
        angles: sums of the angles of both, in half turns.
    """

    fixed: int
    negated: int
    planes: int
    angles: tuple[arb, arb]

    @property
    def index(self) -> int:
        """The Conley-Zehnder index."""
        return self.fixed + self.negated + self.planes

    @property
    def are_known(self) -> bool:
        """Whether both angles lie certainly between their whole half turns and n more (Lemma 35.3)."""
        numbers = (self.fixed, self.negated)
        return all(follow_from(number, self.planes, angle) for number, angle in zip(numbers, self.angles, strict=True))


def determinant(rows: Vectors) -> acb:
    """The determinant of a square matrix of at most three rows."""
    if not rows:
        return acb(1)
    result = acb(0)
    for column, entry in enumerate(rows[0]):
        minor = determinant(tuple((*row[:column], *row[column + 1 :]) for row in rows[1:]))
        result = result + (-entry if column % 2 else entry) * minor
    return result


class Turning:
    """The argument of a function along an orbit that is followed cell by cell."""

    def __init__(self, start: acb) -> None:
        self.angle = arb(0)
        self.at = start

    def reaches(self, over: Sequence[acb], end: acb) -> bool:
        """Whether the argument is followed to a new value, by values all over the way.

        All of them lie in one half plane without 0 in its boundary, so the argument changes by less than pi (35.2).
        """
        towards = acb(end.real.mid(), end.imag.mid()).conjugate()
        return all(is_positive((value * towards).real) for value in (*over, self.at, end))

    def go_on(self, end: acb) -> None:
        """To a value that is reached."""
        towards = acb(end.real.mid(), end.imag.mid()).conjugate()
        self.angle = self.angle + _argument(end * towards) - _argument(self.at * towards)
        self.at = end


def _argument(value: acb) -> arb:
    """The argument in (-pi/2, pi/2) of numbers with positive real parts."""
    return (value.imag / value.real).atan()


def half_turns(angle: arb, end: acb, across: arb, planes: int) -> tuple[int, arb]:
    """The number m of whole half turns in a sum of n angles, and that sum in half turns (section 35.3).

    Args:
        angle: by which the argument of det(A + i C) has changed.
        end: i^-n det(A + i C) at the end, up to a real factor.
        across: det C up to the same factor.

    Raises `IntegrationFailure` if the number is not known.
    """
    if excludes_zero(across) and excludes_zero_of(end):
        rest = planes * arb.pi() / 2 + (end / across).arg()
        number = ((angle - rest) / arb.pi()).unique_fmpz()
        if number is not None:
            # The same angle, better known: by the end of the path alone.
            return int(number), number + rest / arb.pi()
    raise IntegrationFailure(
        "half turns",
        "it is not known between which half turns the orbit ends",
        "take another orbit, or more precision",
        needs_precision=True,
    )


def excludes_zero_of(value: acb) -> bool:
    """Whether a complex number is certainly not 0."""
    return excludes_zero(value.real) or excludes_zero(value.imag)


def follow_from(number: int, planes: int, angle: arb) -> bool:
    """Whether so many whole half turns certainly follow from a sum of n angles in half turns (section 35.3)."""
    return is_positive(angle - number) and is_positive(number + planes - angle)


def real_parts(rows: Vectors) -> Vectors:
    """Vectors with the imaginary parts left out."""
    return tuple(tuple(acb(entry.real) for entry in row) for row in rows)


def imaginary_parts(rows: Vectors) -> Vectors:
    """The imaginary parts as real numbers."""
    return tuple(tuple(acb(entry.imag) for entry in row) for row in rows)


def index_of(angles: Sequence[arb], flow: Vectors, fixed: Vectors, negated: Vectors) -> HalfTurns:
    """The half turns from the angles and from the vectors at the end, where Fix(R) is R^N and R negates i R^N.

    Args:
        angles: of the two determinants.
        flow: the field divided by i; nothing for variations across the plane, to which it does not belong.
        fixed, negated: the vectors that began in Fix(R) and in what R negates.
    """
    planes, unit = len(fixed), acb(0, 1)
    along = real_parts(flow)
    first, around_first = half_turns(
        angles[0],
        determinant((*flow, *fixed)) / unit**planes,
        determinant((*along, *imaginary_parts(fixed))).real,
        planes,
    )
    second, around_second = half_turns(
        angles[1], determinant((*flow, *negated)), determinant((*along, *real_parts(negated))).real, planes
    )
    return HalfTurns(first, second, planes, (around_first, around_second))
