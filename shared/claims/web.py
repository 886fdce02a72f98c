"""Webs: which proved curves of periodic orbits are claimed to meet which certified orbits, and how."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar, Final, Literal, get_args

from orbitproof.shared.claims.fields import Id, Line
from orbitproof.shared.stored import rules

How = Literal["ends at", "passes through", "branches off at"]
ENDS, PASSES, BRANCHES = get_args(How)
LIBRATION_POINTS: Final = ("L1", "L2", "L3")
"""Vertices that need no certificate: the family around such a point proves that it shrinks to it."""


@dataclass(frozen=True)
class Meeting:
    """The claim that an arc meets a vertex.

    Attributes:
        vertex: the id of a certificate of a bifurcation or of one orbit, or one of `LIBRATION_POINTS`.
        how: one of the words of `How` (section 33.2).
    """

    vertex: Id
    how: How


@dataclass(frozen=True)
class WebArc:
    """An arc: the id of its certificate, and the vertices that it is claimed to meet.

    Attributes:
        index: whether the index of its orbits is claimed to be known, by a certificate with the id of the arc.
    """

    id: Id
    meets: Annotated[tuple[Meeting, ...], rules(maxItems=10000)] = ()
    index: bool = False


@dataclass(frozen=True)
class Web:
    """A graph of proved curves of periodic orbits, as it is claimed.

    Attributes:
        id: short name.
        title: what people read.
        arcs: each once.
        connected: whether it is claimed that the arcs hang together.
    """

    id: Id
    title: Line
    arcs: Annotated[tuple[WebArc, ...], rules(minItems=1, maxItems=10000)]
    connected: bool = True

    @property
    def kind(self) -> str:
        """What is claimed, as of other claims; a file says it by its format."""
        return "web"

    @property
    def vertices(self) -> tuple[str, ...]:
        """The ids of the vertices, each once, in the order in which arcs meet them."""
        return tuple(dict.fromkeys(meeting.vertex for arc in self.arcs for meeting in arc.meets))

    @property
    def certificates(self) -> tuple[str, ...]:
        """The ids of the certificates of its arcs and vertices, those of the arcs first."""
        return (
            *(arc.id for arc in self.arcs),
            *(name for name in self.vertices if name not in LIBRATION_POINTS),
        )

    reserved: ClassVar[tuple[str, ...]] = LIBRATION_POINTS
    """Names that no certificate has."""

    @property
    def keys(self) -> tuple[tuple[str, str], ...]:
        """What it rests on, in its order: arcs, vertices, indices."""
        arcs = {arc.id for arc in self.arcs}
        own = tuple(("arc" if name in arcs else "vertex", name) for name in self.certificates)
        return (*own, *(("index", name) for name in self.indices))

    @property
    def indices(self) -> tuple[str, ...]:
        """The ids of the arcs of which an index is claimed to be known; its certificate has the id of the arc."""
        return tuple(arc.id for arc in self.arcs if arc.index)
