"""Theorems about curves, lists, surfaces, webs and indices, made and not proved: all that may be said of them."""

from __future__ import annotations

from dataclasses import astuple, replace
from fractions import Fraction as Q
from itertools import product
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from flint import arb
from support.birth_cases import circles_born
from support.box_sentences import Told, ball, points
from support.equilibrium_cases import circle_of_equilibria
from support.life_cases import claim as life_claim
from support.life_cases import rest_atlas
from support.metamorphic_cases import CURVES
from support.periodic_cases import LOCKED
from support.springs import SPRINGS

from orbitproof.shared.claims import Claim, Covers
from orbitproof.shared.claims.life import BEGINS, LifeArc, LifeJoint
from orbitproof.shared.claims.life import ENDS as ENDS_ON
from orbitproof.shared.claims.web import BRANCHES, ENDS, PASSES, Meeting, Web, WebArc
from orbitproof.shared.formats import Atlas, BirthAtlas, EquilibriumAtlas, PeriodicAtlas, define_system, read_atlas
from orbitproof.shared.systems import AROUND, AXIAL, CR3BP, CR3BP_PLANAR, VERTICAL, FixedLevel
from orbitproof.verify.birth_curve import BirthCurveTheorem, ProvedBirthCurve
from orbitproof.verify.curve import (
    Bifurcation,
    Conclusion,
    CurveTheorem,
    PlaceOnCurve,
    ProvedCurve,
    point_name,
    vertical_point,
)
from orbitproof.verify.distances import Ranges, Where
from orbitproof.verify.distances.ranges import Extreme
from orbitproof.verify.equilibrium import Spectrum
from orbitproof.verify.equilibrium_curve import EquilibriumCurveTheorem, Fold, ProvedEquilibriumCurve, SidedPart, Sides
from orbitproof.verify.evidence import Hypothesis, Proved
from orbitproof.verify.index import CountedOrbit, HalfTurns, IndexTheorem, Interval, ProvedIndex
from orbitproof.verify.lasting import (
    ExceptionalOrbit,
    Fate,
    LastingInterval,
    LastingTheorem,
    ProvedLasting,
    Reversibility,
)
from orbitproof.verify.lasting.fates import LastingList
from orbitproof.verify.life import Birth, Birthplace, LifeCurve, LifeTheorem, ProvedLife
from orbitproof.verify.periodic_curve import (
    Counts,
    PeriodicCurveTheorem,
    ProvedPeriodicCurve,
    Turn,
    number_of_multipliers,
)
from orbitproof.verify.periodic_curve.counted import CountedPart
from orbitproof.verify.stability import (
    Bound,
    CompleteList,
    CurveEnd,
    Extremum,
    Found,
    Gap,
    IntervalEnd,
    Kind,
    ListAcross,
    ListConclusion,
    ListTheorem,
    Matter,
    Point,
    ProvedList,
    Resonance,
    StableInterval,
)
from orbitproof.verify.stability.list_entries import Combinations
from orbitproof.verify.surface import Height, PlanarFamily, ProvedSurface, SurfaceTheorem
from orbitproof.verify.web import Arc, Incidence, IndexOnArc, Indices, KnownArc, ProvedWeb, Switch, Vertex, WebTheorem
from orbitproof.verify.words.birth_curve import birth_curve_in_words
from orbitproof.verify.words.branches import branch_in_full, conclusion_in_words
from orbitproof.verify.words.catalogue import catalogue_in_words
from orbitproof.verify.words.equilibrium_curve import equilibrium_curve_in_full, equilibrium_curve_in_words
from orbitproof.verify.words.index import index_in_words
from orbitproof.verify.words.life import life_in_words
from orbitproof.verify.words.periodic_curve import periodic_curve_in_full, periodic_curve_in_words
from orbitproof.verify.words.place import place_in_words
from orbitproof.verify.words.surface import surface_in_words
from orbitproof.verify.words.web import web_in_words

DATA = Path(__file__).parents[1] / "data"
NAN = arb(float("nan"))
NO_CHAIN: Any = SimpleNamespace(
    stretches=[SimpleNamespace(tube=SimpleNamespace(piece=SimpleNamespace(id=name))) for name in ("p001", "p002")]
)


def stored(name: str) -> Atlas:
    atlas = read_atlas(DATA / f"{name}.json")
    assert isinstance(atlas, Atlas)
    return atlas


def of_curve(name: str) -> Atlas:
    atlas = CURVES[name]().atlas
    assert isinstance(atlas, Atlas)
    return atlas


def _of(atlas: Atlas, fixed: FixedLevel | None = None, **changes: Any) -> Atlas:
    level = {} if fixed is None else {"fixed_level": fixed}
    return replace(atlas, system=replace(atlas.system, **level, **changes))


def _claiming(atlas: Atlas, **changes: Any) -> Atlas:
    return replace(atlas, claim=replace(atlas.claim, **changes))


def known_curve(atlas: Atlas, half_period: arb | None = None) -> ProvedCurve:
    """What is known of the curve of an atlas."""
    names = atlas.system.centre_coordinates
    ends = {"start": points(names, 11), "end": points(names, 21)}
    around = point_name(atlas.system) or vertical_point(atlas.system)
    births: Any = [SimpleNamespace(tube=SimpleNamespace(piece=piece)) for piece in atlas.birth_pieces()]
    half_period = ball(9) if half_period is None else half_period
    return ProvedCurve(NO_CHAIN, ends, half_period, ball(8) if around else None, births[0] if births else None)


