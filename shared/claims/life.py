"""Lives: which proved curves of equilibria and of periodic orbits are claimed to be joined, and how."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, get_args

from orbitproof.shared.claims.fields import Id, Line
from orbitproof.shared.stored import rules

Joining = Literal["begins on", "ends on"]
BEGINS, ENDS = get_args(Joining)


@dataclass(frozen=True)
class LifeJoint:
    """The claim that an arc is joined to another one.

    Attributes:
        arc: the id of the other.
        how: one of the words of `Joining` (section 39.2).
    """

    arc: Id
    how: Joining


@dataclass(frozen=True)
class LifeArc:
    """An arc: the id of its certificate, and the arcs to which it is claimed to be joined."""

    id: Id
    joints: Annotated[tuple[LifeJoint, ...], rules(maxItems=100)] = ()


@dataclass(frozen=True)
class Life:
    """A graph of proved curves of equilibria and of periodic orbits of one vector field, as it is claimed.

    Attributes:
        id: short name.
        title: what people read.
        arcs: each once.
        connected: whether it is claimed that the arcs hang together.
    """

    id: Id
    title: Line
    arcs: Annotated[tuple[LifeArc, ...], rules(minItems=1, maxItems=1000)]
    connected: bool = True

    @property
    def kind(self) -> str:
        """What is claimed, as of other claims; a file says it by its format."""
        return "life"

    @property
    def certificates(self) -> tuple[str, ...]:
        """The ids of the certificates of its arcs."""
        return tuple(arc.id for arc in self.arcs)

    reserved: ClassVar[tuple[str, ...]] = ()

    @property
    def keys(self) -> tuple[tuple[str, str], ...]:
        """What it rests on, in its order: its arcs."""
        return tuple(("arc", name) for name in self.certificates)
