"""What a certificate claims of a curve of equilibria. README, section 18.1."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from .equilibria import EquilibriumStatement, read_field
from .jets import CannotFollow, Jet
from .statement import BadCertificate, exact, read

CURVES = "equilibrium-arc", "equilibrium-loop"


@dataclass(frozen=True)
class Piece:
    """A piece of the claim: the points centre + frame (h s, p) with p about the values of polynomials in s."""

    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    half_width: Fraction
    polynomial: tuple[tuple[Fraction, ...], ...]
    tube: tuple[Fraction, ...]

    def inside(self, s: Fraction) -> list[Fraction]:
        """The coordinates (h s, Q(s)) at s."""
        return [
            self.half_width * s,
            *(sum((c * s**k for k, c in enumerate(row)), Fraction(0)) for row in self.polynomial),
        ]

    def point(self, s: Fraction) -> list[Fraction]:
        """The point in the middle of the tube at s."""
        inside = self.inside(s)
        return [
            c + sum(map(Fraction.__mul__, row, inside), Fraction(0))
            for c, row in zip(self.centre, self.frame, strict=True)
        ]


@dataclass(frozen=True)
class CurveStatement:
    """What a certificate claims of a curve of equilibria; the coordinates are what varies, then the state."""

    field: EquilibriumStatement
    is_closed: bool
    pieces: tuple[Piece, ...]
    increasing: tuple[str, ...]
    covers: tuple[str, Fraction, Fraction] | None

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the coordinates."""
        return (str(self.field.varying), *self.field.names)

    def rates(self, state: Sequence[Jet]) -> list[Jet]:
        """Jets of f."""
        return self.field.rates(state[1:], state[0])


def read_curve(certificate: Mapping[str, Any]) -> CurveStatement:
    """The statement of a certificate of a curve of equilibria. Raises `BadCertificate`; `CannotFollow` for others."""
    atlas = "statement.atlas"
    kind, varying = (read(certificate, f"{atlas}.claim.{name}", str) for name in ("kind", "parameter"))
    if kind not in CURVES:
        raise CannotFollow("no theorem that is used here is about such curves")
    parameters = read(certificate, f"{atlas}.parameters", lambda known: {n: exact(v) for n, v in known.items()})
    field = replace(
        read_field(certificate, parameters | {varying: Fraction(0)}), parameters=parameters, varying=varying
    )
    names = (varying, *field.names)
    pieces = read(certificate, f"{atlas}.pieces", lambda given: tuple(map(_piece, given)))
    claim = read(certificate, f"{atlas}.claim", dict)
    increasing = tuple(claim.get("increasing") or ())
    covers = None
    if claim.get("covers"):
        covers = read(
            certificate, f"{atlas}.claim.covers", lambda c: (c["coordinate"], exact(c["from"]), exact(c["to"]))
        )
    n = len(names)
    for piece in pieces:
        shape = len(piece.centre), len(piece.polynomial), len(piece.tube), {len(row) for row in piece.frame}
        if shape != (n, n - 1, n - 1, {n}) or len(piece.frame) != n or min(piece.half_width, *piece.tube) <= 0:
            raise BadCertificate(f"{atlas}.pieces: they do not have the sizes of the coordinates")
    if not pieces or varying in parameters or not {*names} >= {*increasing, *(covers or names)[:1]}:
        raise BadCertificate(f"{atlas}: pieces, parameter or coordinates are not those of a claim")
    return CurveStatement(field, kind == CURVES[1], pieces, increasing, covers)


def _piece(given: Mapping[str, Any]) -> Piece:
    return Piece(*(exact(given[name]) for name in ("centre", "frame", "half_width", "polynomial", "tube")))