def _proved(theorem: Any, known: Any) -> Any:
    return Proved(theorem, known, tuple(Hypothesis(name, "it is so", "1", True) for name in theorem.hypotheses))


def concluded(theorem: Any, known: Any, bifurcations: tuple[Bifurcation, ...] = ()) -> str:
    """The statement of a conclusion."""
    if isinstance(theorem, SurfaceTheorem):
        return surface_in_words(theorem, known)
    if isinstance(theorem, PeriodicCurveTheorem):
        return periodic_curve_in_words(theorem, known)
    if not isinstance(theorem, ListTheorem):
        return conclusion_in_words(Conclusion(_proved(theorem, known), bifurcations))
    curve = Conclusion(_proved(theorem.curve, known.curve), bifurcations)
    return conclusion_in_words(ListConclusion(curve, theorem.order, _proved(theorem, known)))


def told(atlas: Atlas, bifurcations: tuple[Bifurcation, ...] = (), half_period: arb | None = None) -> str:
    """The theorem about the curve of an atlas, so that it stands alone."""
    return branch_in_full(atlas, concluded(CurveTheorem(atlas), known_curve(atlas, half_period), bifurcations))


# Curves


def curves() -> Told:
    for name in ("arc", "arc-on-level", "arc-two-crossings", "symmetric-arc", "arc-with-sine", "list"):
        yield name, told(of_curve(name))
    for name in ("axial-family", "butterfly", "doublings", "fixed-level", "lyapunov", "vertical"):
        yield f"atlas-{name}", told(stored(f"atlas-{name}"))
    arc, level = of_curve("arc"), of_curve("arc-on-level")
    yield "arc / three crossings", told(_claiming(arc, crossings=3))
    yield "arc / two coordinates increase", told(_claiming(arc, increasing=("a", "u")))
    yield "arc / nothing increases", told(_claiming(arc, increasing=()))
    yield "arc / covers", told(_claiming(arc, covers=Covers("a", Q(1, 8), Q(1, 4))))
    yield "arc / half periods not known", told(arc, half_period=NAN)
    yield "arc / a loop", told(_claiming(arc, kind="loop", increasing=()))
    yield "arc / values of no parameter", told(replace(arc, parameters={}))
    for label, fixed in (
        ("positive", FixedLevel(Q(3), 1)), ("negative", FixedLevel(Q(3), -1)),
        ("between", FixedLevel(Q(3), None, (Q(1), Q(2)))),
    ):  # fmt: skip
        for name in ("energy", None):
            yield f"arc-on-level / {label}, {name}", told(_of(level, fixed, first_integral_name=name))
    circle = of_curve("symmetric-arc")
    yield "symmetric-arc / no symmetry", told(_claiming(circle, kind="arc", symmetry=None))
    yield "symmetric-arc / a loop", told(_claiming(circle, kind="symmetric-loop", increasing=()))
    names = circle.system.centre_coordinates
    for increasing in (*((name,) for name in names), names, ()):
        label = " and ".join(increasing) or "nothing"
        yield f"symmetric-arc / {label} increases", told(_claiming(circle, increasing=increasing))
        yield (
            f"symmetric-arc / a loop where {label} increases",
            told(_claiming(circle, kind="symmetric-loop", increasing=increasing)),
        )
    lyapunov = stored("atlas-lyapunov")
    for point in ("L1", "L2", "L3"):
        of_point = replace(lyapunov, system=AROUND[point])
        for start, end in (
            (Q(-1, 8), Q(1, 8)),
            (Q(0), Q(1, 8)),
            (Q(-1, 8), Q(0)),
            (Q(1, 16), Q(1, 8)),
            (Q(-1, 8), Q(-1, 16)),
        ):
            yield f"atlas-lyapunov / {point} from {start} to {end}", told(
                _claiming(of_point, covers=Covers("eps", start, end))
            )  # fmt: skip
        axis = VERTICAL[point]
        coordinate = axis.centre_coordinates[0]
        yield (
            f"atlas-vertical / {point} in units of the orbit",
            told(
                replace(
                    lyapunov, system=axis, claim=Claim("arc", None, (coordinate,), Covers(coordinate, Q(0), Q(1, 8)))
                )
            ),
        )
    yield "atlas-lyapunov / vy covers", told(_claiming(lyapunov, covers=Covers("vy", Q(-1), Q(1))))
    yield "atlas-lyapunov / covers nothing", told(_claiming(lyapunov, covers=None))
    yield "atlas-lyapunov / eps does not increase", told(_claiming(lyapunov, increasing=("vy",)))
    masses = stored("atlas-doublings")
    for covers in (None, Covers("h", Q(0), Q(1, 2)), Covers("h", Q(1, 8), Q(1, 2)), Covers("xi", Q(-1), Q(1))):
        label = "nothing" if covers is None else f"{covers.coordinate} from {covers.start}"
        yield f"atlas-doublings / covers {label}", told(_claiming(masses, covers=covers))


