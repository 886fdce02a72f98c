"""Orbits in the fixed space of a symmetry that were looked for from outside of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

import numpy as np

from orbitproof.explore.orbits.agreement import NOISE, sizes_at
from orbitproof.shared.systems import ReversibleSystem

_FALLEN = 1e-3
"""On an orbit in a fixed space the coordinates that the symmetry negates are smaller than so much of the start's."""


def fallen(
    system: ReversibleSystem, parameters: Mapping[str, Fraction], start: Sequence[float], found: Sequence[float]
) -> str | None:
    """Why the orbit that was found is not the one that was meant: it lies in Fix(S), and the start does not.

    Where a family branches off from one in Fix(S), Newton's method may come to either. Points are given by
    `centre_coordinates`; `None` if no symmetry S is such, and for a start that is in Fix(S) but for rounding.
    """
    names = system.centre_coordinates
    values = {**parameters, **dict(zip(names, start, strict=True))}
    known, state = ([float(values.get(each, 0)) for each in of] for of in (system.parameters, system.state))
    sizes = dict(zip(system.state, sizes_at(system, known, np.array(state)), strict=True))
    for symmetry, signs in system.symmetries.items():
        negated = {system.state[index] for index, sign in enumerate(signs) if sign == -1}
        odd = [index for index, name in enumerate(names) if name in negated]
        if not odd:
            continue
        index = max(odd, key=lambda i: abs(start[i]) / sizes[names[i]])
        name, value, off = names[index], start[index], max(abs(found[i]) for i in odd)
        if abs(value) > NOISE * sizes[name] and off < _FALLEN * abs(value):
            return (
                f"the start, {name} = {value:.6g}, is off the fixed set of the symmetry {symmetry}, and the orbit "
                f"found, {name} = {found[index]:.6g}, is in it"
            )
    return None
