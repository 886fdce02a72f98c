"""Certificates of versions that took some names of a system for their own (section 13.1)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping

from orbitproof.shared.systems import ReversibleSystem, System
from orbitproof.verify.certificate.levels import Finding
from orbitproof.verify.evidence import quoted_name

_FIRST_WITHOUT = (0, 3)
"""The first version whose own names cannot be chosen by a file."""
_WERE_OURS = frozenset({"distance", "rate", "level"})
"""What earlier versions called inputs of their own."""


def taken_names(system: System, software: Mapping[str, str]) -> Iterator[Finding]:
    """A finding if a certificate was made by a version that may have taken a name of its system for another.

    Args:
        software: of the certificate, names and versions.
    """
    made_by = software.get("orbitproof", "")
    version = re.match(r"([0-9]{1,9})\.([0-9]{1,9})", made_by)
    if version is not None and tuple(map(int, version.groups())) >= _FIRST_WITHOUT:
        return
    names = (*system.state, *system.parameters)
    taken = sorted(_WERE_OURS.intersection(names))
    if system.first_integral_name in names:
        taken.append(str(system.first_integral_name))
    if isinstance(system, ReversibleSystem) and "R" in system.symmetries:
        taken.append("R")
    if taken:
        names_said = ", ".join(map(quoted_name, taken))
        yield Finding(
            "software",
            f"orbitproof {quoted_name(made_by)} may have taken the system's {names_said} for something of its own: "
            "prove the claim again with this version",
        )
