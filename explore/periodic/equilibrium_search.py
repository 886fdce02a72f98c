"""Equilibria of any system, from a guess or from many starts, up to claims for the verifier."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.explore.engines import Progress
from orbitproof.explore.periodic.correction import PeriodicFailure, PeriodicProblem
from orbitproof.explore.periodic.equilibria import Equilibrium, equilibria_from_many_starts, equilibrium_near
from orbitproof.explore.periodic.hopf import place_of
from orbitproof.shared.printed_tables import aligned
from orbitproof.shared.systems import FORCE_AT_START, System


@dataclass(frozen=True, repr=False)
class FoundEquilibrium:
    """An equilibrium in float64, of a system with all its parameters."""

    problem: PeriodicProblem
    equilibrium: Equilibrium

    def __repr__(self) -> str:
        return "\n".join(equilibrium_described(self))


class FoundEquilibria(list[FoundEquilibrium]):
    """Equilibria in the order in which they were found; it prints as a table."""

    def __repr__(self) -> str:
        rows = [("", "unstable", "eigenvalue with the greatest real part", "point")]
        for place, found in enumerate(self):
            point = ", ".join(f"{value:.7g}" for value in found.equilibrium.point)
            first = eigenvalues_in_words(found.equilibrium, 1)
            rows.append((f"[{place}]", f"{found.equilibrium.unstable}", first, point))
        return "\n".join(aligned(rows)) if self else "no equilibria"


def find_equilibria(
    system: System, parameters: Mapping[str, Fraction], start: tuple[float, ...] | None, progress: Progress
) -> Iterator[FoundEquilibrium]:
    """The equilibrium near a start, or, without one, those that are found from many, one after another.

    Arguments:
        parameters: all of the system's, exact.
        start: shape (N,), without coordinates that are functions of others.

    Raises `PeriodicFailure` if there is none.
    """
    if {*FORCE_AT_START} <= {*system.state}:
        raise PeriodicFailure("there are none with a periodic force; look for periodic orbits: explore periodic")
    problem = PeriodicProblem(system, parameters)
    if start is not None:
        yield FoundEquilibrium(problem, equilibrium_near(problem, start))
        return
    some = False
    for found in equilibria_from_many_starts(problem, lambda done: progress("", done)):
        some = True
        yield FoundEquilibrium(problem, found)
    if not some:
        raise PeriodicFailure("no equilibrium is found from the starts that are tried; give one near it")


def eigenvalues_in_words(found: Equilibrium, most: int | None = None) -> str:
    """The eigenvalues, the largest real part first; of a pair the one with the positive imaginary part, with +-."""
    words = []
    for value in found.eigenvalues[found.eigenvalues.imag >= 0][:most]:
        words.append(f"{value.real:.10g}" + (f" +- {value.imag:.10g}i" if value.imag else ""))
    return ", ".join(words)


def equilibrium_described(found: FoundEquilibrium) -> list[str]:
    """An equilibrium in lines."""
    unstable = found.equilibrium.unstable or "none"
    return [
        f"equilibrium: {place_of(found.problem, found.equilibrium.point)}",
        f"  eigenvalues: {eigenvalues_in_words(found.equilibrium)}; {unstable} with a positive "
        "real part",
    ]  # fmt: skip


def equilibrium_as_json(found: FoundEquilibrium) -> dict[str, Any]:
    """An equilibrium for programs."""
    return {
        "system": found.problem.system.name,
        "parameters": found.problem.parameters,
        "point": dict(zip(found.problem.system.given_state, found.equilibrium.point, strict=True)),
        "eigenvalues": found.equilibrium.eigenvalues,
        "unstable": found.equilibrium.unstable,
    }
