"""Checking the pieces of an atlas in float64: orbits at random places against polynomials, tubes and neighbours.

Not rigorous: it finds wrong files, not small errors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np

from orbitproof.explore.atlases.complex_flow import LANES, ComplexArray, HalfReturns
from orbitproof.explore.atlases.expansion import Chart, ExpansionFailure, newton_on_curve
from orbitproof.explore.engines import Reporter
from orbitproof.explore.flow import FlowFailure, Matrix, Vector
from orbitproof.explore.names import examined
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import Atlas, InputError, Piece, read_atlas
from orbitproof.shared.printed_tables import wrapped
from orbitproof.shared.systems import REGULARISATIONS
from orbitproof.shared.wording import counted

LONGEST_TIME = 1e4

WINDOWS = 12
"""How often the window of times is made shorter because an orbit cannot be followed to its end."""

NEAREST = 0.1
"""Symmetric pieces are compared at least so far from s = 0."""

NODES = 6
"""Places of a piece where the time of the first return is searched; it is interpolated between them."""


@dataclass(frozen=True)
class PieceCheck:
    """What orbits say about a piece.

    Attributes:
        piece: its id.
        deviation: largest distance of the p_j from their polynomials, in units of the tube.
        kernel: largest magnitude of a kernel coordinate at the first return of the polynomial's points.
        failure: why there is no comparison, or "".
    """

    piece: str
    deviation: float = np.nan
    kernel: float = np.nan
    failure: str = ""

    @property
    def good(self) -> bool:
        """Whether the curve lies in the tube, well inside."""
        return self.deviation < 0.5


@dataclass(frozen=True)
class JointCheck:
    """How a piece goes over into the next: the next one's s, and its p_j in units of the tube, at the end s = 1."""

    place: float
    deviation: float

    @property
    def good(self) -> bool:
        """Whether the end lies in the next piece's tube."""
        return abs(self.place) <= 1 and self.deviation < 1


def check_file(path: Path, quiet: bool) -> int:
    """Check an atlas file, print one line for each piece; returns the exit code. Raises `InputError`."""
    atlas = read_atlas(path)
    examined(atlas.system, str(path))
    if atlas.is_surface:
        raise InputError(f"{path}: field claim.kind: {atlas.claim.kind}; this check is for curves")
    if not atlas.is_of_symmetric_orbits:
        raise InputError(f"{path}: field claim.kind: {atlas.claim.kind}; this check is for curves of symmetric orbits")
    if atlas.system.normalised:
        raise InputError(f"{path}: field system: {atlas.system.name}; families in units of their size are not checked")
    good = True
    with Reporter(quiet) as report:
        report.stage("checking")
        pieces = atlas.curve_pieces()
        joints = [check_joint(*pair) for pair in pairwise(pieces)]
        for number, piece in enumerate(pieces):
            report.update(piece.id, number / len(pieces))
            result = check_piece(atlas, piece)
            good &= result.good
            line = f"{piece.id}  {piece.kind:9}  {piece.coordinates:11}  half-width {float(piece.half_width):.3g}"
            if result.failure:
                line += f"  {result.failure}"
            else:
                line += f"  off by {result.deviation:.1e} tubes  kernel {result.kernel:.1e}"
            if number < len(joints):
                joint = joints[number]
                good &= joint.good
                line += f"  next at s = {joint.place:.3f}, {joint.deviation:.1e} tubes"
                line += "" if joint.good else "  NOT IN THE NEXT TUBE"
            tell(wrapped([line]), [{"piece": piece.id, "line": line}])
    tell(f"{counted(len(pieces), 'piece')}: {'all' if good else 'not all'} as they should be")
    return 0 if good else 1


def check_joint(piece: Piece, following: Piece) -> JointCheck:
    """Where the end of a piece lies in the following one, exactly up to rounding of the result."""
    place, *across = _local(following, piece)
    s = place / float(following.half_width)
    deviation = max(
        abs(value - float(np.polynomial.polynomial.polyval(s, [float(c) for c in row]))) / float(width)
        for value, row, width in zip(across, following.polynomial, following.tube, strict=True)
    )
    return JointCheck(s, deviation)


