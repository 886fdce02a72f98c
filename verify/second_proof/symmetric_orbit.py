"""A symmetric orbit, one that is stable for ever, and one with tori, once more. README, sections 13, 15 and 16."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from flint import acb, arb

from .conditions import Hypothesis, Vector
from .crossing import TIME
from .elliptic_tori import Torsion, torsion
from .full_return import FullReturn
from .halves import Half, HalfOrbits, guess, read_symmetric
from .jets import CannotFollow, Jet, ball
from .newton import checked
from .periodic import attempted
from .proof import NotProved

ORDER = 6
"""Bits per bit that a half orbit loses."""


@dataclass(frozen=True)
class ProvedSymmetric:
    """The symmetric orbit is proved; if it is claimed, that it is elliptic and has a twist, or a regular torsion.

    Attributes:
        kind: as claimed.
        point, other_point: enclosures of its two points on Fix(R), by name, without a coordinate that follows from a
            fixed level.
        coordinates: of the point in the coordinates of the claim.
        level: of the first integral at it, `None` without one; `period`: its least period.
        stability: the stability parameters, those of multipliers lambda being (lambda + 1/lambda)/2.
        rotation_number, twists: of a stable orbit; twists by the name of t, `momentum` is that of q.
        defect: a multiple of Re(conj(lambda) c_1).
        torsion: of an orbit at which tori accumulate.
        hypotheses, width, bits, steps: as of `ProvedPeriodic`.
    """

    kind: str
    point: dict[str, arb]
    other_point: dict[str, arb]
    coordinates: tuple[arb, ...]
    level: arb | None
    period: arb
    stability: tuple[acb, ...]
    rotation_number: arb | None
    momentum: str
    twists: dict[str, arb]
    defect: arb | None
    torsion: Torsion | None
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int
    steps: int


class _Proof(HalfOrbits):
    """One attempt: the unknowns are those of the orbit."""

    def more(self, half: Half, around: Sequence[arb], degree: int) -> list[Jet]:
        """What singles the orbit out."""
        claim, value = self.claim, Jet({(): ball(self.claim.value)}, degree)
        if claim.quantity == "half period":
            return [Jet({(): around[self.time], (TIME,): arb(1)}, degree) - value]
        if claim.quantity == "level":
            return [claim.system.conserved(half.start) - value]
        assert claim.place is not None
        return [half.start[claim.place] - value]

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivatives of all equations by the coordinates of Fix(R) and T."""
        return self.slopes(rows)

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of the equations at the centre."""
        return [row[()] for row in rows]

    def conclusion(self) -> ProvedSymmetric:
        """The proof. Raises `CannotFollow` if a condition does not hold."""
        claim, system = self.claim, self.claim.system
        newton, zero, half, _ = self.enclosed()
        point, is_stable, has_tori = zero[: self.time], system.kind == "stable_orbit", system.kind == "invariant_tori"
        named = [(system.state[i], i) for i in system.fixed]
        values = dict(zip(self.places, point, strict=True))
        found = FullReturn(self, zero, 3 if is_stable or has_tori else 1)
        checks, stability = [newton, *self.check_point(zero), *found.checks], found.stability()
        rotation, twists, defect = None, dict[str, arb](), None
        if is_stable:
            more, rotation, twists, defect = found.twisted()
            checks += more
        tori = torsion(found) if has_tori else None
        checks += tori.hypotheses if tori is not None else []
        start = [Jet({(): jet[()]}, 0) for jet in self.jets(point, 0)]
        return ProvedSymmetric(
            system.kind, {name: values[i] for name, i in named}, {name: half.end[i][()] for name, i in named},
            tuple(claim.coordinates(point, system.level(start)[()])),
            system.conserved(start)[()] if found.has_level else None, 2 * zero[self.time], stability,
            rotation, system.state[system.kernel[0]], twists, defect, tori, checked(checks),
            self.width, self.bits, self.steps,
        )  # fmt: skip


def prove_symmetric(certificate: Mapping[str, Any]) -> ProvedSymmetric | NotProved:
    """Prove the orbit that a certificate claims, from its statement and the centre of its box alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    try:
        claim = read_symmetric(certificate)
        if claim.system.kind == "stable_orbit" and len(claim.system.kernel) != 1:
            raise CannotFollow("no theorem that is used here says that an orbit with n > 1 is stable")
        if claim.system.kind == "invariant_tori" and len(claim.system.kernel) != 2:
            raise CannotFollow("the theorem about tori that is used here is about n = 2")
    except CannotFollow as error:
        return NotProved(str(error))
    return attempted(
        claim,
        lambda bits: guess(claim, bits),
        ORDER,
        lambda bits, start: _Proof(claim, bits, start).conclusion(),
    )
