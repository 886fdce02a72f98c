"""Periodic orbits as values: states, stability, ephemerides, manifolds, tori.

Everything is in nondimensional units and in double precision unless units are named. Nothing is proved here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from importlib import import_module
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from orbitproof.explore.flow import flow_of
from orbitproof.explore.names import told_apart
from orbitproof.explore.orbits import ShootingProblem, SymmetricOrbit, multipliers, stability_index
from orbitproof.explore.refinement import OrbitTask, refine_orbit
from orbitproof.explore.three_body.plots import draw_orbits
from orbitproof.explore.three_body.trajectories import (
    Choice,
    Frame,
    SampledOrbit,
    SourceOrbit,
    Trajectory,
    Units,
    centre_number,
    ephemeris_of,
    ephemeris_text,
    epoch_of,
    error_of_message,
    find_orbit,
    origin_named,
    sample,
    seconds_of,
    trajectory_of,
    units_named,
    write_csv,
    write_spk,
)
from orbitproof.shared.formats import COORDINATE, HALF_PERIOD, LEVEL, Candidate, Equation, write_text
from orbitproof.shared.systems import CR3BP, LEVEL_NAME, THREE_BODY, ReversibleSystem, System, own_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from orbitproof.explore.three_body.ephemeris_model import RealOrbit
    from orbitproof.explore.three_body.invariants import Manifold, TorusFamily

File = str | PathLike[str]
DAY = 86400.0


@dataclass(frozen=True, repr=False)
class Orbit:
    """A periodic orbit, in double precision.

    Attributes:
        system: what it is an orbit of.
        parameters: all parameters of the vector field, by name.
        point: shape (m,), the state at time 0, on Fix(R).
        period: the full period, in the system's time units (CR3BP: 2 pi for one turn of the primaries).
        first_integral: the Jacobi constant in the CR3BP; `None` for a system with a family parameter.
        stability: the n stability parameters (lambda + 1/lambda)/2; between -1 and 1: stable in that direction.
        arclength: along its family from the first orbit, in the family's scaled unknowns.
        units: of length and time, if they are known; `with_units` gives others.
    """

    system: System
    parameters: Mapping[str, float]
    point: NDArray[np.float64]
    period: float
    first_integral: float | None
    stability: tuple[complex, ...]
    arclength: float
    units: Units | None = None
    _source: SourceOrbit | None = None

    @property
    def multipliers(self) -> tuple[complex, ...]:
        """The eigenvalues of the return map's derivative, those of the monodromy matrix without the trivial pair."""
        return multipliers(self.stability)

    @property
    def stability_index(self) -> float:
        """The mean of the absolute value of the largest multiplier and of the inverse of that."""
        return stability_index(self.stability)

    @property
    def period_days(self) -> float:
        """The period in days. Raises `ValueError` where no units are known."""
        return self.period * self._needed_units().time / DAY

    def with_units(self, units: Units | str) -> Orbit:
        """This orbit with units of length and time: `explore.Units(km, s, source)`, or the name of a system."""
        return replace(self, units=units_named(units, self.parameters.get("mu")))

    def state_transition(self, time: float | None = None) -> NDArray[np.float64]:
        """The state transition matrix from `point` over a time, shape (m, m); over the period: the monodromy matrix.

        Raises `FlowFailure` where the orbit cannot be followed.
        """
        if not isinstance(self.system, ReversibleSystem):
            raise ValueError(f"{self.system.name}: the matrix is computed for systems with a reversing symmetry")
        over = self.period if time is None else float(time)
        values = [self.parameters[name] for name in self.system.parameters]
        return flow_of(self.system).derivative(self.point, over, values).state_transition

    def states(self, times: ArrayLike) -> NDArray[np.float64]:
        """The states at given times, of any sign; the orbit is periodic.

        Arguments:
            times: shape (N,), in the system's time units, 0 at `point`.

        Returns shape (N, m), columns in the order of `system.state` (CR3BP: x, y, z, vx, vy, vz).
        """
        return self._trajectory.states(times)

    def astropy(self, count: int = 200) -> tuple[Any, Any, Any]:
        """Times, places and velocities over a period as astropy quantities: s, km, km/s; shapes (count,), (count, 3).

        Raises `ValueError` where no units are known, and `ModuleNotFoundError` where astropy is missing.
        """
        units = self._needed_units()
        try:
            names: Any = import_module("astropy.units")
        except ModuleNotFoundError:
            raise ModuleNotFoundError("astropy() needs astropy: pip install astropy", name="astropy") from None
        times, states = self.trajectory(count)
        places, velocities = states[:, :3] * units.length, states[:, 3:] * units.velocity
        return times * units.time * names.s, places * names.km, velocities * (names.km / names.s)

    def sample(
        self,
        *,
        in_km: bool = False,
        frame: str = "rotating",
        origin: str = "barycentre",
        periods: float = 1.0,
        count: int | None = None,
        error: float | None = None,
    ) -> SampledOrbit:
        """The orbit at times as dense as interpolation of degree 7 needs: `times`, `states`, and the `error` it has.

        Arguments:
            in_km: km and s, otherwise nondimensional.
            frame: "rotating" or "inertial".
            origin: "barycentre", "larger", "smaller" or the name of a body.
            periods: how many.
            count: of states at equal intervals, in place of `error`.
            error: largest error of interpolated places, in the unit of length (1 m, or 1e-9 if nondimensional).

        Raises `InputError`, and `TooFine` for an error that no number of states gives.
        """
        source = self._trajectory.source
        place = Frame(frame, origin_named(origin, source.primaries))
        units = self._needed_units() if in_km else None
        return sample(self._trajectory, frame=place, units=units, periods=periods, count=count, error=error)

    def to_csv(self, path: File, **options: Any) -> None:
        """Write states over time as CSV, with what they are; the options are those of `sample`."""
        write_csv(Path(path), self.sample(**options))

    def to_oem(self, path: File, *, epoch: str = "2000-01-01T12:00:00", **options: Any) -> float:
        """Write a CCSDS ephemeris message in km (extra `oem`), options as for `sample`; the epoch, TDB, is a label.

        Returns the error of the interpolation, km, of the message as it is read back.
        """
        ephemeris = ephemeris_of(self.sample(in_km=True, **options), epoch_of(epoch))
        text = ephemeris_text(ephemeris)
        found = error_of_message(text, ephemeris)
        write_text(Path(path), text)
        return float("nan") if found is None else found

    def to_spk(
        self,
        path: File,
        *,
        epoch: str = "2000-01-01T12:00:00",
        body: int = -100000,
        centre: int | None = None,
        axes: str = "ECLIPJ2000",
        **options: Any,
    ) -> float:
        """Write a kernel for SPICE (extra `spk`), type 13, in axes that do not turn; date and axes are labels.

        Arguments:
            body, centre: SPICE's numbers; the centre follows from the name of the origin where that is known.
            axes: a name of axes that SPICE knows.
            options: those of `sample`.

        Returns the error of the interpolation, km, of the kernel as SPICE reads it.
        """
        samples = self.sample(in_km=True, frame="inertial", **options)
        number = centre_number(samples.frame.origin, self._trajectory.source.primaries, centre)
        ephemeris = ephemeris_of(samples, epoch_of(epoch), "to_spk")
        return write_spk(Path(path), ephemeris, body=body, centre=number, frame=axes)

    def manifold(
        self,
        plane: tuple[str, float],
        *,
        kind: str = "unstable",
        side: int = 1,
        lines: int = 60,
        offset: float = 1e-5,
        longest: float = 20.0,
    ) -> Manifold:
        """The tube of orbits that leave an unstable orbit, or come to it, up to a plane such as ("x", 0.98785).

        Arguments:
            kind: "unstable" or "stable".
            side: 1 or -1, of the orbit, in x.
            lines, offset, longest: orbits of the tube, where they start, and the time after which one is given up.

        Raises `NoManifold`.
        """
        from orbitproof.explore.three_body.invariants import Plane, manifold_of

        if self.system not in THREE_BODY or plane[0] not in ("x", "y", "z"):
            raise ValueError(f"manifold: of orbits of the CR3BP, to a plane of x, y or z; {plane[0]!r} is none")
        return manifold_of(
            self._trajectory.solution, self.parameters["mu"], index=self.stability_index, kind=kind, side=side,
            plane=Plane("xyz".index(plane[0]), plane[1]), count=lines, offset=offset, longest=longest,
        )  # fmt: skip

    def tori(self, *, pair: int = 1, curves: int = 40, step: float = 0.01) -> TorusFamily:
        """Invariant tori around an orbit of the CR3BP with multipliers on the unit circle, from small to large.

        Arguments:
            pair: which elliptic pair of multipliers, by stability parameter.
            curves: at most so many.
            step: the longest along the family.

        Raises `NoCurve`.
        """
        from orbitproof.explore.three_body.invariants import trace_tori

        if self.system is not CR3BP or self._trajectory.crossings != 1:
            raise ValueError("tori: of orbits of the CR3BP whose half meets the section y = 0 once")
        return trace_tori(self._trajectory.orbit, self.parameters["mu"], index=pair - 1, largest_step=step, most=curves)

    def carry_over(
        self,
        kernels: Sequence[File],
        bodies: Sequence[str],
        *,
        epoch: str,
        gm: Mapping[str, float] | None = None,
        periods: float = 1.0,
    ) -> RealOrbit:
        """The orbit among bodies that move as kernels for SPICE say (extra `spk`): numerical, by multiple shooting.

        Arguments:
            kernels: files.
            bodies: the larger primary, the smaller one, all others.
            epoch: of the first state, TDB.
            gm: km^3/s^2, of bodies whose GM no kernel has.
            periods: for how many it is followed.

        Raises `NotCarried` and `InputError`. Its states are asked for while the kernels are loaded into SPICE or not.
        """
        from orbitproof.explore.three_body.ephemeris_model import bodies_named, carry_over, kernels_loaded

        with kernels_loaded([Path(kernel) for kernel in kernels]):
            named = bodies_named(bodies, gm or {})
            return carry_over(self._trajectory, named, seconds_of(epoch_of(epoch)), periods=periods)

    def claim(self, quantity: str, value: Fraction | int | str, *, digits: int = 50, id: str = "orbit") -> Candidate:
        """The claim that there is exactly one symmetric orbit near this one with a value, for `verify.certify`.

        Arguments:
            quantity: "period", "level" (of the first integral), or one of `system.centre_coordinates`. Where a
                coordinate is called so, that is meant, and "(period)", "(level)" are those of the orbit.
            value: exact: `Fraction`, int, or text such as "0.1" or "3/2".
            digits: decimal digits of the point.
            id: of the claim.

        Raises `RefinementFailure`, one line, if Newton's method does not come to an orbit.
        """
        source, exact = self._trajectory.source, Fraction(value)
        if source.unknowns is None or not isinstance(self.system, ReversibleSystem):
            raise ValueError("claim: of symmetric orbits; refine_new_orbit and refine_periodic make those of others")
        coordinates = self.system.centre_coordinates
        period, level = told_apart(("period", "level"), coordinates)
        if quantity in coordinates:
            equation = Equation(COORDINATE, exact, quantity)
        elif quantity in (period, own_name("period")):
            equation = Equation(HALF_PERIOD, exact / 2)
        elif quantity in (level, LEVEL_NAME) and self.system.first_integral is not None:
            equation = Equation(LEVEL, exact)
        else:
            known = ", ".join((period, level, *coordinates))
            raise ValueError(f"quantity: {quantity!r} is unknown; there are {known}")
        fixed = {name: source.parameters[name] for name in self.system.fixed_parameters}
        guess = tuple(map(float, source.unknowns[:-1]))
        task = OrbitTask(id, self.system, fixed, equation, guess, digits, {}, self._trajectory.crossings)
        return refine_orbit(task)

    def plot(self) -> Figure:
        """The orbit in two projections, a matplotlib figure (extra `figures`)."""
        mass = self.parameters["mu"] if self.system in THREE_BODY else None
        length = None if self.units is None else self.units.length
        return draw_orbits(repr(self)[1:-1], [self.trajectory(800)[1]], self.system.state, mass, length)

    def trajectory(self, count: int = 200) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """`count` equidistant times over one period, shape (count,), and the states, shape (count, m)."""
        times = np.linspace(0.0, self.period, count)
        return times, self.states(times)

    def _needed_units(self) -> Units:
        if self.units is None:
            raise ValueError(
                "units: not known; give them: orbit.with_units('jpl-earth-moon'), or explore.Units(km, seconds, source)"
            )
        return self.units

    @cached_property
    def _trajectory(self) -> Trajectory:
        source = self._source
        if source is None:
            system = self.system
            assert isinstance(system, ReversibleSystem)
            lead = [] if system.family_parameter is None else [self.parameters[system.family_parameter]]
            unknowns = np.array([*lead, *(self.point[i] for i in system.fixed_coordinates), self.period / 2])
            exact = {name: Fraction(value) for name, value in self.parameters.items()}
            source = SourceOrbit(system, exact, unknowns, repr(self)[1:-1], "not proved: traced numerically")
        return trajectory_of(source)

    def __repr__(self) -> str:
        return f"<Orbit of {self.system.name}: period {self.period:.10g}{level_text(self)}>"


