"""Curves of symmetric orbits (sections 15, 16 and 18)."""

from __future__ import annotations

from orbitproof.shared.claims import CLAIMS, SURFACE
from orbitproof.verify.atlas.certificate import ONE_A_LINE, SAID, SCHEMA, pieces_of, well_formed
from orbitproof.verify.atlas.kinds import BranchKind
from orbitproof.verify.atlas.recheck import conclusion, form, integration
from orbitproof.verify.curve import CurveTheorem, PieceLimits

KIND = BranchKind(
    names=tuple(name for name in CLAIMS if name != SURFACE),
    schema=SCHEMA,
    part="arc",
    titles={
        "arc": "A curve of symmetric periodic orbits",
        "loop": "A closed curve of symmetric periodic orbits",
        "symmetric-arc": "A curve of symmetric periodic orbits, mapped to itself by {symmetry}",
        "symmetric-loop": "A closed curve of symmetric periodic orbits, mapped to itself by {symmetry}",
    },
    said=lambda k, kind: "a curve of symmetric orbits",
    levels=(form, conclusion, integration),
    more=SAID,
    extent=pieces_of,
    well_formed=well_formed,
    one_a_line=ONE_A_LINE,
    theorem=CurveTheorem,
    limits=PieceLimits,
    about="a curve of symmetric orbits",
)
