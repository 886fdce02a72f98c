"""Between catalogue files and symmetric periodic orbits: correcting all orbits of a file, writing families as files."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from orbitproof.explore.families import Family
from orbitproof.explore.flow import FlowFailure, Matrix, Vector, flow_of
from orbitproof.explore.numerics import SHOOTING
from orbitproof.explore.orbits import (
    REMEDY,
    Numbers,
    OrbitBatch,
    ShootingProblem,
    contradictions,
    correct_batch,
    fallen,
    stability_index,
)
from orbitproof.explore.three_body.catalogues.file import Catalogue
from orbitproof.explore.three_body.families import branch_at, branch_of
from orbitproof.explore.three_body.names import resonance_of
from orbitproof.explore.three_body.seeds import LIBRATION_POINTS, libration_point, primaries
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, MASS_PARAMETERS, UNITS, ReversibleSystem

ON_SYMMETRY = 1e-6
"""Largest magnitude of y, vx, vz at which a catalogue's initial state counts as lying on Fix(R)."""


_OFF_PLANE = 0.01
"""Relative height from which on an orbit is said to be a northern or a southern one."""


@dataclass(frozen=True)
class Differences:
    """Corrected orbits against the catalogue's numbers, shape (N,) each; NaN for an orbit that was not corrected.

    Attributes:
        state: distance of the first point.
        jacobi_constant, period: magnitude of the difference.
        stability_index: the same, relative to the index.
    """

    state: Vector
    jacobi_constant: Vector
    period: Vector
    stability_index: Vector


