"""The search for scripts and notebooks; `orbitproof.explore` hands these names on.

Everything is in nondimensional units and in double precision, except what `refine` gives. Nothing is proved here.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from math import inf

import numpy as np
from numpy.typing import NDArray

from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import (
    FamilyFailure,
    Limits,
    TracedFamily,
    TraceTask,
    detect,
    limited_names,
    trace_task,
)
from orbitproof.explore.names import exact_parameters, label_of
from orbitproof.explore.refinement import RefinementFailure, refine_tasks
from orbitproof.explore.search import POINTS, Target, targets_of
from orbitproof.explore.seeds import FirstOrbit
from orbitproof.explore.three_body.families import branch_of, trace_family
from orbitproof.explore.three_body.names import (
    DEFAULT_BRANCH,
    FAMILY_NAMES,
    Branch,
    exchanged,
    exchanged_in,
    families_to_give,
    family_name,
    is_family_name,
    name_on,
)
from orbitproof.explore.three_body.trajectories import units_of
from orbitproof.explore.values import Orbit, OrbitFamily, level_text, orbit_value
from orbitproof.shared.formats import Candidate, InputError
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import CR3BP, CR3BP_AXIAL, MASS_PARAMETERS, ReversibleSystem


@dataclass(frozen=True, repr=False)
class ResonantOrbit:
    """An orbit at which a family bifurcates, located in double precision.

    Attributes:
        id: which one it is: system or mass, family, k, and its number along the family.
        kind: one of `shared.KINDS`.
        k: multiplicity, 1 for symmetry breaking and folds.
        orbit: the orbit itself.
        point: shape (1 + n,), where it meets Fix(R) and new orbits appear, in the order of `system.centre_coordinates`.
    """

    id: str
    kind: str
    k: int
    orbit: Orbit
    point: NDArray[np.float64]
    _target: Target

    def __repr__(self) -> str:
        return f"<ResonantOrbit {self.id}: {self.kind}{level_text(self.orbit)}>"


def families_of(system: ReversibleSystem) -> tuple[str, ...]:
    """The names of the families that can be traced.

    >>> from orbitproof import explore
    >>> from orbitproof.shared import FALKNER_SKAN
    >>> explore.families_of(FALKNER_SKAN)
    ('odd',)
    """
    return FAMILY_NAMES.get(system.name, ())


def trace(
    system: ReversibleSystem,
    name: str,
    *,
    mu: Fraction | float | str | None = None,
    z_max: float | None = None,
    vy_max: float | None = None,
    beta: tuple[float, float] | None = None,
    jacobi_min: float | None = None,
    max_orbits: int = Limits.max_orbits,
    branch: Branch = DEFAULT_BRANCH,
    quiet: bool = False,
) -> OrbitFamily:
    """Follow a family of symmetric periodic orbits through its folds, up to the first limit that it reaches.

    Arguments:
        system: `shared.CR3BP` or `shared.FALKNER_SKAN`.
        name: one of `families_of(system)`, in any case; "L1-halo-2", "L1-halo-3", .. are later branches of the planar
            family. Of the CR3BP also "L1-axial", ..: families of `shared.systems.CR3BP_AXIAL`.
        mu: mass parameter of the CR3BP, in (0, 1/2]: a `Fraction` or a decimal text is taken exactly, a float as the
            double that it is.
        z_max, vy_max: largest absolute value of that coordinate of the first point on Fix(R).
        beta: smallest and largest parameter of the Falkner-Skan equation; (100, 1000) by default.
        jacobi_min: smallest Jacobi constant.
        max_orbits: largest number of orbits.
        branch: "north" or "south", of halo families and those that branch off from them: the sign of z where their
            orbits are farthest from the smaller primary.
        quiet: nothing on standard error; else progress with the time that is left.

    Returns the family, which says why it ends (`reason`); what the continuation could not follow is "failed" there.

    Raises `ValueError` for an unknown name and for a parameter that is missing, too many or out of range, and
    `FamilyFailure` if not even a first orbit is found.

    >>> from orbitproof import explore
    >>> from orbitproof.shared import CR3BP, EARTH_MOON
    >>> explore.trace(CR3BP, "L7-halo", mu=EARTH_MOON)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    ValueError: name: 'L7-halo' is no family of cr3bp; there are L1-halo, L2-halo, L3-halo, L1-lyapunov, ...
    >>> explore.trace(CR3BP, "L1-halo")
    Traceback (most recent call last):
    ValueError: mu: missing; give the mass parameter of cr3bp, in (0, 1/2], for example shared.EARTH_MOON
    """
    name = family_name(name)
    if system.name == CR3BP.name and is_family_name(CR3BP_AXIAL.name, name):
        system = CR3BP_AXIAL
    if not is_family_name(system.name, name):
        known = families_to_give(system.name, name) or "none"
        raise ValueError(f"name: {name!r} is no family of {system.name}; there are {known}")
    parameters = _parameters(system, mu)
    for option, value in (("z_max", z_max), ("vy_max", vy_max), ("jacobi_min", jacobi_min)):
        if value is not None and system.family_parameter is not None:
            raise ValueError(f"{option}: {system.name} has no such limit; give beta=(smallest, largest)")
    if beta is not None and system.family_parameter is None:
        raise ValueError(f"beta: {system.name} has no such parameter; there are z_max, vy_max and jacobi_min")
    smallest, largest = (-inf, inf) if beta is None else beta
    if beta is not None and not 1 < smallest < largest:
        raise ValueError(f"beta: ({smallest:g}, {largest:g}) is no interval above 1")
    bounds = {coordinate: bound for coordinate, bound in (("z", z_max), ("vy", vy_max)) if bound is not None}
    limits = Limits(
        max_orbits, coordinate_max=bounds, parameter_min=smallest, parameter_max=largest, integral_min=jacobi_min
    )
    label = next((key for key, value in MASS_PARAMETERS.items() if parameters.get("mu") == value), "")
    with Reporter(quiet) as report:
        report.stage(name)
        family = trace_family(system, name, parameters, limits, branch=branch, progress=report.update)
    if family.outcome == "interrupted":
        raise KeyboardInterrupt
    traced = TracedFamily(name_on(name, branch), label, family, branch=branch_of(family))
    return OrbitFamily(traced.name, system, family.outcome, family.reason, traced, units_of(parameters.get("mu")))


def trace_from(
    system: ReversibleSystem,
    start: Mapping[str, float],
    *,
    parameters: Mapping[str, Fraction | int | str] | None = None,
    half_period: float | None = None,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    max_orbits: int = Limits.max_orbits,
    name: str = "family",
    quiet: bool = False,
) -> OrbitFamily:
    """Follow the family of an approximate symmetric orbit, of any system, to both sides.

    Arguments:
        system: one of `shared`, or your own from `shared.load_system`.
        start: where the orbit meets Fix(R): all of `system.centre_coordinates` by name.
        parameters: the fixed parameters, exact: `Fraction`, int, or text such as "0.1" or "1/3".
        half_period: time to the other point on Fix(R), in the system's units; found if it is not given.
        bounds: smallest and largest value of a coordinate of `start`, of "half-period" or of "integral".
        max_orbits, quiet: as for `trace`.
        name: what to call the family.

    Returns the family. Raises `ValueError` for what is missing or unknown and `FamilyFailure` if no orbit is found.
    """
    wanted, limited = system.centre_coordinates, limited_names(system)
    if set(start) != set(wanted):
        raise ValueError(f"start: {', '.join(start)}; give {', '.join(wanted)}")
    for key in bounds or {}:
        if key not in limited:
            raise ValueError(f"bounds: {key!r} is unknown; there are {', '.join(limited)}")
    texts = {key: str(value) for key, value in (parameters or {}).items()}
    try:
        exact = exact_parameters(system, texts, why_not=exchanged_in)
    except InputError as error:
        raise ValueError(str(error)) from None
    task = TraceTask(
        system=system,
        name=name,
        label=label_of(system, None, [f"{key}={text}" for key, text in texts.items()]),
        parameters=exact,
        limits=Limits(max_orbits, bounds=dict(bounds or {})),
        multiplicities=(),
        start=FirstOrbit(tuple(float(start[key]) for key in wanted), half_period),
    )
    with Reporter(quiet) as report:
        report.stage(name)
        found = trace_task(task, report.update)
    if found.interrupted:
        raise KeyboardInterrupt
    if found.item is None:
        raise FamilyFailure(f"{name}: {found.failure}")
    family = found.item.family
    traced = replace(found.item, branch=branch_of(family))
    return OrbitFamily(name, system, family.outcome, family.reason, traced)


def resonances(
    family: OrbitFamily,
    k: int | Iterable[int] = (1, 2, 3, 4),
    *,
    folds: bool = False,
    points: str = "one",
    sampling_timeout: float = 600.0,
    quiet: bool = False,
) -> list[ResonantOrbit]:
    """The orbits of a family at which it is in 1:k resonance, for k = 1 those at which its symmetry breaks.

    Arguments:
        k: one multiplicity or several, each at least 1.
        folds: whether the extrema of the family parameter or first integral along the family are wanted too.
        points: "one", "distinct" or "all": whether a claim about the other point of an orbit on Fix(R) is wanted too,
            where new orbits appear at both.
        sampling_timeout: seconds after which the stability is not sampled further along the family.
        quiet: nothing on standard error.

    Returns them in order along the family; an empty list where there are none. Places at which it cannot be told
    whether there is one are named on standard error. Raises `ValueError` for what is no multiplicity.
    """
    wanted = [k] if isinstance(k, int) else list(k)
    for value in wanted:
        if not isinstance(value, int) or value < 1:
            raise ValueError(f"k: {value!r} is no multiplicity; give integers, at least 1")
    if points not in POINTS:
        raise ValueError(f"points: {points!r} is unknown; there are {', '.join(POINTS)}")
    traced = family._traced
    if not traced.system.symmetries:
        wanted = [value for value in wanted if value > 1]
    with Reporter(quiet) as report:
        report.stage(f"{family.name}: resonances")
        detection = detect(traced.family, wanted, with_folds=folds, timeout=sampling_timeout)
        for line in detection.undecided:
            report.message(line)
    return [
        ResonantOrbit(
            target.id, target.resonance.kind, target.resonance.k,
            orbit_value(traced.family.problem, target.resonance.orbit), target.guess, target,
        )
        for target in targets_of(replace(traced, detection=detection), points)
    ]  # fmt: skip


def refine(resonance: ResonantOrbit, *, digits: int = 50, quiet: bool = False) -> Candidate:
    """The bifurcation point to many digits, with box and frames: a claim for `verify.certify`.

    Arguments:
        digits: decimal digits of the centre.
        quiet: nothing on standard error.

    Raises `RefinementFailure`, one line, if Newton's method does not come to a point.
    """
    if digits < 1:
        raise ValueError(f"digits: {digits!r} is not positive")
    with Reporter(quiet) as report:
        report.stage(f"refining {resonance.id}")
        ((_, result),) = refine_tasks([resonance._target.task(digits)], 1, report.update)
    if result.candidate is None:
        raise RefinementFailure(f"{resonance.id}: not refined: {result.failure}")
    return result.candidate


def _parameters(system: ReversibleSystem, mu: Fraction | float | str | None) -> dict[str, Fraction]:
    if not system.fixed_parameters:
        if mu is not None:
            raise ValueError(f"mu: {system.name} has no mass parameter; leave it out")
        return {}
    if mu is None:
        raise ValueError(
            f"mu: missing; give the mass parameter of {system.name}, in (0, 1/2], for example shared.EARTH_MOON"
        )
    try:
        value = MASS_PARAMETERS.get(mu) or parse_exact(mu) if isinstance(mu, str) else Fraction(mu)
    except (ValueError, OverflowError):
        raise ValueError(f"mu: {mu!r} is no number; names are {', '.join(MASS_PARAMETERS)}") from None
    if not 0 < value < 1:
        raise ValueError(f"mu: {mu} lies outside (0, 1/2]; give the smaller mass over the total mass")
    if (why := exchanged(value)) is not None:
        raise ValueError(f"mu: {mu} is {why}")
    return {"mu": value}
