"""A bifurcation point from elsewhere, refined to a claim."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np

from orbitproof.explore.engines import Reporter
from orbitproof.explore.families import kind_of
from orbitproof.explore.names import exact_parameters, label_of, short_name
from orbitproof.explore.orbits import Numbers, contradictions, fallen
from orbitproof.explore.refinement import RefinementFailure, Task, refine_task
from orbitproof.explore.three_body.names import exchanged_in
from orbitproof.shared.formats import ACROSS_KINDS, DOUBLE_RESONANCE, KINDS, Candidate, InputError
from orbitproof.shared.systems import MASS_PARAMETERS, ReversibleSystem


def refine_at(
    system: ReversibleSystem,
    point: Mapping[str, float],
    k: int,
    *,
    parameters: Mapping[str, Fraction | int | str] | None = None,
    kind: str | None = None,
    symmetry: str | None = None,
    crossings: int = 1,
    digits: int = 50,
    radii: Sequence[Fraction | float] | None = None,
    id: str | None = None,
    accept: bool = False,
    quiet: bool = False,
) -> Candidate:
    """A claim about the bifurcation point near a point that you have from elsewhere, good to five digits or so.

    Arguments:
        system: one of `shared`, or your own from `shared.load_system` or `shared.define_system`.
        point: on Fix(R), all of `system.centre_coordinates` by name; where two resonances meet, also a value near
            which the parameter lies that varies.
        k: multiplicity.
        parameters: the fixed parameters but that one, exact: `Fraction`, int, or text: "0.1", "1/3", "earth-moon".
        kind: one of `shared.KINDS`, "reversor_breaking", "krein_collision" or "double_resonance"; by default the
            generic bifurcation at a 1:k resonance, for n = 1 and k = 3 period tupling where a symmetry fixes the point.
        symmetry: for symmetry breaking, the symmetry that breaks, for period tupling with k = 3 the one that fixes the
            point; by default the only one.
        crossings: how often the half orbit, from Fix(R) to Fix(R), meets the section, its end included.
        digits: decimal digits of the centre.
        radii: half-widths of the box along p_0, p_1, ..; by default such as suit the branch, for a proof.
        id: of the claim; by default system and k.
        accept: whether a point is taken that is farther away than the digits of the one given explain.
        quiet: nothing on standard error.

    Raises `ValueError` for what is missing or unknown, `RefinementFailure`, one line, if Newton's method does not come
    to a point, or to another one.
    """
    varying = next((each for each in system.fixed_parameters if each in point), None)
    if kind != DOUBLE_RESONANCE:
        varying = None
    elif varying is None or k < 2 or symmetry is not None or system.family_parameter is not None:
        raise ValueError(
            f"kind: {kind!r} needs k > 1, no symmetry, a system with a first integral, and in point the value near "
            f"which one of {', '.join(system.fixed_parameters) or 'no parameters'} lies"
        )
    wanted = system.centre_coordinates if varying is None else (varying, *system.centre_coordinates)
    if set(point) != set(wanted):
        raise ValueError(f"point: {', '.join(point)}; give {', '.join(wanted)}")
    if digits < 1:
        raise ValueError(f"digits: {digits!r} is not positive")
    known = (*KINDS, *ACROSS_KINDS, DOUBLE_RESONANCE)
    if kind is not None and kind not in known:
        raise ValueError(f"kind: {kind!r} is unknown; there are {', '.join(known)}")
    if kind in ACROSS_KINDS and (k != 1 or symmetry is not None):
        raise ValueError(f"kind: {kind!r} has k = 1, and no symmetry")
    widths = None if radii is None else tuple(Fraction(float(each)) for each in radii)
    if widths is not None and (len(widths) != len(wanted) or not all(each > 0 for each in widths)):
        raise ValueError(f"radii: {len(widths)} numbers; give {len(wanted)} positive ones, for p_0, p_1, ..")
    texts = {key: str(MASS_PARAMETERS.get(str(value), value)) for key, value in (parameters or {}).items()}
    words = [f"{key}={text}" for key, text in texts.items()]
    try:
        exact = exact_parameters(system, texts, varying, exchanged_in)
    except InputError as error:
        raise ValueError(str(error)) from None
    name = id or f"{label_of(system, None, words) or system.name}-{short_name(kind, k)}"
    guess = tuple(float(point[each]) for each in wanted)
    if kind is None and k == 3 and symmetry is None:
        symmetry = _fixes(system, guess)
        kind = None if symmetry is None else "period_tupling"
    task = Task(
        id=name,
        system=system,
        parameters=exact,
        kind=kind or kind_of(k),
        k=k,
        symmetry=symmetry,
        guess=guess,
        digits=digits,
        provenance={"float64_point": list(guess)},
        crossings=crossings,
    )
    with Reporter(quiet) as report:
        report.stage(f"refining {name}")
        result = refine_task(task, report.update)
    if result.candidate is None:
        raise RefinementFailure(f"{name}: not refined: {result.failure}")
    why = None if accept else _another_point(result.candidate, {key: float(point[key]) for key in wanted})
    if why is not None:
        raise RefinementFailure(f"{name}: another point was found: {why}; give a closer one, or take it: --accept")
    return result.candidate if widths is None else replace(result.candidate, radii=widths)


def _another_point(candidate: Candidate, given: Mapping[str, float]) -> str | None:
    """Why the point of a claim is not the one that was given, with both numbers; `None` if it is."""
    system = candidate.system
    found = {**given, **{key: float(value) for key, value in zip(candidate.coordinates, candidate.centre, strict=True)}}
    names = system.centre_coordinates
    if candidate.symmetry is None:
        why = fallen(system, candidate.parameters, [given[each] for each in names], [found[each] for each in names])
        if why is not None:
            return why
    values = {**{key: float(value) for key, value in candidate.parameters.items()}, **found}
    parameters = [values[each] for each in system.parameters]
    states = [np.array([numbers.get(each, 0.0) for each in system.state]) for numbers in (given, found)]
    lines = contradictions(system, parameters, Numbers(states[0], rounded=True), Numbers(states[1]))
    return "; ".join(lines) or None


def _fixes(system: ReversibleSystem, point: Sequence[float]) -> str | None:
    """The symmetry that fixes a point and negates the one direction across its family, n = 1; `None` without one."""
    if len(system.kernel_coordinates) != 1:
        return None
    for name, signs in system.symmetries.items():
        negated = {system.state[i] for i, sign in enumerate(signs) if sign == -1}
        if system.state[system.kernel_coordinates[0]] in negated and all(
            value == 0 for key, value in zip(system.centre_coordinates, point, strict=True) if key in negated
        ):
            return name
    return None
