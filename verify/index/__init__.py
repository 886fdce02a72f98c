"""The Conley-Zehnder index along proved curves of the CR3BP (section 35)."""

from orbitproof.verify.index.along_curve import (
    SYSTEMS,
    Interval,
    intervals_of,
    intervals_with_orbits,
    places_in,
    start_at,
    stretch_of,
)
from orbitproof.verify.index.following import Start, followed
from orbitproof.verify.index.half_turns import HalfTurns
from orbitproof.verify.index.proved_index import CountedOrbit, IndexTheorem, ProvedIndex, conclude_index
