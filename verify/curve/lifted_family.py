"""What curves of `shared.systems.LIFTED` say about the CR3BP: axial families from birth to birth (16.10 to 16.13)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import Atlas
from orbitproof.shared.systems import AXIAL, CR3BP, CR3BP_AXIAL, LIFTED
from orbitproof.verify.curve.bifurcations_on_it import Bifurcation, CertifiedPoint, PlaceOnCurve, entry_of, locate
from orbitproof.verify.curve.birth_piece import Birth, tube_of_birth
from orbitproof.verify.curve.followed import Follow
from orbitproof.verify.curve.gluing import Chain
from orbitproof.verify.curve.other_point import meets_section_once
from orbitproof.verify.curve.piece_result import IntervalResult
from orbitproof.verify.evidence import Checklist, Evidence, all_finite, enclose, is_positive, power

SIZE = "eps2"
"""The family parameter: the square of the speed across the plane with which an orbit leaves the axis."""

ACROSS_PLANE = "S"
"""The symmetry z -> -z of the CR3BP."""

_SIGNS = dict(zip(CR3BP.state, CR3BP.symmetries[ACROSS_PLANE], strict=True))
_NOT_FIRST = "the variation out of the plane is not shown to vanish first at the end of its half orbit"
_OF_VERTICAL = 2
"""How often half orbits of vertical orbits meet the section y = 0."""


def check_from_plane(checklist: Checklist, atlas: Atlas) -> None:
    """Hypothesis `from-plane` (16.10): eps2 increases along the curve, from 0 or less."""
    statement = "eps2 increases along the curve from 0 or less, and half orbits meet the plane once"
    with checklist.hypothesis(
        "from-plane", "16.10", statement, "claim it, in an arc that begins in the plane"
    ) as found:
        covers = atlas.claim.covers
        found.require(atlas.claim.is_arc and atlas.claim.crossings == 1, "it is no arc of first returns")
        from_rest = SIZE in atlas.claim.increasing and covers is not None and covers.coordinate == SIZE
        found.require(
            from_rest and covers is not None and covers.start <= 0 < covers.end, "the claim does not say the former"
        )


def check_birth(
    checklist: Checklist, atlas: Atlas, chain: Chain, results: Sequence[IntervalResult], follow: Follow
) -> Birth:
    """Hypothesis `birth` (16.12): the end of the curve lies in the piece at which its orbits are born.

    Raises `NotEstablishedError` if that is not shown.
    """
    statement = "the piece of the birth is proved, and the orbit at the end of the curve is one of it"
    remedy = "let the curve end where that piece reaches, or give a wider one"
    with checklist.hypothesis("birth", "16.12", statement, remedy) as evidence:
        found = _birth_at_end(evidence, atlas, chain, results, follow)
    assert found is not None
    return found


def _birth_at_end(
    evidence: Evidence, atlas: Atlas, chain: Chain, results: Sequence[IntervalResult], follow: Follow
) -> Birth | None:
    """The place of the orbit at the end of the curve in the piece of the birth; else `None`, with why in `evidence`."""
    tube = tube_of_birth(evidence, atlas, results)
    if tube is None:
        return None
    last = chain.stretches[-1]
    end = dict(zip(LIFTED.centre_coordinates, last.tube.point(last.run, last.leaves), strict=True))
    if not is_positive(end[SIZE]):
        evidence.require(False, "the curve is not shown to end out of the plane")
        return None
    start = {"x": end["x"], "vy": end["vy"], "vz": end[SIZE].sqrt()}
    crossings, lifted = follow(CR3BP_AXIAL, atlas.parameters, start, 2), follow(LIFTED, atlas.parameters, end, 1)
    if crossings is None or lifted is None:
        evidence.require(False, "the orbit at the end of the curve is not enclosed")
        return None
    (middle, other), half_period = crossings, lifted[0].time
    evidence.record("half period at the end", half_period)
    evidence.record("time of the second crossing of y = 0", other.time)
    same = meets_section_once(CR3BP_AXIAL, _exactly(atlas.parameters), other.state, other.time - half_period)
    evidence.require(same, "it is not shown to be on the axis again at its second crossing of y = 0")
    for mirrored in (False, True):
        local = tube.local(_mirrored(middle.state) if mirrored else middle.state)
        if local is not None and tube.contains(*local):
            evidence.record("s in the piece of the birth", local[0])
            return Birth(tube, local[0], mirrored)
    evidence.require(False, "it lies beside the tube of that piece")
    return None


def _mirrored(values: Mapping[str, arb]) -> dict[str, arb]:
    return {name: _SIGNS[name] * value for name, value in values.items()}


def _exactly(parameters: Mapping[str, Fraction]) -> dict[str, arb]:
    return {name: enclose(value) for name, value in parameters.items()}


def place_birth(
    atlas: Atlas, chain: Chain | None, birth: Birth | None, certified: CertifiedPoint, follow: Follow
) -> Bifurcation:
    """Whether the point of a certificate is one of those at which the orbits of the curve are born (16.13)."""
    entry = entry_of(certified)
    if entry.reason:
        return entry
    if chain is None:
        return replace(entry, reason="the curve itself is not proved")
    if certified.loses_reversor:
        return entry.found(_at_vertical_orbit(birth, certified))
    elif certified.breaks_symmetry:
        found: PlaceOnCurve | str = "it is no birth of axial orbits"
        for carried in _carried(certified, follow, atlas.parameters):
            entry, found = replace(entry, point=carried), locate(atlas, chain, list(carried.values()))
            if isinstance(found, PlaceOnCurve):
                found = found if _vanishes_first(atlas.parameters, carried, follow) else _NOT_FIRST
                break
    else:
        found = "only orbits at which those of the curve are born are looked for"
    return entry.found(found)


def _carried(certified: CertifiedPoint, follow: Follow, parameters: Mapping[str, Fraction]) -> Iterator[dict[str, arb]]:
    """The two points of a certified birth at a planar orbit by the coordinates of the curve (Lemma 16.13)."""
    breaks = certified.reversor == AXIAL and certified.symmetry == ACROSS_PLANE and certified.crossings == 1
    if not breaks or certified.signs != CR3BP.symmetries[ACROSS_PLANE] or not {"x", "vy"} <= set(certified.point):
        return
    at = {"x": certified.point["x"], "vy": certified.point["vy"]}
    yield {SIZE: arb(0), **at}
    other = follow(CR3BP_AXIAL, parameters, {**at, "vz": arb(0)}, 1)
    if other is not None:
        yield {SIZE: arb(0), **{name: other[0].state[name] for name in at}}


def _vanishes_first(parameters: Mapping[str, Fraction], point: Mapping[str, arb], follow: Follow) -> bool:
    """Whether the variation out of the plane vanishes first where the planar orbit is on the axis again."""
    at = {"x": point["x"], "vy": point["vy"]}
    planar = follow(CR3BP_AXIAL, parameters, {**at, "vz": arb(0)}, 1)
    lifted = follow(LIFTED, parameters, point, 1)
    if planar is None or lifted is None:
        return False
    known = {**_exactly(parameters), SIZE: arb(0)}
    return meets_section_once(LIFTED, known, lifted[0].state, lifted[0].time - planar[0].time)


def _at_vertical_orbit(birth: Birth | None, certified: CertifiedPoint) -> PlaceOnCurve | str:
    """The place of a certified loss of R on a vertical orbit, or why it is none of the curve (Lemma 16.14)."""
    if birth is None:
        return "the curve has no piece of a birth"
    if certified.crossings != _OF_VERTICAL or certified.reversor is not None:
        return "its half orbits do not meet the section twice"
    if ACROSS_PLANE not in certified.shifted_by or certified.direction is None:
        return "it is not shown that z -> -z shifts its orbit by half the period"
    point, direction = certified.point, certified.direction
    if not ({"x", "z", "vy"} <= set(point) and {"vx", "vz"} <= set(direction)):
        return "the certificate does not have all coordinates of the point"
    for mirrored in (False, True):
        at, off = (_mirrored(point), _mirrored(direction)) if mirrored else (point, direction)
        local = birth.tube.at_birth(at, off)
        if local is not None and birth.tube.contains(arb(0), local):
            return PlaceOnCurve(birth.tube.piece.id, arb(0), mirrored)
    return "it lies beside the tube of the piece of the birth"


def lifted_jacobi_constant(parameters: Mapping[str, Fraction], point: Mapping[str, arb]) -> arb:
    """The Jacobi constant at a point (eps2, x, vy) of a curve, or at a state, 0 what is not named."""
    integral, zero = CR3BP.first_integral_program, arb(0)
    assert integral is not None
    state = [point.get(name, zero) for name in CR3BP.state]
    (value,) = integral.evaluate([*state, enclose(parameters["mu"])], enclose, power)
    level = arb(value) - point.get(SIZE, zero)
    return level if all_finite([level]) else arb(float("nan"))