@dataclass(frozen=True)
class CorrectedCatalogue:
    """The orbits of a catalogue, corrected.

    Attributes:
        catalogue: what was read.
        problem: what the orbits solve.
        guesses: shape (N, 4), x, z, vy on Fix(R) and the half period, as they follow from the catalogue.
        batch: the orbits; nothing is left out, what failed is marked.
        failures: N texts, "" for a corrected orbit.
        contradictions: N texts, "" for an orbit of which is so what its row says.
    """

    catalogue: Catalogue
    problem: ShootingProblem
    guesses: Matrix
    batch: OrbitBatch
    failures: tuple[str, ...]
    contradictions: tuple[str, ...]

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the orbits of rows are not taken, N texts; "" for one that is."""
        pairs = zip(self.failures, self.contradictions, strict=True)
        return tuple(f"not corrected: {failure}" if failure else told for failure, told in pairs)

    @cached_property
    def corrected(self) -> np.ndarray:
        """Shape (N,), whether an orbit was, to that of its row."""
        return np.array([not reason for reason in self.reasons])

    @cached_property
    def stability_indices(self) -> Vector:
        """Shape (N,); NaN for an orbit that was not corrected."""
        return np.where(self.corrected, self.batch.stability_indices, np.nan)

    @cached_property
    def differences(self) -> Differences:
        """How far the corrected orbits are from the catalogue's."""
        batch, catalogue = self.batch, self.catalogue
        hidden = np.where(self.corrected, 0.0, np.nan)
        assert batch.first_integrals is not None
        indices = catalogue.stability_indices
        return Differences(
            state=np.linalg.norm((batch.unknowns - self.guesses)[:, :-1], axis=1) + hidden,
            jacobi_constant=np.abs(batch.first_integrals - catalogue.jacobi_constants) + hidden,
            period=np.abs(2 * batch.unknowns[:, -1] - catalogue.periods) + hidden,
            stability_index=np.abs(self.stability_indices - indices) / np.maximum(indices, 1.0),
        )

    def fallen(self, index: int) -> str | None:
        """Why the orbit found is in the fixed space of a symmetry and not that of its row; `None` if it is not."""
        guess, found = self.guesses[index][:-1], self.batch.unknowns[index][:-1]
        return fallen(self.problem.system, self.problem.parameters, guess.tolist(), found.tolist())

    def contradiction(self, index: int) -> str:
        """Why a row is not about the orbit that was found, with both numbers; "" if it is."""
        batch, catalogue, problem = self.batch, self.catalogue, self.problem
        assert batch.first_integrals is not None
        guess, found = self.guesses[index], batch.unknowns[index]
        if (why := self.fallen(index)) is not None:
            return f"another orbit was found: {why}; {REMEDY}"
        said = Numbers(
            problem.initial_state(guess), float(catalogue.periods[index]), float(catalogue.jacobi_constants[index]),
            float(catalogue.stability_indices[index]), rounded=True,
        )  # fmt: skip
        derivative = batch.orbit(index).derivative
        assert derivative is not None
        there = Numbers(
            problem.initial_state(found), 2 * float(found[-1]), float(batch.first_integrals[index]),
            float(self.stability_indices[index]), derivative.error,
        )  # fmt: skip
        lines = contradictions(problem.system, problem.parameter_values(found).tolist(), said, there)
        lines += self._place_contradicts(index)
        return f"another orbit was found: {'; '.join(lines)}; {REMEDY}" if lines else ""

    def _place_contradicts(self, index: int) -> tuple[str, ...]:
        """What a file of halo orbits says of its libration point and its side that is not so of an orbit of it."""
        catalogue, mass = self.catalogue, float(self.catalogue.mass_ratio)
        if catalogue.family != "halo" or self.problem.system is not CR3BP or self.problem.symmetry is not None:
            return ()
        ends = np.zeros((2, 3))
        ends[:, [0, 2]] = self.batch.unknowns[index, :2], self.batch.second_points[index, :2]
        _, smaller = primaries(mass)
        distances = np.linalg.norm(ends - smaller, axis=1)
        far = ends[int(np.argmax(distances))]
        lines, beyond = [], bool(far[0] > smaller[0])
        if catalogue.point in ("1", "2", "3") and beyond != (catalogue.point == "2"):
            there = "L2" if beyond else "L1 or L3"
            lines.append(f"libration point L{catalogue.point} was given, {there} found")
        # Next to the plane both families begin, and a row may have passed their birth.
        side = branch_at(ends, mass) if abs(far[2]) > _OFF_PLANE * float(distances.max()) else None
        if catalogue.branch in ("N", "S") and side is not None and side[0].upper() != catalogue.branch:
            lines.append(f"branch {catalogue.branch} was given, {side[0].upper()} found")
        return tuple(lines)

    @property
    def result(self) -> Catalogue | None:
        """The corrected orbits as a catalogue of the same system and family; `None` if there are none.

        An orbit whose initial state is not on Fix(R) is given by its point there.
        """
        which = np.flatnonzero(self.corrected)
        if not len(which):
            return None
        batch = self.batch
        assert batch.first_integrals is not None
        return replace(
            self.catalogue,
            states=batch.states[which],
            jacobi_constants=batch.first_integrals[which],
            periods=2 * batch.unknowns[which, -1],
            stability_indices=self.stability_indices[which],
            numbers=tuple(int(index) + 1 for index in which),
        )

    def seed(self, index: int) -> Family:
        """The family of one of the orbits, not traced yet. Raises `CorrectionFailure`."""
        orbit = self.batch.orbit(index)
        _, jacobian, _ = self.problem.evaluate(orbit.unknowns)
        tangent = self.problem.tangent(jacobian, np.ones(self.problem.size))
        return Family(self.problem, (orbit,), (tangent,), "limit", "started")


