"""The theorem about a curve, with certificates as they come from a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from support.stored import values

from orbitproof.shared.formats import Atlas
from orbitproof.verify.branches.certified import Examine, certified_point
from orbitproof.verify.branches.curve_conclusion import partner as partner_here
from orbitproof.verify.branches.curve_conclusion import told_list
from orbitproof.verify.certificate import Certificate, recheck
from orbitproof.verify.curve import Conclusion, Partner, ProvedCurve
from orbitproof.verify.curve import conclude as conclude_of_points
from orbitproof.verify.lasting import conclude_lasting
from orbitproof.verify.stability import conclude_list


def conclude(
    atlas: Atlas,
    results: Sequence[Mapping[str, Any]],
    certificates: Sequence[Certificate] = (),
    examine: Examine = recheck,
    partner: Partner = partner_here,
) -> Conclusion[ProvedCurve]:
    """See `curve.conclude`."""
    points = [certified_point(atlas, entry, examine) for entry in certificates]
    return conclude_of_points(atlas, values(results), points, partner)


def with_complete_list(
    atlas: Atlas,
    results: Sequence[Mapping[str, Any]],
    curve: Conclusion[ProvedCurve],
    order: int,
    combinations: bool = False,
) -> dict[str, Any]:
    """The conclusion with the list of an order, as JSON."""
    return told_list(conclude_list(atlas, values(results), curve, order, combinations))


def with_lasting(atlas: Atlas, results: Sequence[Mapping[str, Any]], order: int = 4) -> dict[str, Any]:
    """The conclusion with the list, and which orbits are stable for ever, as JSON."""
    found: Any = values(results)
    return told_list(conclude_lasting(atlas, found, conclude_list(atlas, found, conclude(atlas, results), order)))
