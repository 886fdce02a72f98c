"""What curves of `shared.systems.HILL_VARIED` say about the CR3BP: period doublings over the mass (section 15.10)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import HILL, HILL_VARIED
from orbitproof.verify.curve.bifurcations_on_it import LACKS_COORDINATES, Bifurcation, CertifiedPoint, entry_of, locate
from orbitproof.verify.curve.followed import Follow
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.evidence import Checklist, all_finite, enclose
from orbitproof.verify.newton import is_regular, newton_image

MASS, HEIGHT = "h", "zeta"
"""The family parameter, the third root of the mass, and the coordinate across the plane."""

VARIED = [f"d{HILL.state[i]}" for i in HILL.fixed_coordinates]
"""The coordinates of the variation that R leaves alone; the last one is 1 where orbits start."""


def check_doubled(checklist: Checklist, atlas: Atlas, chain: Chain) -> None:
    """Hypothesis `doubled` (15.10): one orbit off the plane for each mass, known by its first return."""
    statement = f"{MASS} increases along an arc of first returns, and {HEIGHT} has one sign on it"
    with checklist.hypothesis("doubled", "15.10", statement, "claim that, in narrower tubes") as evidence:
        claim, index = atlas.claim, HILL_VARIED.centre_coordinates.index(HEIGHT)
        evidence.require(claim.is_arc and claim.crossings == 1, "it is no arc of first returns")
        evidence.require(MASS in claim.increasing, f"the claim does not say that {MASS} increases")
        side = 1 if chain.stretches[0].tube.piece.centre[index] > 0 else -1
        for stretch in chain.stretches:
            holds = stretch.tube.coordinate_is_beyond_zero(index, side, stretch.run, stretch.enters, stretch.leaves)
            evidence.require(holds, f"{HEIGHT} is not shown to keep its sign on piece {stretch.tube.piece.id}")


def place_doubling(atlas: Atlas, chain: Chain | None, certified: CertifiedPoint, follow: Follow) -> Bifurcation:
    """Whether the point of a certificate is a period doubling of the curve (Lemma 15.8)."""
    entry = entry_of(certified)
    if entry.reason:
        return entry
    if chain is None:
        return replace(entry, reason="the curve itself is not proved")
    carried = doubling_with_variation(certified, follow)
    return entry.found(carried if isinstance(carried, str) else locate(atlas, chain, list(carried.values())))


def doubling_with_variation(certified: CertifiedPoint, follow: Follow) -> dict[str, arb] | str:
    """A certified period doubling by the coordinates of `HILL_VARIED` (Lemma 15.8), or why there are none."""
    if (certified.kind, certified.k, certified.crossings) != ("period_tupling", 2, 1):
        return "only period doublings of first returns are looked for"
    if not {"x", "z", "vy"} <= set(certified.point):
        return LACKS_COORDINATES
    orbit = in_hill_units(certified.parameters["mu"], certified.point)
    direction = _kernel(orbit, follow)
    return direction if isinstance(direction, str) else {**orbit, **direction}


def in_hill_units(mu: Fraction, point: Mapping[str, arb]) -> dict[str, arb]:
    """(h, xi, zeta, veta) of a point (x, z, vy) of the CR3BP, by 17.1."""
    h = enclose(mu).root(3)
    return {MASS: h, "xi": (point["x"] - 1 + enclose(mu)) / h, HEIGHT: point["z"] / h, "veta": point["vy"] / h}


def _kernel(orbit: Mapping[str, arb], follow: Follow) -> dict[str, arb] | str:
    """(dxi, dzeta) of the variation with dveta = 1 that arrives in what R negates, if there is one; or why not."""
    columns = []
    for start in ((0, 0), (1, 0), (0, 1)):
        point = {**orbit, **{name: arb(value) for name, value in zip(VARIED, start, strict=False)}}
        crossings = follow(HILL_VARIED, {}, point, 1)
        if crossings is None:
            return "the variations along its orbit are not enclosed"
        columns.append([crossings[0].state[name] for name in VARIED])
    offset, *others = columns
    rows = [[column[i] - offset[i] for column in others] for i in range(len(VARIED))]
    for chosen in combinations(range(len(VARIED)), len(others)):
        matrix = [rows[i] for i in chosen]
        if is_regular(matrix):
            found = newton_image(matrix, [offset[i] for i in chosen])
            if all_finite(found):
                return dict(zip(VARIED, found, strict=False))
    return "the variation that its multiplier -1 belongs to is not enclosed"
