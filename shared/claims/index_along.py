"""The claim that the orbits of a proved curve have an index, which the proof finds."""

from __future__ import annotations

from dataclasses import dataclass

from orbitproof.shared.claims.fields import Id


@dataclass(frozen=True)
class IndexAlong:
    """The Conley-Zehnder index of the orbits of a proved curve, between the points of its list (section 35).

    Attributes:
        curve: the id of its certificate; without a list the index of one of its orbits is found.
    """

    curve: Id

    kind = "index"

    @property
    def id(self) -> str:
        """The id of the curve, which the certificate has too."""
        return self.curve
