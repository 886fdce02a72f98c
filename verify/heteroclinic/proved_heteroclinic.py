"""A transverse heteroclinic orbit: two orbits with their manifolds, and where these meet (sections 41.2 to 41.5)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

from flint import arb

from orbitproof.shared.claims.heteroclinic import HeteroclinicOrbit
from orbitproof.shared.claims.homoclinic import HomoclinicOrbit
from orbitproof.shared.stored import stored
from orbitproof.verify.evidence import (
    Checklist,
    Evidence,
    Outcome,
    concluded,
    enclose,
    excludes_zero,
    is_inside,
    is_outside,
    is_positive,
    power,
    show,
    symmetric,
)
from orbitproof.verify.homoclinic import (
    HomoclinicEnclosures,
    Way,
    along_manifold,
    check_end,
    check_homoclinic_exactly,
    enclose_homoclinic,
    width_of_sliver,
)
from orbitproof.verify.maps import FramingOracle
from orbitproof.verify.newton import is_regular, newton_image
from orbitproof.verify.poincare import IntegratorSettings

OF_END = ("return-map", "periodic", "cone", "arrival")


@dataclass(frozen=True)
class HeteroclinicEnclosures:
    """What one proof is evaluated from, for the orbit from which the heteroclinic orbit comes and the other one.

    Attributes:
        returned: where the boxes come back.
        arrived: where the slivers arrive, their variables counted from their middles.
        order: degree of the time expansions.
        precision: bits of the fixed-point format.
        steps: number of integration steps.
        coordinates: in which the orbits were followed.
    """

    returned: tuple[Way, Way]
    arrived: tuple[Way, Way]
    order: int = stored(hidden=True, default=0)
    precision: int = stored(hidden=True, default=0)
    steps: int = stored(hidden=True, default=0)
    coordinates: str = stored(hidden=True, default="physical")


@dataclass(frozen=True)
class End:
    """What is known of one of the two periodic orbits, and of its unstable manifold.

    Attributes:
        point: the coordinate p of its point on Fix(R), by name.
        period: of the orbit.
        multiplier: the one of absolute value above 1.
        passage: a at the point of the graph over the interval whose orbit is the heteroclinic one, or its mirror image.
        time: from there to where the manifolds meet.
        slopes: derivatives of p and of q there, along the unstable manifold, by a.
    """

    point: Mapping[str, arb]
    period: arb
    multiplier: arb
    passage: arb
    time: arb
    slopes: tuple[arb, arb]


@dataclass(frozen=True)
class HeteroclinicResults:
    """What is known of a proved heteroclinic orbit and of its periodic orbits, in the units of the system.

    Attributes:
        ends: of the orbit from which it comes, and of the one to which it tends.
        meeting: p, q and w of its point in the section at which the manifolds meet, by name.
    """

    ends: tuple[End, End]
    meeting: Mapping[str, arb]


@dataclass(frozen=True)
class HeteroclinicTheorem:
    """A transverse heteroclinic orbit leads from one periodic orbit of a claim to the other (Theorem 41.3)."""

    claim: HeteroclinicOrbit

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        ends = (f"{name}-{number}" for number in (1, 2) for name in OF_END)
        return "symmetries", "level", *ends, "distinct", "sheet", "heteroclinic"


class _OfEnd(Checklist):
    """The list, on which hypotheses about one end have its number."""

    def __init__(self, whole: Checklist, number: int) -> None:
        self.hypotheses, self.number = whole.hypotheses, number

    @contextmanager
    def hypothesis(self, name: str, section: str, statement: str, remedy: str) -> Iterator[Evidence]:
        """As in `Checklist`."""
        told = f"of periodic orbit {self.number}: {statement}"
        with super().hypothesis(f"{name}-{self.number}", section, told, remedy) as evidence:
            yield evidence


def enclose_heteroclinic(
    claim: HeteroclinicOrbit,
    settings: IntegratorSettings,
    oracle: FramingOracle,
    progress: Callable[[float], None] | None = None,
) -> HeteroclinicEnclosures:
    """Follow both boxes through one return, and both slivers to their arrival (section 41.2).

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """

    def report(number: int) -> Callable[[float], None]:
        return lambda share: None if progress is None else progress((number + share) / 2)

    first, second = (enclose_homoclinic(end, settings, oracle, report(i)) for i, end in enumerate(claim.ends))
    return HeteroclinicEnclosures(
        (first.returned, second.returned),
        (first.arrived, second.arrived),
        first.order,
        first.precision,
        first.steps + second.steps,
    )


def check_heteroclinic_exactly(checklist: Checklist, claim: HeteroclinicOrbit) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    # The ends have the system, R, the section, w and the level in common.
    check_homoclinic_exactly(checklist, claim.ends[0])


def prove_heteroclinic(
    claim: HeteroclinicOrbit, checklist: Checklist, enclosures: HeteroclinicEnclosures | None
) -> Outcome[HeteroclinicResults]:
    """Check that there is an orbit as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> HeteroclinicResults:
        found, wheres, multipliers = [], [], []
        ways_of = [] if enclosures is None else list(zip(enclosures.returned, enclosures.arrived, strict=False))
        for number, end in enumerate(claim.ends):
            given = HomoclinicEnclosures(*ways_of[number]) if number < len(ways_of) else None
            way, where, multiplier = check_end(_OfEnd(checklist, number + 1), end, given)
            found.append(way)
            wheres.append(where)
            multipliers.append(multiplier)
        _check_distinct(checklist, claim, [each.returned for each in found], wheres)
        ways = [each.arrived for each in found]
        _check_sheet(checklist, claim, ways)
        changes = _check_meeting(checklist, claim, ways)
        slivers = [[a, symmetric(width_of_sliver(end))] for a, end in zip(changes, claim.ends, strict=True)]
        ends = [
            End(
                {end.along: enclose(end.centre[0]) + where[0] + where[1]},
                each.returned.time.value(where),
                multiplier,
                enclose(end.centre[1]) + sliver[0],
                each.arrived.time.value(sliver),
                (along_manifold(end, each.arrived.first), along_manifold(end, each.arrived.second)),
            )
            for end, each, where, multiplier, sliver in zip(
                claim.ends, found, wheres, multipliers, slivers, strict=True
            )
        ]
        end, way_to = claim.ends[0], ways[0]
        names = (end.along, end.across, end.level_coordinate)
        at = (function.value(slivers[0]) for function in (way_to.first, way_to.second, way_to.w))
        return HeteroclinicResults((ends[0], ends[1]), dict(zip(names, at, strict=True)))

    return concluded(HeteroclinicTheorem(claim), checklist, check)