def places() -> Told:
    """What lies on a curve, and where."""
    at = [PlaceOnCurve(piece, s, mirrored, other) for piece, s, mirrored, other in product(
        ("p001", "s"), (arb(0), ball(1)), (False, True), (False, True)
    )]  # fmt: skip
    kinds = [
        ("symmetry_breaking", 1), ("fold", 1), ("period_tupling", 2), ("period_tupling", 3), ("touch_and_go", 3),
        ("krein_collision", 1), ("reversor_breaking", 1), ("orbit", 1), ("stable_orbit", 1),
    ]  # fmt: skip

    def entry(number: int, kind: str, k: int, place: PlaceOnCurve | None, **more: Any) -> Bifurcation:
        return Bifurcation(f"row-{number}", kind, k, place, "it is elsewhere", {}, **more)

    circle, arc = of_curve("symmetric-arc"), of_curve("arc")
    symmetric = next(piece.id for piece in circle.curve_pieces() if piece.kind == "symmetric")
    here = [replace(place, piece=symmetric) if place.piece == "s" else place for place in at]
    yield (
        "symmetric-arc / with places",
        told(
            circle,
            tuple(entry(n, "fold", 1, place, parameter=ball(n), parameter_name="h") for n, place in enumerate(here)),
        ),
    )
    of_kinds = tuple(entry(n, kind, k, at[0]) for n, (kind, k) in enumerate(kinds))
    yield "arc / with kinds", told(arc, of_kinds)
    yield (
        "arc / with kinds, parameters",
        told(arc, tuple(replace(each, parameter_name="a", parameter=ball(n)) for n, each in enumerate(of_kinds))),
    )
    hostile = of_curve("arc-two-crossings")
    yield (
        "arc-two-crossings / with a level",
        told(hostile, (entry(1, "fold", 1, at[0], parameter_name="radius", parameter=ball(1)),)),
    )
    off = tuple(entry(n, kind, k, None) for n, (kind, k) in enumerate(kinds[:3]))
    foreign = tuple(entry(n, "fold", 1, None, is_foreign=True) for n in (8, 9))
    yield "arc / with nothing on it", told(arc, off)
    yield "arc / with one of another system", told(arc, foreign[:1])
    yield "arc / with some of another system", told(arc, (*off, *foreign))
    for name in ("butterfly", "axial-family"):
        atlas = stored(f"atlas-{name}")
        born = entry(1, "period_tupling", 2, replace(at[0], piece="birth"))
        yield (
            f"atlas-{name} / with births",
            told(atlas, (born, replace(born, place=replace(at[2], piece="birth")), entry(2, "fold", 1, at[0]))),
        )
    for name, atlas in (("arc", arc), ("symmetric-arc", circle), ("atlas-lyapunov", stored("atlas-lyapunov"))):
        for place in (here[0], here[5], *((here[6], here[7]) if name == "symmetric-arc" else ())):
            label = f"{place.piece}{' mirrored' * place.mirrored}{' other point' * place.other_point}"
            yield f"an orbit on {name}, {label}", place_in_words(atlas, place, "a curve", "sha256:1")


# Lists


def _bound(number: int, *what: Any, point: Point | None = None, ranges: Ranges | None = None) -> Bound:
    return Bound(number % 2, Q(number, 16), Q(number + 1, 16), what, point, point is not None, ranges)


def _point(number: int, k: int, j: int, kind: Kind, *certificates: str) -> Point:
    return Point(0, "p001", k, j, kind, ball(number), ball(number + 1), ball(number + 2), {}, certificates)


POINTS = (
    _point(1, 1, 0, Kind.FOLD, "a-fold"), _point(2, 1, 0, Kind.LOSS), _point(3, 1, 0, Kind.SYMMETRIC, "one", "other"),
    _point(4, 1, 0, Kind.IN_PLANE), _point(5, 2, 1, Kind.HERE), _point(6, 2, 1, Kind.THERE),
    _point(7, 2, 1, Kind.UNDECIDED), _point(8, 3, 1, Kind.RESONANCE), _point(9, 4, 1, Kind.RESONANCE),
    _point(10, 5, 2, Kind.RESONANCE), _point(11, 1, 0, Kind.UNDECIDED), _point(12, 3, 1, Kind.UNDECIDED),
)  # fmt: skip
COLLISIONS = (_point(20, 0, 0, Kind.COLLISION), _point(21, 0, 0, Kind.COLLISION, "a-collision"))
COMBINED = tuple(
    _point(30 + n, 0, 0, kind) for n, kind in enumerate((Kind.TWO_TO_ONE, Kind.THREE_TO_ONE, Kind.OPPOSITE))
)
ACROSS = (
    _point(40, 1, 0, Kind.ACROSS_SYMMETRIC, "a-halo"), _point(41, 1, 0, Kind.ACROSS_AXIAL),
    _point(42, 2, 1, Kind.ACROSS_DOUBLING), _point(43, 3, 1, Kind.RESONANCE), _point(44, 3, 1, Kind.UNDECIDED),
)  # fmt: skip
GAPS = tuple(
    Gap(0, "p001", Q(n, 32), Q(n + 1, 32), subject, f"reason {n}")
    for n, subject in enumerate((Resonance(1, 0), Resonance(5, 2), *Matter))
)
EXTREMA = tuple(
    Extremum(0, "p001", ball(n), inside, ball(n + 1), ball(n + 2), ball(n + 3), ids)
    for n, inside, ids in ((50, True, ()), (60, True, ("one", "two")), (70, False, ()))
)
RANGES = Ranges(ball(3), Extreme(ball(4), Where.HERE), Extreme(ball(5), Where.THERE))
STABLE = (
    StableInterval(
        _bound(1, CurveEnd.BEGINNING), _bound(2, Found(Kind.FOLD, 1, 0), point=POINTS[0]), ("p001", "p002"), RANGES
    ),
    StableInterval(
        _bound(3, Found(Kind.HERE, 2, 1), point=POINTS[4], ranges=replace(RANGES, least=None)),
        _bound(4, Found(Kind.THERE, 2, 1), Resonance(1, 0), Matter.COLLISION), ("p002", "p002"),
        replace(RANGES, greatest=Extreme(ball(6), Where.ALONG)),
    ),
)  # fmt: skip
INNER = (STABLE[1],)
UNKNOWN = (
    StableInterval(
        _bound(5, Matter.EVERYTHING), _bound(6, Found(Kind.RESONANCE, 3, 1), CurveEnd.END), ("p001", "p002")
    ),
    StableInterval(_bound(7, Resonance(2, 1), point=POINTS[5]), _bound(8, CurveEnd.END), ("p001", "p001"), RANGES),
)  # fmt: skip
HYPOTHESIS = Hypothesis("across", "the plane is invariant", "21.1", True)
EMPTY = CompleteList(6, 1, (), (), ())


