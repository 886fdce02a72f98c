"""Proved curves of equilibria and of periodic orbits joined into a graph (section 39)."""

from __future__ import annotations

from orbitproof.verify.branches import life
from orbitproof.verify.branches.rests_on import resting
from orbitproof.verify.certificate.kind import Kind
from orbitproof.verify.certificate.kinds import LIFE

KIND = Kind(
    names=(LIFE,),
    schema=life.SCHEMA,
    part=LIFE,
    titles={LIFE: "Equilibria and the orbits that are born on them"},
    said=lambda k, kind: "equilibria and orbits joined into a graph",
    levels=life.LEVELS,
    rests_on=lambda entry, given: resting(entry.claim, given),
    more=life.SAID,
    extent=life.extent_of,
    one_a_line=(("arcs",), ("rests_on",)),
)