def correct_catalogue(
    catalogue: Catalogue,
    *,
    tolerance: float = SHOOTING.tolerance,
    accept: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> CorrectedCatalogue:
    """Correct every orbit of a catalogue to a symmetric periodic orbit.

    The nearest orbit in the catalogue's system is taken, by steps of least norm. An orbit whose initial state is not on
    Fix(R) must be there a quarter of a period later (a vertical family whose orbits start at the x axis); otherwise it
    is marked as failed. Rows whose numbers are not those of the orbit found are marked too, unless `accept` takes them.
    """
    system, size = system_of(catalogue), _size(catalogue)
    planar = bool(np.all(catalogue.states[:, (2, 5)] == 0))
    scale = (size, size, size, 1.0)
    problem = ShootingProblem(
        system, {"mu": catalogue.mass_ratio}, symmetry="S" if planar else None, scale=scale, tolerance=tolerance
    )
    states, failures = _on_fixed_set(catalogue, system)
    guesses = np.column_stack([states[:, list(system.fixed_coordinates)], 0.5 * catalogue.periods])
    batch = correct_batch(
        system,
        {"mu": float(catalogue.mass_ratio)},
        guesses,
        symmetry=problem.symmetry,
        scale=np.array(scale),
        tolerance=tolerance,
        progress=progress,
    )
    together = tuple(own or other for own, other in zip(failures, batch.failures, strict=True))
    corrected = CorrectedCatalogue(catalogue, problem, guesses, batch, together, ("",) * len(together))
    if accept:
        return corrected
    told = (corrected.contradiction(index) if not why else "" for index, why in enumerate(together))
    return replace(corrected, contradictions=tuple(told))


def system_of(catalogue: Catalogue) -> ReversibleSystem:
    """The system of whose reversing symmetry the orbits are: axial orbits are symmetric about the x axis.

    Where the file names no family a state says it, and of an orbit that starts on the axis the one a quarter of a
    period later: vertical orbits are in the plane of symmetry there.
    """
    if catalogue.family:
        return CR3BP_AXIAL if catalogue.family == "axial" else CR3BP
    state = catalogue.states[len(catalogue) // 2]
    off_plane, off_axis = (float(np.max(np.abs(state[_odd(system)]))) for system in (CR3BP, CR3BP_AXIAL))
    if off_plane <= ON_SYMMETRY or off_axis > ON_SYMMETRY:
        return CR3BP
    failures = _on_fixed_set(catalogue.chosen(np.array([len(catalogue) // 2])), CR3BP)[1]
    return CR3BP_AXIAL if failures[0] else CR3BP


def _odd(system: ReversibleSystem) -> list[int]:
    return [index for index, sign in enumerate(system.reversing_symmetry) if sign == -1]


def _on_fixed_set(catalogue: Catalogue, system: ReversibleSystem) -> tuple[Matrix, list[str]]:
    """A point of each orbit on Fix(R), shape (N, 6), and for the orbits without one why."""
    states, failures = catalogue.states.copy(), [""] * len(catalogue)
    mass = [float(catalogue.mass_ratio)]
    odd = _odd(system)
    for i, state in enumerate(states):
        if np.max(np.abs(state[odd])) <= ON_SYMMETRY:
            continue
        try:
            later = flow_of(system).derivative(state, 0.25 * catalogue.periods[i], mass).state
        except FlowFailure as error:
            failures[i] = str(error)
            continue
        if np.max(np.abs(later[odd])) > 100 * ON_SYMMETRY:
            failures[i] = "no point on Fix(R): neither the initial state nor the one a quarter of a period later"
            continue
        states[i] = later
    return states, failures


def _size(catalogue: Catalogue) -> float:
    name = f"L{catalogue.point}"
    return libration_point(name if name in LIBRATION_POINTS else "L1", catalogue.mass_ratio).distance


def catalogue_of(family: Family, name: str, label: str) -> Catalogue:
    """A traced CR3BP family in the catalogue's form; `name`, `label` as in `explore.families.tracing.TracedFamily`."""
    problem, orbits = family.problem, family.orbits
    point, _, rest = name.partition("-")
    numbered = point in LIBRATION_POINTS
    resonance, units = resonance_of(name), UNITS.get(problem.parameters["mu"])
    side = branch_of(family)
    branch = "" if side is None else side[0].upper()
    if resonance is not None:
        branch = f"{resonance[0]}{resonance[1]}"
    elif name.startswith("lpo-"):
        branch = rest[:1].upper()
    return Catalogue(
        mass_ratio=problem.parameters["mu"],
        states=np.array([problem.initial_state(orbit.unknowns) for orbit in orbits]),
        jacobi_constants=np.array([orbit.first_integral for orbit in orbits], dtype=float),
        periods=np.array([orbit.period for orbit in orbits]),
        stability_indices=np.array([stability_index(orbit.stability) for orbit in orbits]),
        system=system_name(label),
        family=rest.partition("-")[0] if numbered else point,
        point=point[1:] if numbered else "",
        branch=branch,
        system_details={} if units is None else dict(units.details),
    )


def system_name(label: str) -> str:
    """The name of a system as the catalogue writes it, Earth-Moon, from that of its mass parameter."""
    known = label in MASS_PARAMETERS
    return "-".join(part.capitalize() for part in label.removeprefix("jpl-").split("-")) if known else label


def libration_places(mass_ratio: float) -> dict[str, Vector]:
    """Positions of the five libration points, shape (3,) each."""
    places = {name: np.array([libration_point(name, mass_ratio).x, 0.0, 0.0]) for name in LIBRATION_POINTS}
    height = 0.5 * float(np.sqrt(3.0))
    return places | {name: np.array([0.5 - mass_ratio, sign * height, 0.0]) for name, sign in (("L4", 1), ("L5", -1))}
