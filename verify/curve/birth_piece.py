"""A piece of orbits about the one from which they are born, proved (sections 16.12 and 16.14).

Axial orbits are born from a vertical one, others at a period doubling. One integration follows the points of s and of
-s at once, from the plane y = 0 to where they are in it next: what vanishes on the axis, or on Fix(R), is divided into
its even and its odd part in s, and the odd part by s.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction

from flint import arb, arb_poly

from orbitproof.shared.formats import Atlas, BirthPiece
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, LIFTED, ReversibleSystem
from orbitproof.verify.algebra import Arithmetic, Series, ball_polynomial, recentred
from orbitproof.verify.curve.bifurcations_on_it import PlaceOnCurve
from orbitproof.verify.curve.equation import BEYOND, TUBE, Equation, HalfReturn, divided_by_wide, parameter_series
from orbitproof.verify.curve.piece import SLOPE_BITS, PieceLimits, Progress, check_newton, in_units
from orbitproof.verify.curve.piece_claim import ACROSS, require_birth_piece
from orbitproof.verify.curve.piece_result import Account, Interval, IntervalResult, PieceResult, attempt
from orbitproof.verify.curve.proved_intervals import ProvedInterval, read_results
from orbitproof.verify.evidence import Checklist, Evidence, dot, enclose, excludes_zero, guarded, is_inside
from orbitproof.verify.poincare import WideOracle
from orbitproof.verify.poincare.settings import AUTO

_SPARE_BITS = 32
"""Where orbits begin close to a primary, as they may at a doubling, derivatives have all but so many of the bits."""


@dataclass(frozen=True)
class BirthTheorem:
    """For every s of the interval the tube contains exactly one point whose orbit, and that of whose image under R,
    are in the fixed set of the reversing symmetry when they are in the plane y = 0 next; it depends smoothly on s.

    That symmetry is R `at_doubling` (Lemma 16.15), and the half turn for axial orbits (Lemma 16.11).
    """

    at_doubling: bool

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return ("piece", "half-return", "newton", *(() if self.at_doubling else ("side",)))


@dataclass(frozen=True)
class Birth:
    """Where the orbits of a curve come from at its end, and how the curve gets there (Theorems 16.12 and 16.16).

    Attributes:
        tube: its piece, proved.
        s: of the orbit in that piece which is the one at the end of the curve, or one of the curve near its end.
        mirrored: whether it is the mirror image of the end's orbit that lies there.
    """

    tube: BirthTube
    s: arb
    mirrored: bool = False


def is_born_at_doubling(atlas: Atlas) -> bool:
    """Whether a curve has a piece of a birth at a doubling."""
    return atlas.system is not LIFTED and bool(atlas.birth_pieces())


def is_at_birth(atlas: Atlas, place: PlaceOnCurve) -> bool:
    """Whether a place is in the piece of the birth of a curve, not on the curve itself."""
    return place.piece in {piece.id for piece in atlas.birth_pieces()}


def prove_birth_piece(
    system: ReversibleSystem,
    parameters: Mapping[str, Fraction],
    piece: BirthPiece,
    interval: Interval,
    oracle: WideOracle,
    limits: PieceLimits | None = None,
    progress: Progress | None = None,
) -> PieceResult[ProvedInterval]:
    """Prove the claim of a piece for s in an interval, which is made symmetric about 0, or say why it is not proved.

    Arguments as of `prove_piece`; `system` is that of the curve.
    """
    if system is not LIFTED and system is not CR3BP:
        raise ValueError(f"no births of orbits of {system.name} are proved")
    followed = CR3BP_AXIAL if system is LIFTED else CR3BP
    limits = PieceLimits() if limits is None else limits
    computation: Account = {**asdict(limits), "steps": 0, "coordinates": ""}
    proof = _Proof(followed, parameters, piece, max(map(abs, interval)), oracle, limits)
    with guarded(limits.precision):
        return attempt(
            piece.id,
            interval,
            BirthTheorem(followed is CR3BP),
            computation,
            lambda checklist: proof.check_all(checklist, interval, computation, progress),
        )


@dataclass(frozen=True)
class _Proof:
    """The claim of a piece for |s| <= reach, and how to integrate it; R of the `system` is where the orbits end."""

    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    piece: BirthPiece
    reach: Fraction
    oracle: WideOracle
    limits: PieceLimits

    @property
    def tube(self) -> list[Fraction]:
        """dp_j/domega_j."""
        return [width / TUBE for width in self.piece.tube]

    def check_all(
        self, checklist: Checklist, asked: Interval, computation: Account, progress: Progress | None
    ) -> ProvedInterval:
        """Check every hypothesis; raises `NotEstablishedError` at the first that is not shown."""
        self.check_claim(checklist, asked)
        half = self._half_return(checklist, computation, progress)
        radius = self.reach * BEYOND
        vanishing = [half.state[index] for index in self.system.kernel_coordinates]
        equations = [part for element in vanishing for part in (even_part(element), divided_by_wide(element))]
        deviation, slope_deviation = check_newton(checklist, equations, radius, divided=True)
        if self.system is CR3BP_AXIAL:
            self._check_side(checklist, dict(zip(self.system.state, half.state, strict=True)))
        bounds = in_units(self.tube, deviation), in_units(self.tube, slope_deviation)
        return ProvedInterval(-self.reach, self.reach, *bounds, half.time_of_all, half)

    def _check_side(self, checklist: Checklist, at_end: Mapping[str, Series]) -> None:
        statement = "the points of the piece have z != 0, and z -> -z maps no orbit's one end to its other one"
        with checklist.hypothesis("side", "16.12", statement, "a narrower piece") as evidence:
            odd = [range_of_odd(at_end[name]) for name in ("x", "vy", "vz")]
            for name, value in zip(("x", "vy", "vz"), odd, strict=True):
                evidence.record(f"derivative of {name} at the end in s", value / enclose(self.reach * BEYOND))
            evidence.require(self.is_off_plane(), "z is not shown to have one sign on the piece")
            evidence.require(any(map(excludes_zero, odd)), "that its ends differ is not shown")

    def is_off_plane(self) -> bool:
        """Whether z has no zero on the tube, exactly."""
        first, *others = self.piece.polynomial[1]
        most = sum((abs(value) * self.reach ** (n + 1) for n, value in enumerate(others)), self.piece.tube[1])
        return abs(first) > most

    def check_claim(self, checklist: Checklist, asked: Interval) -> None:
        """The exact conditions on the piece."""
        statement = "the piece has regular directions, a tube, and polynomials that are even"
        with checklist.hypothesis("piece", "16.12", statement, "correct the piece") as evidence:
            start, end = asked
            evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
            evidence.require(set(self.parameters) == {"mu"}, "the mass parameter is not given, or others are")
            require_birth_piece(evidence, self.piece)

    def _half_return(self, checklist: Checklist, computation: Account, progress: Progress | None) -> HalfReturn:
        """The orbits of the tube up to where they meet the section next."""
        slope_bits = SLOPE_BITS if self.system is CR3BP_AXIAL else max(SLOPE_BITS, self.limits.precision - _SPARE_BITS)
        arithmetic = self.limits.arithmetic(self.tube, slope_bits)
        start = {**parameter_series(arithmetic, self.system, self.parameters), **self.points(arithmetic)}

        def begun(coordinates: str) -> None:
            computation["coordinates"] = coordinates

        def after_step(steps: int) -> None:
            computation["steps"] = steps
            if progress is not None:
                progress(steps)

        with checklist.hypothesis(
            "half-return", "15.1", "the orbits of the tube meet the section again and are enclosed", "a narrower piece"
        ) as evidence:
            half = HalfReturn.of(self.system, start, self.tube, AUTO, self.oracle, begun, after_step)
            evidence.record("time", half.time_of_all)
            evidence.require(half.time_of_all.is_finite(), "the times are not enclosed")
        return half

    def points(self, arithmetic: Arithmetic) -> dict[str, Series]:
        """The points of the tube by the names of the coordinates, as elements in (sigma, omega); y = 0."""
        piece, radius = self.piece, self.reach * BEYOND
        count = len(ACROSS)

        def alone(j: int) -> tuple[int, ...]:
            return tuple(int(i == j) for i in range(count))

        curves = [recentred(row, Fraction(0), radius) for row in piece.polynomial]
        result = {
            name: arithmetic.polynomial({(0,) * count: curves[j], alone(j): self.tube[j]})
            for j, name in enumerate(ACROSS[:3])
        }
        size = piece.half_width * radius
        for name, (base, turn) in zip(("vx", "vz"), piece.directions, strict=True):
            wide = [Fraction(0), *(size * turn * value for value in curves[3])]
            wide[1] += size * base
            result[name] = arithmetic.polynomial(
                {(0,) * count: wide, alone(3): [Fraction(0), size * turn * self.tube[3]]}
            )
        return result


def even_part(element: Series) -> Series:
    """The part of a function that is even in sigma; that of what is unknown is not larger than all of it."""
    coefs = [type(p)([v if n % 2 == 0 else 0 for n, v in enumerate(p.coeffs())]) for p in element.coefs]
    return Series(element.arithmetic, coefs, element.errors)


def range_of_odd(element: Series) -> arb:
    """The values of the odd part of a function divided by sigma, on the tube over |sigma| <= 1/BEYOND."""
    equation = Equation(divided_by_wide(element))
    part = arb(0, 1) / enclose(BEYOND)
    omega = enclose(TUBE) * arb(0, 1)
    across = dot([equation.slope(j, part) for j in range(len(ACROSS))], [omega] * len(ACROSS))
    return equation.value(part) + across


@dataclass(frozen=True)
class BirthTube:
    """A piece with the interval on which it is proved."""

    piece: BirthPiece
    proved: ProvedInterval

    def local(self, state: Mapping[str, arb]) -> tuple[arb, list[arb]] | None:
        """s and (x, z, vy, b) of a state of the plane y = 0; `None` where s may be 0."""
        along, across = self._solved([state["vx"], state["vz"]])
        if not excludes_zero(along):
            return None
        return along / enclose(self.piece.half_width), [state["x"], state["z"], state["vy"], across / along]

    def at_birth(self, state: Mapping[str, arb], direction: Mapping[str, arb]) -> list[arb] | None:
        """(x, z, vy, b) of a state of Fix(R) with a direction off it; `None` if it is not one of the piece's."""
        along, across = self._solved([direction["vx"], direction["vz"]])
        return [state["x"], state["z"], state["vy"], across / along] if excludes_zero(along) else None

    def _solved(self, velocity: Sequence[arb]) -> tuple[arb, arb]:
        """What has to be multiplied with the columns of `directions`."""
        (a, b), (c, d) = ([enclose(value) for value in row] for row in self.piece.directions)
        determinant = a * d - b * c
        vx, vz = velocity
        return (d * vx - b * vz) / determinant, (a * vz - c * vx) / determinant

    def contains(self, s: arb, place: Sequence[arb]) -> bool:
        """Whether (x, z, vy, b) certainly lies in the tube at s, where that is proved."""
        return (
            is_inside(s, self.proved.end)
            and len(place) == len(ACROSS)
            and all(
                is_inside(ball - polynomial(s), width)
                for ball, polynomial, width in zip(place, self._polynomials, self.piece.tube, strict=True)
            )
        )

    def states(self, s: arb) -> dict[str, arb]:
        """Enclosures of the states at a ball of s within the proved interval, those that are not 0."""
        x, z, vy, b = (
            polynomial(s) + arb(0, 1) * enclose(bound)
            for polynomial, bound in zip(self._polynomials, self.proved.deviation, strict=True)
        )
        size = enclose(self.piece.half_width) * s
        vx, vz = (size * (enclose(base) + enclose(turn) * b) for base, turn in self.piece.directions)
        return {"x": x, "z": z, "vx": vx, "vy": vy, "vz": vz}

    @property
    def _polynomials(self) -> list[arb_poly]:
        return [ball_polynomial(row) for row in self.piece.polynomial]


def tube_of_birth(evidence: Evidence, atlas: Atlas, results: Sequence[IntervalResult]) -> BirthTube | None:
    """The piece of the birth of a curve where it is proved; else `None`, with why in `evidence`."""
    (piece,) = atlas.birth_pieces()
    tube = read_birth(piece, [result for result in results if result.piece == piece.id])
    if isinstance(tube, BirthTube):
        return tube
    evidence.require(False, tube)
    return None


def read_birth(piece: BirthPiece, results: Sequence[IntervalResult]) -> BirthTube | str:
    """The piece over an interval about 0 on which it is proved, the largest one; or why there is none."""
    runs, refusals = read_results(piece, results)
    found = [part for run in runs for part in run.intervals if part.start == -part.end and part.end > 0]
    if not found:
        return refusals[0][1].message if refusals else "nothing is proved of it"
    return BirthTube(piece, max(found, key=lambda part: part.end))