def _without_distances(entry: StableInterval) -> StableInterval:
    """Of orbits of a system that names no body."""
    begin, end = (
        replace(bound, ranges=bound.ranges and replace(bound.ranges, least=None, greatest=None))
        for bound in (entry.begin, entry.end)
    )
    ranges = entry.ranges and replace(entry.ranges, least=None, greatest=None)
    return StableInterval(begin, end, entry.pieces, ranges)


def _list(
    atlas: Atlas, found: CompleteList, stable: Any = (), unknown: Any = (), across: ListAcross | None = None
) -> str:
    if atlas.system.distance_name is None:
        stable, unknown = (tuple(map(_without_distances, entries)) for entries in (stable, unknown))
        if across is not None:
            far = (tuple(map(_without_distances, entries)) for entries in (across.stable, across.unknown))
            across = ListAcross(across.found, *far, across.jacobi_constants)
    theorem = ListTheorem(CurveTheorem(atlas), found.order)
    whole = concluded(theorem, ProvedList(known_curve(atlas), found, stable, unknown, across))
    return whole.removeprefix(concluded(theorem.curve, known_curve(atlas)))


def lists() -> Told:
    atlas, listed = replace(of_curve("list"), system=SPRINGS), replace(EMPTY, points=POINTS[:1])
    yield "a list", _list(atlas, listed, STABLE, UNKNOWN)
    yield "a list / of all kinds", _list(atlas, replace(EMPTY, points=POINTS), STABLE, UNKNOWN)
    yield "a list / of nothing", _list(atlas, EMPTY)
    yield "a list / with gaps", _list(atlas, replace(listed, gaps=GAPS), STABLE, UNKNOWN)
    yield "a list / of nothing, with gaps", _list(atlas, replace(EMPTY, gaps=GAPS))
    yield "a list / with a hypothesis", _list(atlas, replace(listed, hypotheses=(HYPOTHESIS,)), STABLE, UNKNOWN)
    yield "a list / all decided", _list(atlas, listed, STABLE)
    yield "a list / of inner intervals", _list(atlas, listed, INNER)
    yield "a list / nothing decided", _list(atlas, listed, (), UNKNOWN)
    for point in POINTS[4:7]:
        yield f"a list / of a point {point.kind.value}", _list(atlas, replace(listed, points=(point,)), STABLE, UNKNOWN)
    for n, extremum in enumerate(EXTREMA):
        yield f"a list / with extremum {n}", _list(atlas, replace(listed, extrema=(extremum,)), STABLE, UNKNOWN)
    yield (
        "a list / with extrema",
        _list(atlas, replace(listed, extrema=EXTREMA, open_extrema=GAPS[:1]), STABLE, UNKNOWN),
    )
    yield "a list / with open extrema", _list(atlas, replace(listed, open_extrema=GAPS[:2]), STABLE, UNKNOWN)
    two = replace(listed, parameters=2)
    yield "a list of two", _list(atlas, two, STABLE, UNKNOWN)
    yield (
        "a list of two / with collisions",
        _list(atlas, replace(two, points=(*POINTS[:1], *COLLISIONS)), STABLE, UNKNOWN),
    )
    for label, points_, gaps, more in (
        ("none", (), (), ()), ("some", COMBINED, (), ()), ("some open", COMBINED, GAPS[4:6], ()),
        ("some with gaps", COMBINED, (), GAPS), ("none, some open", (), GAPS[4:5], GAPS),
    ):  # fmt: skip
        found = replace(two, combinations=Combinations(points_, gaps), gaps=more)
        yield f"a list of two / with combinations, {label}", _list(atlas, found, STABLE, UNKNOWN)
    yield "a list of three", _list(atlas, replace(listed, parameters=3))
    across = ListAcross(replace(EMPTY, points=ACROSS), STABLE, UNKNOWN, (None, ball(1), None, ball(2), None))
    yield "a list / across", _list(atlas, listed, STABLE, UNKNOWN, across)
    yield "a list / across, decided", _list(atlas, listed, STABLE, UNKNOWN, replace(across, stable=INNER, unknown=()))
    yield (
        "a list / across, with gaps",
        _list(atlas, listed, STABLE, UNKNOWN, replace(across, found=replace(across.found, gaps=GAPS[:2]))),
    )
    yield "a list / across, nothing", _list(atlas, listed, STABLE, UNKNOWN, ListAcross(EMPTY, (), (), ()))
    yield "a list / across, nothing decided", _list(atlas, listed, STABLE, UNKNOWN, ListAcross(EMPTY, (), UNKNOWN, ()))
    circle = of_curve("symmetric-arc")
    for kind in ("symmetric-arc", "symmetric-loop"):
        half = _claiming(circle, kind=kind, increasing=())
        yield f"a list on a {kind}", _list(half, two, STABLE, UNKNOWN)
        yield f"a list on a {kind} / of three", _list(half, replace(listed, parameters=3))
        yield f"a list on a {kind} / of nothing", _list(half, EMPTY)
        yield f"a list on a {kind} / across", _list(half, two, STABLE, UNKNOWN, replace(across, unknown=()))
        yield f"a list on a {kind} / across, nothing", _list(half, two, STABLE, UNKNOWN, ListAcross(EMPTY, (), (), ()))
    for name, system in (
        ("arc", of_curve("arc")), ("arc-on-level", of_curve("arc-on-level")),
        ("atlas-lyapunov", stored("atlas-lyapunov")),
        ("atlas-axial-family", stored("atlas-axial-family")), ("atlas-vertical", _vertical()),
        ("atlas-doublings", stored("atlas-doublings")), ("atlas-butterfly", stored("atlas-butterfly")),
    ):  # fmt: skip
        yield f"a list on {name}", _list(system, replace(listed, points=POINTS[4:6]), STABLE, UNKNOWN)
        yield f"a list on {name} / with gaps", _list(system, replace(listed, gaps=GAPS), INNER)
    yield "a list on no name", _list(_of(of_curve("list"), first_integral_name=None), listed, STABLE)