def read_orbit(
    path: File,
    *,
    id: str | None = None,
    family: str | None = None,
    number: int | None = None,
    accept: bool = False,
) -> Orbit:
    """The orbit that a file names: candidates, certificates, families, branches, an atlas, tori, a catalogue.

    Arguments:
        id: of the candidate, certificate or branch.
        family: the family of a family file.
        number: of the orbit, counted from 1; of a branch from its birth, negative on the other side.
        accept: the orbit that is found, though the file says something else of its state, period, level or stability.

    Raises `InputError` for bad files and choices and `NoOrbit` if there is none, or another one than the file says.
    """
    source = find_orbit(Path(path), Choice(id, family, number, accept))
    trajectory = trajectory_of(source)
    return Orbit(
        system=source.system,
        parameters=trajectory.parameters,
        point=trajectory.start,
        period=trajectory.period,
        first_integral=trajectory.first_integral,
        stability=trajectory.stability or (),
        arclength=0.0,
        units=source.units,
        _source=trajectory.source,
    )


def orbit_value(problem: ShootingProblem, orbit: SymmetricOrbit, units: Units | None = None) -> Orbit:
    """The value for an orbit of a family."""
    values = problem.parameter_values(orbit.unknowns)
    exact = dict(problem.parameters)
    return Orbit(
        system=problem.system,
        parameters=dict(zip(problem.system.parameters, values.tolist(), strict=True)),
        point=problem.initial_state(orbit.unknowns),
        period=orbit.period,
        first_integral=orbit.first_integral,
        stability=orbit.stability,
        arclength=orbit.arclength,
        units=units,
        _source=SourceOrbit(
            problem.system, exact, orbit.unknowns, f"orbit of {problem.system.name}", "not proved: traced numerically"
        ),
    )


def level_text(orbit: Orbit) -> str:
    """The level or the parameter of an orbit, to be put behind something else."""
    name = orbit.system.family_parameter if isinstance(orbit.system, ReversibleSystem) else None
    if name is not None:
        return f", {name} = {orbit.parameters[name]:.10g}"
    if orbit.first_integral is None:
        return ""
    return f", {orbit.system.first_integral_name} = {orbit.first_integral:.10g}"
