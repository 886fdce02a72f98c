"""The planar orbits over which a surface lives are the Lyapunov family of the libration point (section 17.6).

The points of the surface at zeta = 0 are followed through the pieces of the family: where one of them lies in the tube
of a piece for one mass, they do for all masses of the piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Atlas, LibrationPiece, evaluate
from orbitproof.shared.systems import SIDES, mass_of_distance
from orbitproof.verify.algebra import ball_polynomial
from orbitproof.verify.curve import Interval, IntervalResult
from orbitproof.verify.evidence import (
    Evidence,
    bounds,
    enclose,
    excludes_zero,
    hull,
    is_below,
    is_inside,
    is_positive,
    show,
)
from orbitproof.verify.surface.gluing import Sheet
from orbitproof.verify.surface.libration_piece import read_sizes

_HALVINGS = 12
"""How often the range of a piece is halved at most to enclose the sizes of the orbits."""


@dataclass(frozen=True)
class PlanarFamily:
    """The masses at which the planar orbits of a surface belong to the Lyapunov family of `point`.

    Attributes:
        point: "L1" or "L2".
        start, end: of mu; at 0 the statement is about Hill's problem.
    """

    point: str
    start: Fraction
    end: Fraction


def require_family(
    evidence: Evidence, atlas: Atlas, sheets: Sequence[Sheet], results: Sequence[IntervalResult]
) -> PlanarFamily | None:
    """Require that the pieces prove the Lyapunov family up to the symmetry breakings, for all masses between ends.

    Args:
        sheets: pieces of the surface that are proved, glued and in order.
        results: of all pieces.
    """
    pieces = atlas.libration_pieces()
    side = SIDES[pieces[0].point]
    evidence.require(len({piece.point for piece in pieces}) == 1, "the pieces are about two libration points")
    reached: Fraction | None = None
    for piece in pieces:
        _require_proved(evidence, piece, [entry for entry in results if entry.piece == piece.id])
        near, far = sorted(side * (piece.distance[0] + sign * piece.distance[1]) for sign in (-1, 1))
        gap = reached is not None and near > reached
        evidence.require(near >= 0, f"{piece.id} goes to the other side of the smaller mass")
        evidence.require(not gap, f"there is a gap before {piece.id}, from b = {side * float(reached or 0):.9g} on")
        evidence.require(reached is None or far > reached, f"{piece.id} is not in order")
        reached = far
    if not evidence.holds:
        return None
    for piece in pieces:
        _require_followed(evidence, piece, sheets)
    if not evidence.holds:
        return None
    start, end = _mass(pieces[0], -side), _mass(pieces[-1], side)
    evidence.require(0 <= start < end < 1, "the masses of the pieces are not between 0 and 1")
    return PlanarFamily(pieces[0].point, start, end)


def _require_proved(evidence: Evidence, piece: LibrationPiece, results: Sequence[IntervalResult]) -> None:
    """All s are proved, and eps = 0 is among the sizes."""
    reached = Fraction(-1)
    known = [read_sizes(piece, result) for result in results if result.is_proved]
    for refused in known:
        evidence.require(not isinstance(refused, str), str(refused))
    for part in sorted((part.start, part.end) for part in known if not isinstance(part, str)):
        if part[0] <= reached:
            reached = max(reached, part[1])
    evidence.require(reached >= 1, f"piece {piece.id} is not proved from s = {float(reached):.6g} on")
    evidence.require(
        abs(piece.size[0]) < piece.size[1], f"{piece.id} does not reach the libration point: eps = 0 is not inside"
    )


def _mass(piece: LibrationPiece, end: int) -> Fraction:
    """mu at the upper (1) or lower (-1) end of the range of b."""
    distance = piece.distance[0] + end * piece.distance[1]
    return distance**3 * Fraction(mass_of_distance(SIDES[piece.point], distance))


def _require_followed(evidence: Evidence, piece: LibrationPiece, sheets: Sequence[Sheet]) -> None:
    """The symmetry breakings have sizes of the piece for all its b, and one of them lies in its tube."""
    low, high = (piece.distance[0] + sign * piece.distance[1] for sign in (-1, 1))
    pending = [((low, high), 0)]
    while pending:
        part, halvings = pending.pop()
        found = _breaking(piece, sheets, part)
        if found is _OUTSIDE:
            continue
        if isinstance(found, tuple) and excludes_zero(found[0]) and _is_size(piece, found[0]):
            continue
        if halvings == _HALVINGS:
            known = f"is at eps = {show(found[0])}" if isinstance(found, tuple) else "is not enclosed"
            where = f"at b = {float(part[0]):.9g} the symmetry breaking {known}"
            evidence.require(False, f"{where}, not shown to be among the sizes of {piece.id}")
            return
        middle = (part[0] + part[1]) / 2
        pending += [((part[0], middle), halvings + 1), ((middle, part[1]), halvings + 1)]
    _require_in_tube(evidence, piece, sheets)


def _require_in_tube(evidence: Evidence, piece: LibrationPiece, sheets: Sequence[Sheet]) -> None:
    """At one b of the piece, the first that will do, the symmetry breaking lies in the tube."""
    found = None
    for share in (Fraction(0), Fraction(1, 2), Fraction(-1, 2), Fraction(15, 16), Fraction(-15, 16)):
        distance = piece.distance[0] + share * piece.distance[1]
        found = _breaking(piece, sheets, (distance, distance))
        if isinstance(found, tuple):
            offset = found[1] - _speed(piece, share, found[0])
            evidence.record(f"vy of the symmetry breaking in {piece.id}", offset)
            evidence.require(
                is_inside(offset, piece.tube),
                f"the symmetry breaking at b = {float(distance):.9g} is not in the tube of {piece.id}: its vy differs "
                f"by {show(offset)} from that of the family",
            )
            return
    evidence.require(False, f"no symmetry breaking was found over {piece.id}")


class _Outside:
    """No mass of the part is one of the surface."""


_OUTSIDE = _Outside()


def _breaking(piece: LibrationPiece, sheets: Sequence[Sheet], part: Interval) -> tuple[arb, arb] | _Outside | None:
    """(eps, vy) of the symmetry breakings for b in an interval, by (17.5); `None` if they are not enclosed."""
    side = SIDES[piece.point]
    b = hull(enclose(part[0]), enclose(part[1]))
    ratio = side * mass_of_distance(side, b)
    if not is_positive(ratio):
        return None
    scale = side * ratio.root(3)
    h = b * scale
    first, last = (_end(sheet, end) for sheet, end in ((sheets[0], -1), (sheets[-1], 1)))
    if is_below(h, enclose(first)) or is_below(enclose(last), h):
        return _OUTSIDE
    low, high = max(bounds(h)[0], first), min(bounds(h)[1], last)
    for sheet in sheets:
        if _end(sheet, -1) <= low and high <= _end(sheet, 1):
            xi, _, veta = sheet.point(sheet.place(low)[0], sheet.place(high)[1])
            eps = scale * xi - 1
            return eps, scale * veta / eps
    return None


def _end(sheet: Sheet, end: int) -> Fraction:
    """The parameter at s = 1 or s = -1."""
    return evaluate(sheet.parameter, Fraction(end))


def _is_size(piece: LibrationPiece, eps: arb) -> bool:
    return is_inside(eps - enclose(piece.size[0]), piece.size[1])


def _speed(piece: LibrationPiece, beta: Fraction, eps: arb) -> arb:
    """vy of the piece's polynomial."""
    s = (eps - enclose(piece.size[0])) / enclose(piece.size[1])
    value = arb(0)
    for row in reversed(piece.polynomial):
        value = value * enclose(beta) + ball_polynomial(row)(s)
    return value
