"""What the results of an atlas give together: a curve with its bifurcations and resonances, or a surface."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from orbitproof.shared.formats import Atlas
from orbitproof.verify.certificate import Certificate, Recheck
from orbitproof.verify.curve import conclude
from orbitproof.verify.stability import with_complete_list
from orbitproof.verify.surface import conclude_surface


def conclusion_of(
    atlas: Atlas,
    results: Sequence[Mapping[str, Any]],
    bifurcations: Sequence[Certificate],
    examine: Callable[[Certificate], Recheck],
    order: int | None,
) -> dict[str, Any]:
    """The conclusion as JSON.

    Args:
        bifurcations: certificates that are looked for on a curve.
        examine: checks such a certificate again.
        order: with one, all resonances on a curve up to it as well.
    """
    if atlas.is_surface:
        return conclude_surface(atlas, results).to_json()
    conclusion = conclude(atlas, results, bifurcations, examine)
    return conclusion.to_json() if order is None else with_complete_list(atlas, results, conclusion, order)
