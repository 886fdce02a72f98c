"""The inequalities of a stored part of a surface, from the enclosures that it carries (sections 8, 9, 17.2).

A result says for each part of an interval what the hypotheses were found to be. Here they are compared with zero and
with the radii once more, so that a part whose enclosures show nothing does not count.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import SurfacePiece
from orbitproof.verify.evidence import exact_value, excludes_zero, is_inside, quoted_name, sign
from orbitproof.verify.surface.proved_parts import ProvedPart

_NAMES = ("poincare-map", "HC2", "HC3", "HC4", "point", "dH/dp_0", "h_fp'", "h_b''")
"""The hypotheses with enclosures, in order."""

_NOT_ZERO = {
    "HC2": "d q_2(P^1) / d p_2",
    "HC3": "g_0",
    "HC4": "G_01 + G_11 p_1'",
    "dH/dp_0": "dH/dp_0",
    "h_fp'": "h_fp'",
    "h_b''": "h_b''",
}

_INSIDE = {"HC2": {"p_2^H": 2, "p_1(P_0)": 1}, "HC3": {"p_0(P_1)": 0}, "point": {"p_0": 0, "p_1": 1, "p_2": 2}}
"""Which enclosures lie inside which P_i."""


def unshown(piece: SurfacePiece, part: ProvedPart) -> Iterator[str]:
    """What the enclosures of a stored part do not show, or say twice in different ways; nothing if all is well."""
    found = part.enclosures
    if tuple(found) != _NAMES:
        yield f"the hypotheses are {', '.join(map(quoted_name, found))}, not {', '.join(_NAMES)}"
        return
    try:
        for name, key in _NOT_ZERO.items():
            if not excludes_zero(found[name][key]):
                yield f"{name}: {key} may be zero"
        for name, inside in _INSIDE.items():
            for key, i in inside.items():
                if not is_inside(found[name][key], piece.radii[i]):
                    yield f"{name}: {key} is not inside P_{i}"
        shown = [found["point"][f"p_{i}"] for i in range(len(piece.radii))]
        if list(map(_ends, part.point)) != list(map(_ends, shown)):
            yield "the point is not that of the hypothesis"
        side = {1: "above", -1: "below"}.get(sign(found["h_b''"]["h_b''"]))
        if part.side != side:
            yield f"the side is {part.side!r}, h_b'' says {side!r}"
    except KeyError as error:
        yield f"an enclosure is missing: {error}"


def _ends(ball: arb) -> tuple[Fraction, Fraction]:
    return exact_value(ball.mid()), exact_value(ball.rad())
