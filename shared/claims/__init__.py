"""What is claimed, as values: boxes with a bifurcation or an orbit, curves and surfaces in pieces."""

from orbitproof.shared.claims.atlas import CLAIMS, SURFACE, Atlas, Claim, Covers
from orbitproof.shared.claims.candidate import (
    ACROSS_KINDS,
    BOX_KINDS,
    COORDINATE,
    DOUBLE_RESONANCE,
    FOLD,
    HALF_PERIOD,
    INVARIANT_TORI,
    KINDS,
    KREIN_COLLISION,
    LEADING_POWERS,
    LEVEL,
    ONCE,
    ORBIT,
    ORBIT_KINDS,
    QUANTITIES,
    REVERSOR_BREAKING,
    STABLE_ORBIT,
    Candidate,
    Equation,
)
from orbitproof.shared.claims.periodic import PERIODIC, PeriodicOrbit
from orbitproof.shared.claims.periodic_bifurcation import (
    PERIODIC_BIFURCATIONS,
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PERIODIC_TORUS,
    PeriodicBifurcation,
)
from orbitproof.shared.claims.periodic_curve import (
    PERIODIC_CURVES,
    AnyAtlas,
    PeriodicAtlas,
    PeriodicCurveClaim,
    StoredAtlas,
)
from orbitproof.shared.claims.pieces import (
    COORDINATES,
    AnyPiece,
    BirthPiece,
    LibrationPiece,
    Piece,
    SurfacePiece,
    evaluate,
    is_regular,
)

InSection = PeriodicOrbit | PeriodicBifurcation
"""A claim of which no symmetry of a reversible system is used: its box lies in a section."""
KINDS_IN_SECTION = (PERIODIC, *PERIODIC_BIFURCATIONS)

BoxClaim = Candidate | InSection
"""What a row of a candidates file claims of a box."""
