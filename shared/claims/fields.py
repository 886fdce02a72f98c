"""What the fields of claims hold: names, vectors, matrices, polynomials; and what claims about branches are about."""

from __future__ import annotations

from fractions import Fraction
from typing import Annotated, Final

from orbitproof.shared.stored import rules
from orbitproof.shared.systems import ID, IDENTIFIER, LINE, PIECE, TITLE

Vector = tuple[Fraction, ...]
Matrix = tuple[Vector, ...]

Numbers = Annotated[Vector, rules("vector", minItems=1, maxItems=32)]
Rows = Annotated[tuple[Numbers, ...], rules("matrix", minItems=1, maxItems=32)]
Polynomial = Annotated[
    Vector, rules("polynomial", description="Coefficients of 1, s, s^2, ..", minItems=1, maxItems=1000)
]
Polynomials = Annotated[tuple[Polynomial, ...], rules("polynomials", minItems=1, maxItems=32)]
Pair = Annotated[Vector, rules("pair", minItems=2, maxItems=2)]
Identifier = Annotated[str, rules("identifier", pattern=IDENTIFIER)]
Id = Annotated[str, rules("id", pattern=ID)]
Crossings = Annotated[int, rules(minimum=1, maximum=100)]
PieceId = Annotated[str, rules("piece_id", pattern=PIECE)]
Line = Annotated[str, rules("line", pattern=LINE)]
Short = Annotated[str, rules("short", pattern=LINE, maxLength=60)]
Title = Annotated[str, rules("title", pattern=TITLE)]

SURFACE: Final = "symmetry-breaking-surface"
CLAIMS = ("arc", "symmetric-arc", "symmetric-loop", "loop", SURFACE)
PERIODIC_CURVES = ("periodic-arc", "periodic-loop")
EQUILIBRIUM_CURVES = ("equilibrium-arc", "equilibrium-loop")
