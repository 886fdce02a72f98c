"""Curves of periodic orbits of which no symmetry is used (section 26)."""

from __future__ import annotations

from orbitproof.shared.claims import PERIODIC_CURVES
from orbitproof.verify.atlas.certificate import ONE_A_LINE, SAID, SCHEMA, pieces_of, well_formed
from orbitproof.verify.atlas.kinds import BranchKind
from orbitproof.verify.atlas.recheck import conclusion, form, integration
from orbitproof.verify.periodic_curve import PeriodicCurveTheorem, PeriodicLimits, conclude_periodic

KIND = BranchKind(
    names=PERIODIC_CURVES,
    schema=SCHEMA,
    part="arc",
    titles={
        "periodic-arc": "A curve of periodic orbits",
        "periodic-loop": "A closed curve of periodic orbits",
    },
    said=lambda k, kind: "orbits without symmetry",
    levels=(form, conclusion, integration),
    more=SAID,
    extent=pieces_of,
    well_formed=well_formed,
    one_a_line=ONE_A_LINE,
    theorem=PeriodicCurveTheorem,
    limits=PeriodicLimits,
    about="orbits without symmetry",
    conclude=conclude_periodic,
)
