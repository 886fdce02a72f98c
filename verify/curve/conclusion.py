"""What the pieces of an atlas prove together, of a curve or of a surface (sections 15.9 and 17.4)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, Protocol, TypeVar

from flint import arb

from orbitproof.verify.evidence import Outcome, Proved

if TYPE_CHECKING:
    from orbitproof.verify.curve.bifurcations_on_it import Bifurcation

Ends = Mapping[str, Mapping[str, arb]]
"""Enclosures by name at the first point or parameter, "start", and at the last one, "end"."""


class Whole(Protocol):
    """Pieces that are glued to one curve or surface."""

    @property
    def ends(self) -> Ends:
        """Enclosures at its ends."""


Known = TypeVar("Known", bound=Whole, covariant=True)


@dataclass(frozen=True)
class Conclusion(Generic[Known]):
    """What the pieces of an atlas prove together.

    Attributes:
        outcome: the theorem about the whole, or the first hypothesis that is not shown.
        bifurcations: the certificates given, and where on the whole they are; each says for itself whether it is.
    """

    outcome: Outcome[Known]
    bifurcations: tuple[Bifurcation, ...] = ()

    @property
    def is_proved(self) -> bool:
        """Whether the whole is proved."""
        return isinstance(self.outcome, Proved)
