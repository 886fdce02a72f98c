"""Where certified orbits lie on a curve that is proved (section 15.8)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from orbitproof.shared.formats import Atlas
from orbitproof.verify.atlas.certificate import AtlasCertificate
from orbitproof.verify.atlas.conclusion import conclusion_of
from orbitproof.verify.atlas.recheck import Means, order_of, recheck_atlas
from orbitproof.verify.certificate import Certificate, recheck
from orbitproof.verify.curve import conclude
from orbitproof.verify.evidence import interval_text

_DIGITS = 18


def places_on(curve: AtlasCertificate, orbits: Sequence[Certificate]) -> list[str]:
    """For each certified orbit a line: on which piece of the curve it lies, with its s; or that this is not shown.

    The certificate of the curve is checked up to its conclusion first, and so is each orbit's.
    """
    name = curve.document["id"]
    if curve.atlas.is_surface:
        return [f"{orbit.id}: not shown to lie on {name}: that is no curve but a surface" for orbit in orbits]
    order = order_of(curve.document)

    def again(atlas: Atlas, results: Sequence[Mapping[str, Any]], entries: Sequence[Certificate]) -> Mapping[str, Any]:
        return conclusion_of(atlas, results, entries, recheck, order)

    examined = recheck_atlas(curve.document, (), False, Means(again, _nothing, _nothing))
    if not (curve.is_proved and examined.stands):
        why = examined.findings[0].message if examined.findings else examined.obstacle or "it is not proved"
        return [f"{orbit.id}: not shown to lie on {name}: its certificate does not stand: {why}" for orbit in orbits]
    lines = []
    for entry in conclude(curve.atlas, curve.results, orbits).bifurcations:
        if entry.place is None:
            lines.append(f"{entry.id}: not shown to lie on {name}: {entry.reason}")
            continue
        which = "its other point on Fix(R) lies" if entry.place.other_point else "lies"
        mirror = " (as its mirror image)" if entry.place.mirrored else ""
        s = interval_text(entry.place.s, _DIGITS)
        lines.append(f"{entry.id}: {which} on the proved curve {name}{mirror}, piece {entry.place.piece}, s in {s}")
    return lines


def _nothing(*_: Any) -> Any:
    raise ValueError("nothing is integrated here")
