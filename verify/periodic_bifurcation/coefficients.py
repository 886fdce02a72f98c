"""The coefficients of the bifurcation equation, by Lyapunov-Schmidt (sections 25.4 and 25.5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb

from orbitproof.verify.evidence import dot
from orbitproof.verify.newton import bordering, left_kernel, newton_image
from orbitproof.verify.periodic_bifurcation.equations import PointEquations
from orbitproof.verify.periodic_bifurcation.extended_system import BifurcationPoint


@dataclass(frozen=True)
class Coefficients:
    """speed s + bend y^2 = 0 holds on the new orbits up to terms of higher order; `pairing` is for the multiplier.

    Attributes:
        speed: of s; not 0.
        bend: of y^2.
        pairing: l . w.
    """

    speed: arb
    bend: arb
    pairing: arb

    @property
    def opening(self) -> arb:
        """kappa: s = kappa y^2 along the new orbits."""
        return -self.bend / self.speed


def fold_coefficients(equations: PointEquations, place: BifurcationPoint, normal: Sequence[arb]) -> Coefficients:
    """l . E_s s + l . E_2(w, w) y^2 / 2 at a fold (Lemma 25.2). Raises `ZeroDivisionError` where l is not enclosed."""
    slopes = equations.slopes(place.where)
    covector = _covector(equations, place, 1, normal)
    bent = equations.curvatures(place.where, [*place.kernel, arb(0)])
    curvature = dot(covector, [dot(row[:-1], place.kernel) for row in bent])
    return Coefficients(dot(covector, [row[-1] for row in slopes]), curvature / 2, dot(covector, place.kernel))


def flip_coefficients(equations: PointEquations, place: BifurcationPoint, normal: Sequence[arb]) -> Coefficients:
    """gamma s + c y^2 at a flip (Lemma 25.3). Raises `ZeroDivisionError` where l or the curve is not enclosed."""
    slopes = equations.slopes(place.where)
    covector = _covector(equations, place, -1, normal)
    regular = equations.minus(1, slopes)
    along = newton_image(regular, [row[-1] for row in slopes])
    bent = equations.curvatures(place.where, [*place.kernel, arb(0)])
    even = newton_image(regular, [dot(row[:-1], place.kernel) / 2 for row in bent])
    third = equations.cubic(place.where, [*place.kernel, arb(0)])
    speed = dot(covector, [dot(row, [*along, arb(1)]) for row in bent])
    bend = dot(covector, [dot(row[:-1], even) + value / 6 for row, value in zip(bent, third, strict=True)])
    return Coefficients(speed, bend, dot(covector, place.kernel))


def _covector(equations: PointEquations, place: BifurcationPoint, sigma: int, normal: Sequence[arb]) -> list[arb]:
    """l with l (D_p E - sigma J) = 0."""
    singular = equations.minus(sigma, equations.slopes(place.where))
    return left_kernel(singular, bordering(singular, normal), normal)
