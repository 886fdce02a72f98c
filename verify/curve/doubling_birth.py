"""Curves whose orbits are born at a period doubling, and how they end there (section 16.14)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import HILL, HILL_VARIED
from orbitproof.verify.curve.bifurcations_on_it import Bifurcation, CertifiedPoint, PlaceOnCurve, entry_of, locate
from orbitproof.verify.curve.birth_piece import Birth, tube_of_birth
from orbitproof.verify.curve.doubled_family import HEIGHT, MASS, doubling_with_variation
from orbitproof.verify.curve.followed import Follow
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.curve.piece_result import IntervalResult
from orbitproof.verify.evidence import Checklist, Evidence, enclose, exact_value, excludes_zero, power

SHARE = Fraction(33, 32)
"""So much farther from the birth than the end of the curve is the orbit that is compared: a little inside the curve."""


def check_birth_at_doubling(
    checklist: Checklist, atlas: Atlas, chain: Chain, results: Sequence[IntervalResult], follow: Follow
) -> Birth:
    """Hypothesis `birth` (16.14): an orbit of the piece at which those of the curve are born is one of the curve.

    Raises `NotEstablishedError` if that is not shown.
    """
    statement = "the piece of the birth is proved, and an orbit of it is one of the curve"
    remedy = "let the curve end where that piece reaches, in a wider tube, or give a wider one"
    with checklist.hypothesis("birth", "16.14", statement, remedy) as evidence:
        found = _birth_at_end(evidence, atlas, chain, results, follow)
    assert found is not None
    return found


def _birth_at_end(
    evidence: Evidence, atlas: Atlas, chain: Chain, results: Sequence[IntervalResult], follow: Follow
) -> Birth | None:
    """An orbit of the piece of the birth that is one of the curve; else `None`, with why in `evidence`."""
    tube = tube_of_birth(evidence, atlas, results)
    if tube is None:
        return None
    last = chain.stretches[-1]
    end = dict(zip(atlas.system.centre_coordinates, last.tube.point(last.run, last.leaves), strict=True))
    crossings = follow(atlas.system, atlas.parameters, end, 1)
    if crossings is None:
        evidence.require(False, "the orbit at the end of the curve is not enclosed")
        return None
    local = tube.local(crossings[0].state)
    # The first crossing is the middle of one half orbit; its image under R is that of the one which leads back.
    near = None if local is None or not local[0].is_finite() else -SHARE * exact_value(local[0].mid())
    if near is None or not 0 < abs(near) < tube.proved.end:
        evidence.require(False, "the piece of the birth does not reach it")
        return None
    back = follow(atlas.system, atlas.parameters, tube.states(enclose(near)), 1)
    if back is None:
        evidence.require(False, f"the orbit at s = {float(near):.6g} of the piece of the birth is not enclosed")
        return None
    place = locate(atlas, chain, [back[0].state[name] for name in atlas.system.centre_coordinates])
    evidence.require(
        isinstance(place, PlaceOnCurve), f"of the orbit at s = {float(near):.6g} of the piece of the birth: {place}"
    )
    if not isinstance(place, PlaceOnCurve):
        return None
    evidence.record(f"s of that orbit in piece {place.piece}", place.s)
    return Birth(tube, enclose(near))


def place_doubling_at_birth(birth: Birth, certified: CertifiedPoint, follow: Follow) -> Bifurcation:
    """Whether the point of a certificate is the period doubling at which the orbits of the curve are born (16.17)."""
    entry = entry_of(certified)
    if entry.reason:
        return entry
    varied = doubling_with_variation(certified, follow)
    if isinstance(varied, str):
        return entry.found(varied)
    crossings = follow(HILL_VARIED, {}, varied, 1)
    if crossings is None:
        return entry.found("the variation along its orbit is not enclosed")
    state, direction = _at_other_point(varied[MASS], crossings[0].state)
    local = birth.tube.at_birth(_from_hill_units(varied[MASS], state), direction)
    if local is not None and birth.tube.contains(arb(0), local):
        return entry.found(PlaceOnCurve(birth.tube.piece.id, arb(0), False))
    return entry.found("it lies beside the tube of the piece of the birth")


def _at_other_point(h: arb, state: Mapping[str, arb]) -> tuple[dict[str, arb], dict[str, arb]]:
    """P(x), and the coordinates of DP(x) v that R negates: those of the variation less the field's part."""
    at = {name: state[name] for name in HILL.state}
    field = dict(zip(HILL.state, HILL.program.evaluate([*at.values(), h], enclose, power), strict=True))
    if not excludes_zero(at["veta"]):
        return at, {"vx": arb("nan"), "vz": arb("nan")}
    time = state["deta"] / at["veta"]
    return at, {"vx": state["dvxi"] - time * field["vxi"], "vz": state["dvzeta"] - time * field["vzeta"]}


def _from_hill_units(h: arb, at: Mapping[str, arb]) -> dict[str, arb]:
    """(x, z, vy) of a point (xi, zeta, veta) by 17.1."""
    return {"x": 1 - h * h * h + h * at["xi"], "z": h * at[HEIGHT], "vy": h * at["veta"]}
