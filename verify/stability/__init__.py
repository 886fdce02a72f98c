"""Stability along a proved curve: complete lists of resonances, intervals of linear stability (section 18)."""

from orbitproof.verify.functions import REACH
from orbitproof.verify.stability.across_list import ListAcross, list_across
from orbitproof.verify.stability.along import CurveInTube
from orbitproof.verify.stability.closer_tube import about_closer_polynomial, sharpened
from orbitproof.verify.stability.complete_list import PRECISION, Finder, resonant_value
from orbitproof.verify.stability.confirmation import unconfirmed
from orbitproof.verify.stability.extrema import BAND, extrema_on, is_in_band
from orbitproof.verify.stability.kinds import (
    CurveEnd,
    Found,
    Kind,
    Matter,
    Resonance,
    Subject,
    What,
    may_change_stability,
    name_of,
)
from orbitproof.verify.stability.known_functions import point_over, segments_of
from orbitproof.verify.stability.left_open import open_on
from orbitproof.verify.stability.linear_stability import (
    Bound,
    IntervalEnd,
    Rule,
    StableInterval,
    bounds_on,
    intervals_where,
    is_stable,
    orbit_between,
    stable_intervals,
)
from orbitproof.verify.stability.list_entries import (
    Combinations,
    CompleteList,
    Extremum,
    Gap,
    Point,
    Segment,
    level_name,
)
from orbitproof.verify.stability.matrix import (
    SPARE_BITS,
    OtherPoint,
    TubeOfOrbits,
    orbit_functions,
    stability_of_piece,
    stability_slope_bits,
)
from orbitproof.verify.stability.proved_list import ListConclusion, ListTheorem, ProvedList, conclude_list
from orbitproof.verify.stability.stored_stability import SHARE, StabilityFunctions, StabilityResult
from orbitproof.verify.stability.zeros import Zeros, between, ends_of, zeros_on