def _vertical() -> Atlas:
    system = VERTICAL["L1"]
    return replace(stored("atlas-lyapunov"), system=system, claim=Claim("arc", None, (system.centre_coordinates[0],)))


def lasting() -> Told:
    """Stability for ever along a curve."""
    atlas = replace(of_curve("list"), system=SPRINGS)
    exceptions = tuple(
        ExceptionalOrbit(_point(80 + 3 * n, k, j, kind), fate)
        for n, (k, j, kind, fate) in enumerate(
            (k, j, kind, fate)
            for k, j, kind in (
                (3, 1, Kind.RESONANCE),
                (4, 1, Kind.RESONANCE),
                (0, 0, Kind.TWISTLESS),
                (2, 1, Kind.HERE),
            )
            for fate in Fate
        )
    )
    between = tuple(LastingInterval(entry, sign) for entry, sign in zip(STABLE, (1, -1), strict=True))
    full = LastingList(exceptions, between, UNKNOWN, GAPS[-1:])
    bound = Reversibility(3, ball(1), 2, ball(2))

    def of(given: LastingList, reversibility: Reversibility | None = None, of_atlas: Atlas = atlas) -> str:
        if of_atlas.system.distance_name is None:
            near = tuple(replace(entry, between=_without_distances(entry.between)) for entry in given.stable)
            given = replace(given, stable=near, undecided=tuple(map(_without_distances, given.undecided)))
        known = ProvedLasting(known_curve(of_atlas), EMPTY, (), (), None, given, reversibility)
        whole = concluded(LastingTheorem(CurveTheorem(of_atlas), 6), known)
        return whole.removeprefix(concluded(CurveTheorem(of_atlas), known.curve)).removeprefix(_list(of_atlas, EMPTY))

    yield "lasting", of(full, bound)
    yield "lasting / of nothing", of(LastingList((), (), (), ()))
    yield "lasting / all decided", of(replace(full, undecided=(), gaps=()), bound)
    yield "lasting / no exceptions", of(replace(full, exceptions=()), bound)
    yield "lasting / no interval", of(replace(full, stable=()), bound)
    for shown in (
        Reversibility(1, ball(1), 1, ball(2)), Reversibility(2, ball(1), 2, ball(2)),
        Reversibility(2, ball(1), 0, None), Reversibility(1, ball(1), 0, None),
    ):  # fmt: skip
        yield f"lasting / checked on {shown.sharp} of {shown.intervals}", of(full, shown)
    yield "lasting / with a family parameter", of(full, bound, of_curve("arc"))
    yield "lasting / on a half", of(full, bound, of_curve("symmetric-arc"))


# Surfaces


