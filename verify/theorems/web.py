"""Proved curves that meet in certified orbits (section 33)."""

from __future__ import annotations

from orbitproof.verify.branches import web
from orbitproof.verify.branches.rests_on import resting
from orbitproof.verify.certificate.kind import Kind
from orbitproof.verify.certificate.kinds import WEB

KIND = Kind(
    names=(WEB,),
    schema=web.SCHEMA,
    part=WEB,
    titles={WEB: "Curves of periodic orbits joined into a graph"},
    said=lambda k, kind: "curves joined into a graph",
    levels=web.LEVELS,
    rests_on=lambda entry, given: resting(entry.claim, given),
    more=web.SAID,
    extent=web.extent_of,
    one_a_line=(("arcs",), ("rests_on",)),
)