def _local(following: Piece, piece: Piece) -> Sequence[float]:
    end = piece.point(Fraction(1))
    offset = [float(a - b) for a, b in zip(end, following.centre, strict=True)]
    frame = np.array([[float(value) for value in row] for row in following.frame])
    return [float(value) for value in np.linalg.solve(frame, offset)]


def check_piece(atlas: Atlas, piece: Piece, seed: int = 0) -> PieceCheck:
    """Orbits of a piece at random places, found by Newton's method from its polynomial."""
    coordinates = piece.coordinates
    if coordinates == "auto":
        coordinates = "regularised" if atlas.system.name in REGULARISATIONS else "physical"
    returns = HalfReturns(atlas.system, atlas.parameters, "regularised" if coordinates == "regularised" else "physical")
    count = LANES // len(piece.centre)
    places = np.sort(np.random.default_rng(seed).uniform(-1, 1, count))
    if piece.is_symmetric:
        # At s = 0 another family crosses the curve, and near it the equations say little about the place across.
        places = np.sign(places) * (NEAREST + (1 - NEAREST) * np.abs(places))
    chart = Chart(
        np.array([float(value) for value in piece.centre]),
        np.array([[float(value) for value in row] for row in piece.frame]),
        float(piece.half_width),
        1e3 * float(min(piece.tube)),
    )
    rows = [[float(c) for c in row] for row in piece.polynomial]

    def across(s: Vector) -> Matrix:
        return np.array([np.polynomial.polynomial.polyval(s, row) for row in rows])

    try:
        nodes = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
        starts = chart.points(np.vstack([chart.half_width * nodes, across(nodes)]))
        returned = first_returns(returns, starts)
        times = np.polynomial.polynomial.polyval(places, np.polynomial.polynomial.polyfit(nodes, returned, NODES - 1))
        found, kernel = newton_on_curve(returns, chart, places, across(places), times)
    except (FlowFailure, ExpansionFailure) as error:
        return PieceCheck(piece.id, failure=str(error))
    tube = np.array([float(value) for value in piece.tube])
    deviation = float(np.max(np.abs(found - across(places)).max(axis=1) / tube))
    return PieceCheck(piece.id, deviation, kernel)


def first_returns(returns: HalfReturns, points: ComplexArray) -> Vector:
    """The times, in the coordinates', of the first returns of N points of Fix(R) to the section, to six digits.

    Each point is followed over many times at once, at first all over the same ones; the first change of sign is then
    searched between its two neighbours. Raises `FlowFailure`.
    """
    number = points.shape[1]
    parts = LANES // number
    lanes = np.repeat(points, parts, axis=1)
    low, high, signs = np.zeros(number), np.full(number, 1.0), np.zeros(number)
    found = np.zeros(number, dtype=bool)
    failures = 0
    while np.all(high < LONGEST_TIME):
        times = low[:, None] + (high - low)[:, None] * (np.arange(parts) + 1) / parts
        try:
            heights = returns.evaluate(lanes, times.ravel().astype(complex)).values[0].real
        except FlowFailure:
            # Beyond its return an orbit may run away.
            failures += 1
            if failures > WINDOWS:
                raise
            high = low + (high - low) / 8
            continue
        heights = heights.reshape(number, parts)
        signs = np.where(signs == 0, np.sign(heights[:, 0]), signs)
        beyond = heights * signs[:, None] < 0
        found |= np.any(beyond, axis=1)
        if np.all(found) and np.all(high - low < 1e-5 * high):
            return np.asarray(high)
        width = high - low
        first = np.argmax(beyond, axis=1)
        inside = np.any(beyond, axis=1)
        before = np.where(first > 0, times[np.arange(number), first - 1], low)
        low = np.where(inside, before, np.where(found, low, high))
        high = np.where(inside, times[np.arange(number), first], high)
        high = np.where(found, high, low + width * (1 if failures else 2))
    raise FlowFailure("an orbit does not return to the section")