def surfaces() -> Told:
    atlas = stored("surface")
    heights = tuple(Height(Q(n, 10), Q(n + 1, 10), Q(z, 16)) for n, z in ((2, 3), (3, 5), (4, 4), (5, 3), (6, 6)))

    def of(
        given: Atlas, sides: Any = ("below",), half_period: arb | None = None, family: PlanarFamily | None = None
    ) -> str:
        names = given.system.centre_coordinates
        ends = {"start": points(names, 11), "end": points(names, 21)}
        time = ball(9) if half_period is None else half_period
        known = ProvedSurface((), ends, heights, frozenset(sides), time, family)
        return branch_in_full(given, concluded(SurfaceTheorem(given), known))

    for name in ("surface", "surface-axial"):
        atlas = stored(name)
        yield name, of(atlas)
        yield f"{name} / above", of(atlas, ("above",))
        yield f"{name} / on both sides", of(atlas, ("above", "below"))
        yield f"{name} / half periods not known", of(atlas, half_period=NAN)
        for covers in (
            None, Covers("h", Q(0), Q(1, 2)), Covers("h", Q(-1, 2), Q(1, 2)), Covers("h", Q(-1, 2), Q(-1, 4)),
            Covers("h", Q(1, 3), Q(1)),
        ):  # fmt: skip
            label = "nothing" if covers is None else f"{covers.start} to {covers.end}"
            other = _claiming(atlas, covers=covers)
            yield f"{name} / covers {label}", of(other)
            families = ((Q(0), Q(1)), (Q(1, 20), Q(1)), (Q(0), Q(1, 20)), (Q(1, 27), Q(1, 8)))
            for start, end in (
                families if name == "surface" and covers is not None and covers.start >= 0 else families[:1]
            ):
                yield (
                    f"{name} / covers {label}, family from {start} to {end}",
                    of(other, family=PlanarFamily("L1", start, end)),
                )


# Curves without symmetry


def _part(n: int, sides: Sides | None) -> SidedPart:
    return SidedPart(("p001", "p001"), (Q(0), Q(1)), (ball(n), ball(n + 1)), ball(n + 2), sides)


EQUILIBRIA: tuple[tuple[str, tuple[Fold, ...], tuple[SidedPart, ...]], ...] = (
    ("", (), (_part(1, Sides(2, 0)),)),
    (" / not decided", (), (_part(1, None),)),
    (
        " / folds and sides",
        tuple(
            Fold(is_maximum, is_regular, ("p001", "p001"), (Q(0), Q(1)), (ball(1), ball(2)), ball(3))
            for is_maximum in (True, False) for is_regular in (True, False)
        ),
        (_part(1, Sides(2, 0)), _part(2, None), _part(3, Sides(1, 1)), _part(4, None), _part(5, Sides(1, 1))),
    ),
)  # fmt: skip


def periodic_curves() -> Told:
    for name, make in CURVES.items():
        atlas = make().atlas
        if isinstance(atlas, BirthAtlas):
            ends = {"start": points(atlas.coordinates, 11), "end": points(atlas.coordinates, 21)}
            known, open_ones = Spectrum((), 1, 0, 0), Spectrum((), 0, 0, 1)
            for label, eigenvalues, at_end in (
                ("", known, None), (" / not decided", open_ones, None),
                (" / to another birth", known, (ball(3), open_ones)),
            ):  # fmt: skip
                born = ProvedBirthCurve(NO_CHAIN, ends, ball(1), eigenvalues, ball(2), (), at_end)
                said = birth_curve_in_words(BirthCurveTheorem(atlas), born)
                yield f"{name}{label}", equilibrium_curve_in_full(atlas, said)
        elif isinstance(atlas, EquilibriumAtlas):
            ends = {"start": points(atlas.coordinates, 11), "end": points(atlas.coordinates, 21)}
            for label, folds, sides in EQUILIBRIA:
                found = ProvedEquilibriumCurve(NO_CHAIN, ends, folds, sides)
                said = equilibrium_curve_in_words(EquilibriumCurveTheorem(atlas), found)
                yield f"{name}{label}", equilibrium_curve_in_full(atlas, said)
        elif isinstance(atlas, PeriodicAtlas):
            yield name, _periodic(atlas)
            claim, first = atlas.claim, atlas.coordinates[0]
            changes: dict[str, dict[str, Any]] = {
                "two crossings": {"crossings": 2},
                "a loop": {"kind": "periodic-loop", "increasing": (), "covers": None},
                "nothing increases": {"increasing": ()}, "two increase": {"increasing": atlas.coordinates[:2]},
                "covers": {"covers": Covers(first, Q(-1, 8), Q(1, 8))},
                "other direction": {"direction": -claim.direction},
            }  # fmt: skip
            for label, change in changes.items():
                yield f"{name} / {label}", _periodic(replace(atlas, claim=replace(claim, **change)))
    atlas = CURVES["periodic-arc"]().atlas
    assert isinstance(atlas, PeriodicAtlas)
    free = replace(atlas, claim=replace(atlas.claim, increasing=(), covers=None))
    turns = [
        Turn(is_maximum, ("p001", "p001"), (Q(0), Q(1)), (ball(n), ball(n + 1)))
        for n, is_maximum in ((1, True), (3, False), (5, True))
    ]
    for count in (1, 2, 3):
        yield f"periodic-arc / {count} turns", _periodic(free, turns=tuple(turns[:count]))
        yield f"periodic-arc / {count} turns, embedded", _periodic(atlas, turns=tuple(turns[:count]))
    yield "periodic-arc / two minima", _periodic(free, turns=(turns[1], turns[1]))
    of_a = replace(atlas, claim=replace(atlas.claim, covers=Covers("P", Q(0), Q(1))))
    yield (
        "periodic-arc / names that theorems use",
        _periodic(replace(of_a, system=HOSTILE, claim=replace(of_a.claim, parameter="P", increasing=("H",)))),
    )
    yield "periodic-arc / periods not known", _periodic(atlas, period=NAN)
    along = replace(atlas.claim, normal=(Q(0), Q(1), Q(0), Q(0)), parameter="k", increasing=("k",), covers=None)
    forced = replace(atlas, system=LOCKED, parameters={"r": Q(3)}, claim=along)
    yield "forced-arc", _periodic(forced, period=4 * arb.pi() / 3)
    of_speed = replace(forced, parameters={"k": Q(3)}, claim=replace(along, parameter="r", increasing=("r",)))
    yield "forced-arc where the speed of the force varies", _periodic(of_speed, period=4 * arb.pi() / 3)
    counts = [
        Counts(2, 0, 0),
        Counts(1, 0, 1),
        Counts(1, 1, 0),
        Counts(0, 2, 0),
        None,
        Counts(1, 0, 0),
        Counts(0, 0, 1),
    ]
    parts = [
        CountedPart(("p001", "p001"), (Q(0), Q(1)), (ball(n), ball(n + 1)), ball(n + 2), count)
        for n, count in enumerate(counts, 10)
    ]
    for name in ("periodic-arc", "periodic-arc-twice", "periodic-arc-levels", "periodic-arc-on-level"):
        atlas = CURVES[name]().atlas
        assert isinstance(atlas, PeriodicAtlas)
        size, open_part = number_of_multipliers(atlas), parts[4]
        known = [part for part in parts if part.counts and sum(astuple(part.counts)) == size]
        for n, part in enumerate((*known, open_part)):
            yield f"{name} / counted {n}", _periodic(atlas, multipliers=(part,))
        for n, part in enumerate(known):
            for order in ((part, open_part), (open_part, part, open_part, known[0]), (open_part, open_part, known[0])):
                label = f"{name} / counted in {len(order)} parts {n}"
                yield label, _periodic(atlas, multipliers=order)


