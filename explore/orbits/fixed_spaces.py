"""Orbits in the fixed space of a symmetry that were looked for from outside of it."""

from __future__ import annotations

from collections.abc import Sequence

from orbitproof.shared.systems import ReversibleSystem

_ROUNDING = 1e-12
"""A coordinate that is smaller, relative to the largest of its point, says nothing of a side."""

_FALLEN = 1e-3
"""Of an orbit in a fixed space the coordinates that the symmetry negates are smaller than so much of the start's."""


def fallen(system: ReversibleSystem, start: Sequence[float], found: Sequence[float]) -> str | None:
    """Why the orbit that was found is not the one that was meant: it lies in Fix(S), and the start does not.

    Where a family branches off from one in Fix(S), Newton's method may come to either. Points are given by
    `centre_coordinates`; `None` if no symmetry S is such.
    """
    names = system.centre_coordinates
    size = max((abs(float(value)) for value in start), default=0.0)
    for symmetry, signs in system.symmetries.items():
        negated = {system.state[index] for index, sign in enumerate(signs) if sign == -1}
        odd = [index for index, name in enumerate(names) if name in negated]
        if not odd:
            continue
        index = max(odd, key=lambda i: abs(float(start[i])))
        off = max(abs(float(found[i])) for i in odd)
        if abs(float(start[index])) > _ROUNDING * size and off < _FALLEN * abs(float(start[index])):
            name, value = names[index], float(start[index])
            return (
                f"the start, {name} = {value:.6g}, is off the fixed set of the symmetry {symmetry}, and the orbit "
                f"found, {name} = {float(found[index]):.6g}, is in it and so another one; keep the coordinate "
                f"(--at {name}={value:.6g}), or give a closer start"
            )
    return None
