"""Symmetry breakings over a range of a parameter (section 17)."""

from __future__ import annotations

from orbitproof.shared.claims import SURFACE
from orbitproof.verify.atlas.certificate import ONE_A_LINE, SAID, SCHEMA, pieces_of, well_formed
from orbitproof.verify.atlas.kinds import BranchKind
from orbitproof.verify.atlas.recheck import conclusion, form, integration
from orbitproof.verify.surface import SurfaceLimits, SurfaceTheorem, conclude_surface

KIND = BranchKind(
    names=(SURFACE,),
    schema=SCHEMA,
    part="arc",
    titles={SURFACE: "Symmetry breaking over a range of parameters"},
    said=lambda k, kind: "a surface",
    levels=(form, conclusion, integration),
    more=SAID,
    extent=pieces_of,
    well_formed=well_formed,
    one_a_line=ONE_A_LINE,
    theorem=SurfaceTheorem,
    limits=SurfaceLimits,
    about="a surface",
    conclude=conclude_surface,
)