HOSTILE = define_system(
    {"name": "of-symbols", "state": "x H", "parameters": "P", "field": {"x": "P*x + (-H)", "H": "x*(1 - H)**(3/2)"}}
)
"""With names that theorems have for something else."""


def _periodic(atlas: PeriodicAtlas, **changes: Any) -> str:
    ends = {"start": points(atlas.coordinates, 11), "end": points(atlas.coordinates, 21)}
    known = ProvedPeriodicCurve(NO_CHAIN, ends, **{"period": ball(9), **changes})
    return periodic_curve_in_full(atlas, concluded(PeriodicCurveTheorem(atlas), known))


# Indices, catalogues, webs


def _turns(*indices: int) -> tuple[HalfTurns, ...]:
    return tuple(HalfTurns(index, 0, 1, (ball(1), ball(2))) for index in indices)


def indices_and_catalogues() -> Told:
    orbits = (CountedOrbit("p001", Q(1, 3), _turns(1)), CountedOrbit("p002", Q(-1, 4), _turns(2, 1)))
    intervals = tuple(Interval(entry.begin, entry.end) for entry in STABLE)
    for name, atlas in (
        ("list", of_curve("list")), ("symmetric-arc", of_curve("symmetric-arc")),
        ("atlas-axial-family", stored("atlas-axial-family")), ("atlas-lyapunov", stored("atlas-lyapunov")),
        ("atlas-vertical", _vertical()),
    ):  # fmt: skip
        curve, small = (
            known_curve(atlas),
            (1, 2) if name == "atlas-lyapunov" else (3,) if name == "atlas-vertical" else (),
        )
        for with_list in (False, True):
            known = ProvedIndex(orbits, intervals if with_list else (), small)
            yield (
                f"index on {name}{', with a list' * with_list}",
                index_in_words(IndexTheorem(atlas, with_list), known, curve, "a curve", "sha256:1"),
            )
    for crossings, certified in ((1, 0), (1, 3), (2, 3)):
        atlas = _claiming(of_curve("arc"), crossings=crossings)
        words = catalogue_in_words(atlas, "a curve", "sha256:1", certified, 5, Q(1, 10**6))
        yield f"catalogue, {certified} rows, {crossings} crossings", words


