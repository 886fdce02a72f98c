"""A periodic orbit without symmetry once more: the flow over the period has a fixed point. README, section 9."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from flint import acb, arb

from .conditions import Hypothesis
from .jets import CannotFollow, precision
from .legs import Legs, Start
from .multipliers import linear, multipliers
from .newton import KNOWN, checked
from .periodic_statement import read_periodic
from .proof import NotProved

Result = TypeVar("Result")
ROUGH = 160, 320
"""Bits of the first integration, tried one after the other."""
ERRORS = (ArithmeticError, ValueError, TypeError, MemoryError)


@dataclass(frozen=True)
class ProvedPeriodic:
    """The periodic orbit is proved.

    Attributes:
        point: enclosures of the state at its point on the section, by name; `level`: of the first integral there.
        period: its least period.
        multipliers: those that are not 1 for every orbit of its kind, each in a ball of its own.
        inside, on, outside: how many of them are shown to be where.
        hypotheses: every inequality with its enclosures.
        width, bits, steps: as of `Proved`; the box has the radius 2^-width.
    """

    point: dict[str, arb]
    level: arb | None
    period: arb
    multipliers: tuple[acb, ...]
    inside: int
    on: int
    outside: int
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


class PeriodicProof(Legs):
    """One attempt."""

    def conclusion(self) -> ProvedPeriodic:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        statement = self.statement
        newton, zero, found, _ = self.enclosed()
        point, period = dict(zip(statement.names, zero, strict=False)), zero[self.time]
        checks, level = self.check_orbit(found, zero)
        hypotheses = checked([newton, *checks])
        balls = multipliers(self.monodromy(found), [linear(1)] * (1 if level is None else 2))
        pair = len(balls) == 2 and statement.keeps_volume() and not any(z.imag.contains(0) for z in balls)
        counts = sum(abs(z) < 1 for z in balls), 0, sum(abs(z) > 1 for z in balls)
        return ProvedPeriodic(
            point, level, period, tuple(balls), *((0, 2, 0) if pair else counts), hypotheses,
            self.width, self.bits, self.steps,
        )  # fmt: skip


def prove_periodic(certificate: Mapping[str, Any]) -> ProvedPeriodic | NotProved:
    """Prove the orbit that a certificate claims, from its statement and the centre of its box alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    statement = read_periodic(certificate)
    return attempted(
        statement,
        lambda bits: PeriodicProof(statement, bits).guess(),
        2,
        lambda bits, start: PeriodicProof(statement, bits, start).conclusion(),
    )


class Checkable(Protocol):
    """A statement."""

    def check(self) -> None:
        """Raises `CannotFollow` for one that no theorem is about."""


def attempted(
    statement: Checkable,
    guess: Callable[[int], Start],
    order: int,
    prove: Callable[[int, Start], Result],
) -> Result | NotProved:
    """The proof with derivatives to order - 1, from a guess of the orbit in legs. README, section 9.4."""
    reasons = []
    try:
        statement.check()
        for bits in ROUGH:
            with precision(bits):
                try:
                    start = guess(bits)
                except (CannotFollow, *ERRORS) as error:
                    reasons.append(f"{type(error).__name__}: {error} ({bits} bits)")
                    continue
            # A box of the width that is lost in a leg, and what is to be known of derivatives on it.
            fine = order * start.lost + KNOWN
            with precision(fine):
                return prove(fine, start)
    except (CannotFollow, *ERRORS) as error:
        reasons.append(f"{type(error).__name__}: {error}")
    return NotProved("; ".join(reasons))