def _check_distinct(checklist: Checklist, claim: HeteroclinicOrbit, found: list[Way], wheres: list[list[arb]]) -> None:
    """The periodic orbits are two."""
    statement = (
        "the periodic orbits differ in period by number of crossings; or one crosses the section twice in a period, "
        "and their points on Fix(R) differ though the section is crossed there in one direction"
    )
    remedy = "give another periodic orbit, or of one its other point on Fix(R)"
    with checklist.hypothesis("distinct", "41.3", statement, remedy) as evidence:
        periods = [way.time.value(where) for way, where in zip(found, wheres, strict=True)]
        for number, period in enumerate(periods, start=1):
            evidence.record(f"period {number}", period)
        first, second = claim.returns
        differ = excludes_zero(second * periods[0] - first * periods[1])
        points, rates = [], []
        for number, (end, way, where) in enumerate(zip(claim.ends, found, wheres, strict=True), start=1):
            p, w = enclose(end.centre[0]) + where[0] + where[1], way.w.value(where)
            points.append(evidence.record(f"p {number}", p))
            rates.append(evidence.record(f"rate {number}", _rate(end, p, w)))
        apart = excludes_zero(points[0] - points[1]) or claim.level_sign[0] != claim.level_sign[1]
        differ = differ or (2 in claim.returns and is_positive(rates[0] * rates[1]) and apart)
        evidence.require(differ, "they may be one", needs_precision=True)


def _rate(end: HomoclinicOrbit, p: arb, w: arb) -> arb:
    """The derivative of the section's coordinate by time at a point of Fix(R)."""
    names = end.system.state
    at = {end.along: p, end.level_coordinate: w, end.across: arb(0), end.section: arb(0)}
    values = map(enclose, end.values)
    rates = end.system.program.evaluate([*(at[name] for name in names), *values], enclose, power)
    rate: arb = rates[names.index(end.section)]
    return rate


def _check_sheet(checklist: Checklist, claim: HeteroclinicOrbit, found: list[Way]) -> None:
    """All points that the slivers reach lie where w has one sign."""
    statement = "where both slivers arrive w has one sign, the same at all points"
    remedy = "let one sliver be followed to one crossing more, and the other to one less"
    with checklist.hypothesis("sheet", "41.4", statement, remedy) as evidence:
        values = []
        for number, (end, way) in enumerate(zip(claim.ends, found, strict=True), start=1):
            sliver = [symmetric(end.radii[1]), symmetric(width_of_sliver(end))]
            values.append(evidence.record(f"w {number}", way.w.value(sliver)))
        evidence.require(is_positive(values[0] * values[1]), "it may not", needs_precision=True)


def _check_meeting(checklist: Checklist, claim: HeteroclinicOrbit, found: list[Way]) -> list[arb]:
    """The one pair of points of the intervals at which the manifold meets the mirror image of the other one."""
    statement = (
        "interval Newton: along the unstable manifolds, over the intervals, exactly one pair of arrivals are mirror "
        "images of each other"
    )
    remedy = "move the intervals to the heteroclinic orbit, or choose smaller ones or smaller cones"
    with checklist.hypothesis("heteroclinic", "41.4", statement, remedy) as evidence:
        slopes, values = [], []
        for number, (end, way) in enumerate(zip(claim.ends, found, strict=True), start=1):
            slopes.append([along_manifold(end, each) for each in (way.first, way.second)])
            for name, slope in zip("pq", slopes[-1], strict=True):
                evidence.record(f"d{name}/da {number}", slope)
            width = symmetric(width_of_sliver(end))
            values.append([each.centre + each.slopes[1] * width for each in (way.first, way.second)])
        matrix = [[slopes[0][0], -slopes[1][0]], [slopes[0][1], slopes[1][1]]]
        evidence.require(is_regular(matrix), "the manifolds may be tangent", needs_precision=True)
        changes = newton_image(matrix, [values[0][0] - values[1][0], values[0][1] + values[1][1]])
        for number, (change, end) in enumerate(zip(changes, claim.ends, strict=True), start=1):
            evidence.record(f"a, from the middle {number}", change)
            radius = end.radii[1]
            outside = is_outside(change, radius)
            message = f"a of periodic orbit {number} is in {show(change)}, not inside the interval"
            evidence.require(is_inside(change, radius), message, needs_precision=not outside, excluded=outside)
        evidence.require(len(changes) == 2, "an equation is missing")
    return changes