def webs() -> Told:
    place = PlaceOnCurve("p001", ball(3), False)
    at_symmetric = PlaceOnCurve("p001", arb(0), False)
    at_birth = PlaceOnCurve("birth", arb(0), False)

    def found(kind: str) -> Any:
        return Bifurcation("v", kind, 1, place, "", {})

    halves = _claiming(of_curve("symmetric-arc"), kind="symmetric-loop", increasing=())
    atlases: dict[str, Atlas] = {
        "arc": of_curve("list"), "symmetric": of_curve("symmetric-arc"),
        "loop": _claiming(of_curve("list"), kind="loop"),
        "halves": halves, "lyapunov": stored("atlas-lyapunov"), "vertical": _vertical(),
        "axial": stored("atlas-axial-family"), "butterfly": stored("atlas-butterfly"), "family": of_curve("arc"),
        "plane": replace(stored("atlas-butterfly"), system=CR3BP_PLANAR, pieces=()),
        "under-axial": replace(stored("atlas-butterfly"), system=CR3BP.under(AXIAL), pieces=()),
        "of-no-name": _of(of_curve("list"), first_integral_name=None),
        "no-values": replace(of_curve("list"), parameters={}),
    }  # fmt: skip
    vertices = (
        Vertex("v", "symmetry_breaking", 1, ball(1)), Vertex("w", "period_tupling", 3, ball(2)),
        Vertex("L1", "libration_point", 1, ball(3)), Vertex("u", "period_tupling", 2, ball(4)),
    )  # fmt: skip
    digests = {"v": "d1", "w": "d2", "u": "d3"} | {name: f"of {name}" for name in atlases}
    index = Indices(
        "di", (
            IndexOnArc((3,), "p001", Q(1, 3)),
            IndexOnArc((2, 1), "p001", Q(1, 4), IntervalEnd(("fold",), "p001", (Q(0), Q(1, 8))), IntervalEnd(
                ("the end of the curve", "1:2"), "p002", (Q(1, 4), Q(1, 2))
            )),
        ), (1, 2),
    )  # fmt: skip
    for name, atlas in atlases.items():
        atlas = replace(atlas, id=name)
        meetings = (
            Incidence(name, "v", PASSES, place), Incidence(name, "v", PASSES, replace(place, other_point=True)),
            Incidence(name, "L1", ENDS, None),
        )  # fmt: skip
        if atlas.claim.symmetry is not None:
            meetings += (
                Incidence(name, "v", PASSES, replace(place, mirrored=True)),
                Incidence(name, "w", BRANCHES, at_symmetric),
            )
        if atlas.birth_pieces():
            meetings += (Incidence(name, "v", BRANCHES, at_birth), Incidence(name, "w", BRANCHES, at_birth))
        arc = Arc(atlas, known_curve(atlas), "", {"v": found("reversor_breaking"), "w": found("symmetry_breaking")})
        claim = WebTheorem(Web("web", "a web", (WebArc(name, (Meeting("v", PASSES),)),)))
        known = KnownArc(arc, ball(5), ball(6))
        web = ProvedWeb((known,), vertices if name == "arc" else (), meetings, (), ((name,),))
        yield f"web of {name}", web_in_words(claim, web, digests)
        not_known = replace(
            known, level=NAN, period=NAN, indices=index if name == "lyapunov" else replace(index, small=())
        )
        more = replace(web, arcs=(not_known,), incidences=(), parts=((name, "one", "two"), ("other",)))
        yield f"web of {name} / with indices", web_in_words(claim, more, digests)
        switched = replace(web, switches=(Switch("v", name, "other"),), parts=((name, "other"), ("one",)))
        yield f"web of {name} / with a switch", web_in_words(claim, switched, digests)


def lives() -> Told:
    place = PlaceOnCurve("e1", ball(3), False)
    of_orbits = (ball(1), Spectrum((), 1, 0, 0), ball(2))
    turn = Turn(True, ("p1", "p1"), (Q(0), Q(1, 2)), (ball(1), ball(2)))
    birth = Birth({"a": ball(4), "x": ball(5), "y": ball(6)}, ball(1), Spectrum((), 1, 0, 0))
    joint = Birthplace("born", "rest", BEGINS, place, birth, Sides(3, 0), Sides(1, 2))
    ends = {"start": birth.point, "end": {"a": ball(7), "x": ball(8), "y": ball(9)}}
    not_decided = replace(birth, others=Spectrum((), 0, 0, 1))
    for label, folds, turns, changes in (
        ("", (), (), {}),
        (" / with folds", EQUILIBRIA[-1][1], (turn,), {}),
        (" / not decided", (), (), {"birth": not_decided, "before": None, "after": None}),
        (" / that ends", (), (), {"how": ENDS_ON}),
    ):
        at_rest = LifeCurve(rest_atlas(), ProvedEquilibriumCurve(NO_CHAIN, {}, folds, ()))
        orbits = LifeCurve(circles_born(id="born"), ProvedBirthCurve(NO_CHAIN, ends, *of_orbits, turns))
        proved = ProvedLife((at_rest, orbits), (ball(7), ball(8)), (replace(joint, **changes),), (("rest", "born"),))
        yield f"life{label}", life_in_words(LifeTheorem(life_claim()), proved, {"rest": "d1", "born": "d2"})
    closed = replace(at_rest, atlas=circle_of_equilibria(id="rest"))
    unknown = replace(orbits, curve=ProvedBirthCurve(NO_CHAIN, ends, ball(1), Spectrum((), 1, 0, 0), NAN, ()))
    again = replace(unknown, atlas=circles_born(id="again"))
    said = life_claim(LifeArc("again", (LifeJoint("rest", BEGINS),)))
    proved = ProvedLife(
        (closed, unknown, again), (ball(7), ball(8), ball(9)), (joint, replace(joint, arc="again")),
        (("rest", "born"), ("again",)),
    )  # fmt: skip
    yield "life of three", life_in_words(LifeTheorem(said), proved, {"rest": "d1", "born": "d2", "again": "d3"})


def curve_sentences() -> Told:
    """Of curves, lists, surfaces, webs, lives, indices and catalogues."""
    for told_of in (curves, places, lists, lasting, surfaces, periodic_curves, indices_and_catalogues, webs, lives):
        yield from told_of()
