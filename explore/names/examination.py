"""Systems that other files than their own describe, tried at sample points before anything is searched."""

from __future__ import annotations

from typing import TypeVar

from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import System, describe, fault

SystemOf = TypeVar("SystemOf", bound=System)

_FAULTS: dict[int, tuple[System, str | None]] = {}


def examined(system: SystemOf, source: str) -> SystemOf:
    """The system of a file, if nothing is seen to be wrong with it. Raises `InputError`."""
    if id(system) not in _FAULTS:
        _FAULTS[id(system)] = system, None if isinstance(describe(system), str) else fault(system)
    wrong = _FAULTS[id(system)][1]
    if wrong is not None:
        raise InputError(f"{source}: field system.{wrong}")
    return system
