"""Equilibria and Hopf points as claims for the verifier."""

from __future__ import annotations

from fractions import Fraction

from orbitproof.explore.engines import Progress
from orbitproof.explore.periodic.correction import PeriodicProblem
from orbitproof.explore.periodic.equilibria import Equilibrium
from orbitproof.explore.periodic.equilibrium_refinement import refined_equilibrium
from orbitproof.explore.periodic.hopf import Hopf
from orbitproof.explore.periodic.refinement import box_exponent
from orbitproof.explore.refinement import RefinementFailure
from orbitproof.shared import claims


def equilibrium_claim(
    problem: PeriodicProblem, found: Equilibrium, name: str, digits: int, progress: Progress | None = None
) -> claims.Equilibrium:
    """The claim about an equilibrium, to so many digits. Raises `RefinementFailure`."""
    _, solution = refined_equilibrium(problem, None, found.point, (), digits, progress)
    return claims.Equilibrium(
        id=name,
        system=problem.system,
        parameters=dict(problem.parameters),
        centre=tuple(solution.unknowns),
        radii=(_radius(digits),) * len(solution.unknowns),
        provenance={"digits": digits, "newton_steps": solution.steps},
    )


def hopf_claim(found: Hopf, name: str, digits: int, progress: Progress | None = None) -> claims.HopfPoint:
    """The claim about a Hopf point, to so many digits. Raises `RefinementFailure`."""
    if found.side is None:
        raise RefinementFailure(
            f"the speed, {found.speed:.3g}, or the first Lyapunov coefficient, {found.lyapunov:.3g}, vanishes there; "
            "of such a point there is no claim"
        )
    guess = [*found.equilibrium.point, found.value, found.frequency]
    vectors = [found.vector.real, found.vector.imag]
    equations, solution = refined_equilibrium(found.problem, found.name, guess, vectors, digits, progress)
    n, unknowns, radius = equations.size, solution.unknowns, _radius(digits)
    parameters = {
        each: unknowns[n] if each == found.name else exact for each, exact in found.problem.parameters.items()
    }
    return claims.HopfPoint(
        id=name,
        system=found.problem.system,
        parameters=parameters,
        parameter=found.name,
        parameter_radius=radius,
        centre=tuple(unknowns[:n]),
        radii=(radius,) * n,
        frequency=unknowns[n + 1],
        frequency_radius=radius,
        kernel=tuple(tuple(vector) for vector in equations.vectors(unknowns)),
        kernel_radius=radius,
        provenance={"digits": digits, "newton_steps": solution.steps},
    )


def _radius(digits: int) -> Fraction:
    return Fraction(1, 2 ** box_exponent(digits, 1.0))
