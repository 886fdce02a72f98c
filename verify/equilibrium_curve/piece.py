"""One piece of a curve of equilibria, proved over an interval of its parameter (section 37.2)."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from flint import arb

from orbitproof.shared.claims import EquilibriumAtlas, Piece
from orbitproof.verify.curve import (
    BEYOND,
    TUBE,
    Account,
    Interval,
    PieceLimits,
    PieceResult,
    Progress,
    ProvedInterval,
    attempt,
    check_newton,
    in_units,
    tube_points,
)
from orbitproof.verify.evidence import Checklist, enclose, guarded
from orbitproof.verify.periodic import functions_at_start
from orbitproof.verify.periodic_curve import require_piece
from orbitproof.verify.poincare import PHYSICAL, at_start, defined_values


@dataclass(frozen=True)
class EquilibriumLimits(PieceLimits):
    """How to enclose the field on a piece: as `PieceLimits`; nothing is integrated."""

    precision: int = 128
    width: int = 40


@dataclass(frozen=True)
class EquilibriumTubeTheorem:
    """For every s of the interval the tube contains exactly one equilibrium (Lemma 37.1)."""

    hypotheses = ("piece", "newton")


def prove_equilibrium_piece(
    atlas: EquilibriumAtlas,
    piece: Piece,
    interval: Interval,
    limits: EquilibriumLimits | None = None,
    progress: Progress | None = None,
) -> PieceResult[ProvedInterval]:
    """Prove the claim of a piece for s in an interval within [-1, 1], or say why it is not proved.

    `atlas`: what is claimed; of its pieces only `piece` matters. `progress` is called once.
    """
    limits = EquilibriumLimits() if limits is None else limits
    computation: Account = {**asdict(limits), "steps": 1, "coordinates": PHYSICAL}

    def check(checklist: Checklist) -> ProvedInterval:
        start, end = interval
        statement = "the piece has the coordinates of parameter and state, a regular frame and a tube"
        with checklist.hypothesis("piece", "37.1", statement, "correct the piece") as evidence:
            evidence.require(-1 <= start < end <= 1, f"[{start}, {end}] is no interval within [-1, 1]")
            require_piece(evidence, atlas, piece)
        radius = (end - start) / 2 * BEYOND
        widths = [width / TUBE for width in piece.tube]
        arithmetic = limits.arithmetic(widths, limits.precision // 2)
        point = tube_points(arithmetic, atlas.coordinates, piece, ((start + end) / 2, radius), widths)
        system, claim = atlas.system, atlas.claim
        given = [point[name] for name in system.given_state]
        constants = [
            point[name] if name == claim.parameter else arithmetic.constant(atlas.parameters[name])
            for name in system.parameters
        ]
        functions = defined_values(functions_at_start(system), given, constants)
        equations = at_start(system.program, [*given, *functions, *constants])[: len(given)]
        if progress is not None:
            progress(1)
        deviation, slope_deviation = check_newton(checklist, equations, radius)
        bounds = in_units(widths, deviation), in_units(widths, slope_deviation)
        return ProvedInterval(start, end, *bounds, arb(0))

    with guarded(limits.precision):
        return attempt(piece.id, interval, EquilibriumTubeTheorem(), computation, check)


def parameters_at(atlas: EquilibriumAtlas, value: arb) -> list[arb]:
    """Enclosures of all parameters, that which varies with these values."""
    known = {**{name: enclose(number) for name, number in atlas.parameters.items()}, atlas.claim.parameter: value}
    return [known[name] for name in atlas.system.parameters]
