"""Known curves as atlases, with results as a prover of pieces would give them.

Along the circle x = cos(a), z = sin(a), vy = 3 - cos(a) a piece is a graph over the sine of the angle from its
centre. The results are fabricated, but true: the deviations bound the Taylor remainder and all rounding.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from flint import arb
from support.conclusions import conclude

from orbitproof.shared import format_exact
from orbitproof.shared.claims import Atlas, Claim, Covers, Piece
from orbitproof.shared.systems import CR3BP, CR3BP_PLANAR, FALKNER_SKAN
from orbitproof.verify.certificate import Certificate, Finding, Recheck
from orbitproof.verify.curve import Conclusion, ProvedCurve
from orbitproof.verify.evidence import ball_to_json

MU = Fraction(1, 80)
HALF_WIDTH = Fraction(2, 5)
TUBE = Fraction(1, 10**6)
DEGREE = 20

Result = dict[str, Any]
Case = tuple[Atlas, list[Result]]


def circle_piece(number: int, angle: float, kind: str = "regular", lift: float = 0.0) -> Piece:
    """The piece of the circle around an angle; `lift` moves it across, away from the circle."""
    cosine, sine = (Fraction(round(f(angle), 15)) for f in (math.cos, math.sin))
    # sqrt(1 - u) = 1 - u/2 - u^2/8 - .., u = (half_width s)^2
    coefficients, binomial = [Fraction(0)] * (DEGREE + 1), Fraction(1)
    for n in range(1, DEGREE // 2 + 1):
        binomial *= -(Fraction(1, 2) - (n - 1)) / n
        coefficients[2 * n] = Fraction(float(binomial * HALF_WIDTH ** (2 * n)))
    return Piece(
        id=f"p{number:03}",
        kind=kind,
        centre=(cosine, sine, 3 - cosine),
        frame=(
            (-sine, cosine, Fraction(0)),
            (cosine, sine, Fraction(0)),
            (sine, -cosine, Fraction(1)),
        ),
        half_width=HALF_WIDTH,
        polynomial=(tuple(coefficients), (Fraction(lift),)),
        tube=(TUBE, TUBE),
    )


def parabola_piece(number: int, middle: Fraction, half_width: Fraction) -> Piece:
    """The piece of y = beta^2/100 around a value of beta."""
    return Piece(
        id=f"p{number:03}",
        kind="regular",
        centre=(middle, middle**2 / 100),
        frame=((Fraction(1), Fraction(0)), (middle / 50, Fraction(1))),
        half_width=half_width,
        polynomial=((Fraction(0), Fraction(0), half_width**2 / 100),),
        tube=(TUBE,),
    )


def proved(piece: Piece, start: str = "-1", end: str = "1", **changes: Any) -> Result:
    """The result of an interval of a piece."""
    size = len(piece.tube)
    return {
        "piece": piece.id,
        "interval": [start, end],
        "verdict": "proved",
        "reason": None,
        "deviation": [format_exact(Fraction(1, 2**30))] * size,
        "slope_deviation": [format_exact(Fraction(1, 2**26))] * size,
        "time": ball_to_json(arb(3, 0.25)),
        **changes,
    }


def circle(claim: Claim, angles: Sequence[float], symmetric: Sequence[int] = ()) -> Case:
    pieces = tuple(
        circle_piece(number, angle, "symmetric" if number in symmetric else "regular")
        for number, angle in enumerate(angles)
    )
    atlas = Atlas("circle", "a circle", CR3BP, {"mu": MU}, claim, pieces)
    return atlas, [proved(piece) for piece in pieces]


def symmetric_loop(claim: Claim | None = None) -> Case:
    """From (1, 0, 2) to (-1, 0, 4) along the half with z > 0."""
    return circle(claim or Claim("symmetric-loop", "S"), [k * math.pi / 5 for k in range(6)], (0, 5))


def symmetric_arc(claim: Claim | None = None) -> Case:
    """From (1, 0, 2) to an angle of 2.297."""
    return circle(claim or Claim("symmetric-arc", "S", ("vy",)), [k * math.pi / 5 for k in range(4)], (0,))


def loop() -> Case:
    """All of the circle, in ten regular pieces."""
    return circle(Claim("loop"), [0.1 + k * math.pi / 5 for k in range(10)])


def line_in_plane() -> Case:
    """Points of the planar problem with vy = 2 and x from 0.9 to 1.1."""
    half = Fraction(1, 10)
    frame = ((Fraction(1), Fraction(0)), (Fraction(0), Fraction(1)))
    piece = Piece("p000", "regular", (Fraction(1), Fraction(2)), frame, half, ((Fraction(0),),), (TUBE,))
    claim = Claim("arc", None, ("x",), Covers("x", Fraction(91, 100), Fraction(109, 100)))
    return Atlas("line", "a line", CR3BP_PLANAR, {"mu": MU}, claim, (piece,)), [proved(piece)]


def parabola(claim: Claim | None = None) -> Case:
    """y = beta^2/100 for beta from 1 to 5."""
    pieces = (
        parabola_piece(0, Fraction(2), Fraction(1)),
        parabola_piece(1, Fraction(7, 2), Fraction(3, 4)),
        parabola_piece(2, Fraction(9, 2), Fraction(1, 2)),
    )
    covers = Covers("beta", Fraction(1), Fraction(5))
    claim = claim or Claim("arc", None, ("beta", "y"), covers)
    atlas = Atlas("parabola", "a parabola", FALKNER_SKAN, {}, claim, pieces)
    return atlas, [proved(piece) for piece in pieces]


def with_piece(case: Case, number: int, change: Callable[[Piece], Piece]) -> Case:
    """The case with one piece changed."""
    atlas, results = case
    pieces = list(atlas.curve_pieces())
    pieces[number] = change(pieces[number])
    return replace(atlas, pieces=tuple(pieces)), results


def with_results(case: Case, number: int, *instead: Mapping[str, Any]) -> Case:
    """The case with other results for one piece: each is what differs from the full one."""
    atlas, results = case
    piece = atlas.curve_pieces()[number]
    kept = [result for result in results if result["piece"] != piece.id]
    return atlas, [*kept, *(proved(piece) | dict(change) for change in instead)]


def without(case: Case, number: int) -> Case:
    """The case with one piece left out."""
    atlas, results = case
    left = tuple(piece for index, piece in enumerate(atlas.curve_pieces()) if index != number)
    return replace(atlas, pieces=left), results


def reversed_piece(piece: Piece) -> Piece:
    """The same points, run through in the other direction."""
    frame = tuple((-row[0], *row[1:]) for row in piece.frame)
    polynomial = tuple(tuple(c * (-1) ** n for n, c in enumerate(row)) for row in piece.polynomial)
    return replace(piece, frame=frame, polynomial=polynomial)


def certificate(
    point: Mapping[str, arb], proved: bool = True, after: str = "", name: str = "the point", **changes: Any
) -> Certificate:
    """A certificate of a period doubling at a point of the circle's system, in which only what is read is true.

    `after` comes after the vector field; `changes` are made to the candidate.
    """
    system = FALKNER_SKAN if "beta" in point else CR3BP
    symmetry = changes.get("symmetry")
    candidate = {
        "system": system.name,
        "parameters": {} if system is FALKNER_SKAN else {"mu": format_exact(MU)},
        "kind": "period_tupling",
        "k": 2,
        "symmetry": None,
    }
    statement = {
        "candidate": candidate | changes,
        "vector_field": system.program.text() + after,
        "first_integral": None,
        "reversing_symmetry": list(system.reversing_symmetry),
        "section": system.section,
        "symmetry": None if symmetry is None else list(system.symmetries[symmetry]),
        "names": {"system": system.title},
    }
    told = {"theorem": "as the tests have it", "in_full": "as the tests have it"}
    results = {
        "point": {name: ball_to_json(ball) for name, ball in point.items()},
        "parameter_name": "Jacobi constant",
        "parameter": ball_to_json(arb(3, 2**-40)),
        "side": "below",
        "normal_form": {},
    }
    hypothesis = {"name": "C2", "statement": "as the tests have it", "section": "8", "holds": True, "enclosures": {}}
    return Certificate.from_json(
        {
            "id": name,
            "statement": statement | (told if proved else {}),
            "verdict": "proved" if proved else "not proved",
            "reason": None if proved else {"condition": "C3", "message": "as the tests have it", "remedy": "none"},
            "hypotheses": [hypothesis],
            "results": results if proved else None,
            "computation": {"precision": 64, "order": 16, "steps": 1, "attempts": 1, "seconds": 0.0},
        }
    )


def circle_point(angle: float, radius: float = 2**-40) -> dict[str, arb]:
    """A ball about a point of the circle."""
    x, z = math.cos(angle), math.sin(angle)
    return {name: arb(value, radius) for name, value in (("x", x), ("z", z), ("vy", 3 - x))}


def stands(entry: Certificate) -> Recheck:
    """An examination that every certificate passes."""
    return Recheck(entry.id, "proved", 1, ())


def falls(entry: Certificate) -> Recheck:
    """An examination that none passes."""
    return Recheck(entry.id, "proved", 1, (Finding("digest", "does not fit the content"),))


def alone(*_: object) -> None:
    """No other point of an orbit on Fix(R): the points of the circle are on no orbit that is known."""


def concluded(case: Case, *bifurcations: Certificate) -> Conclusion[ProvedCurve]:
    atlas, results = case
    return conclude(atlas, results, bifurcations, stands, alone)
