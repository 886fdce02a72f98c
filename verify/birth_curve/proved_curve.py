"""The theorem about a curve of orbits from their birth on, from proved pieces (sections 38.4 to 38.8)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import acb, arb, arb_mat, ctx

from orbitproof.shared.claims import BIRTH_CURVES, BirthAtlas
from orbitproof.shared.systems import AMPLITUDE, own_name
from orbitproof.verify.birth_curve.piece import require_claim
from orbitproof.verify.curve import (
    CURVE_PRECISION,
    Chain,
    Conclusion,
    Ends,
    IntervalResult,
    follow,
    read_tube,
    times_of,
)
from orbitproof.verify.equilibrium.expansions import expand
from orbitproof.verify.equilibrium.proved_hopf import beside_pair
from orbitproof.verify.equilibrium.spectrum import Spectrum, spectrum_of
from orbitproof.verify.evidence import (
    Checklist,
    EmptyIntersectionError,
    NotEstablishedError,
    NotProved,
    Proved,
    Reason,
    enclose,
    excludes_zero,
    is_positive,
)
from orbitproof.verify.periodic import check_functions_of
from orbitproof.verify.periodic_curve import Turn, require_piece
from orbitproof.verify.periodic_curve.turns import turns_of


@dataclass(frozen=True)
class BirthCurveTheorem:
    """The pieces of an atlas are one curve of periodic orbits from their birth on, as claimed (Theorems 38.6, 38.9)."""

    atlas: BirthAtlas

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        functions = ("functions",) if self.atlas.system.defined else ()
        at_end = ("simple-pair-at-end", "two-points") if _ends_at_birth(self.atlas) else ()
        return (*functions, "pieces", "birth", "curve", "amplitude", "simple-pair", *at_end)


@dataclass(frozen=True)
class ProvedBirthCurve:
    """What is known of a proved curve.

    Attributes:
        chain: its pieces, glued.
        ends: enclosures of the coordinates of its first and last point.
        frequency: omega of the eigenvalues +- i omega where it begins.
        eigenvalues: the others there.
        period: contains the least periods of all its orbits; not finite if they are not all known.
        turns: where the parameter has extrema along the curve, as far as that is certain.
        pair_at_end: omega and the other eigenvalues where it ends, if orbits are born there too.
    """

    chain: Chain
    ends: Ends
    frequency: arb
    eigenvalues: Spectrum
    period: arb
    turns: tuple[Turn, ...] = ()
    pair_at_end: tuple[arb, Spectrum] | None = None


def conclude_births(atlas: BirthAtlas, results: Sequence[IntervalResult]) -> Conclusion[ProvedBirthCurve]:
    """The theorem that proved pieces give, or the first hypothesis that is not shown.

    Args:
        atlas: the claim; that the results are about its pieces as they are is for the caller.
        results: one for each interval of each piece.
    """
    checklist = Checklist()
    with ctx.workprec(CURVE_PRECISION):
        try:
            chain = _check_curve(checklist, atlas, results)
            ends = {
                key: dict(zip(atlas.coordinates, end, strict=True))
                for key, end in zip(("start", "end"), chain.ends, strict=True)
            }
            pair, at_end = _check_pair(checklist, atlas, ends["start"]), None
            if _ends_at_birth(atlas):
                at_end = _check_pair(checklist, atlas, ends["end"], True)
                _check_two_points(checklist, atlas, ends)
            curve = ProvedBirthCurve(chain, ends, *pair, times_of(chain), turns_of(chain), at_end)
        except NotEstablishedError as error:
            return Conclusion(NotProved(error.reason, tuple(checklist.hypotheses)))
        except EmptyIntersectionError as error:
            reason = Reason("results", f"pieces contradict each other: {error}", "report this")
            return Conclusion(NotProved(reason, tuple(checklist.hypotheses)))
    return Conclusion(Proved(BirthCurveTheorem(atlas), curve, tuple(checklist.hypotheses)))


def _ends_at_birth(atlas: BirthAtlas) -> bool:
    """Whether the orbits shrink to an equilibrium at the end too (section 38.8)."""
    return atlas.claim.kind == "birth-to-birth"


def _check_curve(checklist: Checklist, atlas: BirthAtlas, results: Sequence[IntervalResult]) -> Chain:
    """Check that there is a curve; raises `NotEstablishedError` at the first hypothesis that is not shown."""
    claim, pieces = atlas.claim, atlas.curve_pieces()
    check_functions_of(checklist, atlas.system)
    statement = "the claim names two coordinates and a parameter; the pieces have these coordinates, frames and tubes"
    with checklist.hypothesis("pieces", "38.1", statement, "write the atlas again") as evidence:
        evidence.require(claim.kind in BIRTH_CURVES, f"{claim.kind} is no claim about such a curve")
        require_claim(evidence, atlas)
        evidence.require(len(pieces) == len(atlas.pieces) > 0, "there are too few pieces of a curve")
        evidence.require(len({piece.id for piece in pieces}) == len(pieces), "two pieces have the same id")
        if evidence.holds:
            for piece in pieces:
                require_piece(evidence, atlas, piece)
    place, ends = atlas.coordinates.index(AMPLITUDE), [(pieces[0], 1), *[(pieces[-1], -1)] * _ends_at_birth(atlas)]
    statement = "on the first piece the amplitude is a positive multiple of s + 1"
    statement += ", and on the last one of 1 - s" * _ends_at_birth(atlas)
    with checklist.hypothesis("birth", "38.1", statement, "let the curve begin at the equilibrium") as evidence:
        for piece, grows in ends:
            along, *across = piece.frame[place]
            evidence.require(grows * along > 0 and not any(across), f"its row is not that of p_0 on {piece.id}")
            evidence.require(piece.centre[place] == abs(along) * piece.half_width, f"it is not 0 at s = {-grows}")
    by_piece: dict[str, list[IntervalResult]] = {piece.id: [] for piece in pieces}
    for result in results:
        by_piece.setdefault(result.piece, []).append(result)
    tubes = [read_tube(piece, by_piece[piece.id]) for piece in pieces]
    statement = "every piece is proved where the curve uses it and leads into the tube of the next one"
    remedy = "write the atlas again with more overlap, wider tubes, or narrower pieces where they are not proved"
    found: Chain | None = None
    with checklist.hypothesis("curve", "38.4", statement, remedy) as evidence:
        found = follow(evidence, claim, tubes)
    assert found is not None
    statement = "the amplitude is positive along the curve"
    with checklist.hypothesis("amplitude", "38.4", statement, "let the curve end before it is 0 again") as evidence:
        for stretch in found.stretches:
            # On the first piece it is a multiple of s + 1, on the last one perhaps of 1 - s.
            evidence.require(
                any(stretch.tube.piece is piece for piece, _ in ends)
                or stretch.tube.coordinate_is_beyond_zero(place, 1, stretch.run, stretch.enters, stretch.leaves),
                f"it is not shown to be positive on piece {stretch.tube.piece.id}",
            )
    return found


def _check_pair(
    checklist: Checklist, atlas: BirthAtlas, start: dict[str, arb], at_end: bool = False
) -> tuple[arb, Spectrum]:
    """The eigenvalues +- i omega where the curve begins or ends are simple; omega, and the others (section 38.5)."""
    system, claim = atlas.system, atlas.claim
    name, section = ("simple-pair-at-end", "38.8") if at_end else ("simple-pair", "38.5")
    statement = f"the pair of eigenvalues where the curve {'ends' if at_end else 'begins'} is simple"
    with checklist.hypothesis(name, section, statement, "a narrower tube of that piece") as evidence:
        state = system.given_state
        size = len(state)
        known = {name: enclose(value) for name, value in atlas.parameters.items()} | start
        units = [[arb(int(i == j)) for i in range(size)] for j in range(size)]
        rates = expand(system, [start[x] for x in state], [known[name] for name in system.parameters], units, 1)
        matrix = arb_mat([[rate.slope(j) for j in range(size)] for rate in rates])
        exact = {claim.section: Fraction(0), claim.amplitude: Fraction(1)}
        y = arb_mat([[enclose(exact[x]) if x in exact else start[own_name(f"along {x}")]] for x in state])
        moved = matrix * y
        # A^2 y = -omega^2 y, and y_j = 1.
        square = evidence.record("omega^2", -(matrix * moved)[state.index(claim.amplitude), 0])
        evidence.require(is_positive(square), "omega may be 0", needs_precision=True)
        if evidence.holds:
            omega = evidence.record("omega", square.sqrt())
            q = [acb(y[i, 0], -moved[i, 0] / omega) for i in range(size)]
            rest = beside_pair([[matrix[i, j] for j in range(size)] for i in range(size)], q)
            if rest:
                other = arb_mat(rest)
                identity = arb_mat([[int(i == j) for j in range(size - 2)] for i in range(size - 2)])
                value = evidence.record("det(D^2 + omega^2)", (other * other + square * identity).det())
                evidence.require(excludes_zero(value), "another eigenvalue may be i omega", needs_precision=True)
    return omega, spectrum_of(rest)


def _check_two_points(checklist: Checklist, atlas: BirthAtlas, ends: Ends) -> None:
    """The equilibria at the ends are not the same one (section 38.8)."""
    statement = "at its ends the curve has other equilibria, or other values of the parameter"
    with checklist.hypothesis("two-points", "38.8", statement, "narrower tubes at the ends") as evidence:
        names = (atlas.claim.parameter, *atlas.system.given_state)
        differ = [excludes_zero(ends["end"][name] - ends["start"][name]) for name in names]
        evidence.require(any(differ), "they may be the same", needs_precision=True)
