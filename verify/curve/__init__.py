"""Curves of symmetric orbits in pieces: tubes, gluing, bifurcations on the curve (sections 15 and 16)."""

from orbitproof.verify.curve.bifurcations_on_it import (
    Bifurcation,
    CertifiedPoint,
    PlaceOnCurve,
    is_inside_curve,
    locate,
)
from orbitproof.verify.curve.birth_piece import Birth, BirthTube, is_at_birth, is_born_at_doubling, prove_birth_piece
from orbitproof.verify.curve.conclusion import Conclusion, Ends
from orbitproof.verify.curve.conditions import check_covers, check_increasing, check_two_points
from orbitproof.verify.curve.equation import (
    BEYOND,
    TUBE,
    Equation,
    HalfReturn,
    divided_by_wide,
    parameter_series,
    parts_of_interval,
    tube_points,
)
from orbitproof.verify.curve.followed import Partner
from orbitproof.verify.curve.gluing import Chain, Stretch, follow
from orbitproof.verify.curve.libration_point import derived_parameter
from orbitproof.verify.curve.lyapunov_family import (
    certified_systems,
    in_units_of_orbit,
    is_planar,
    jacobi_constant,
    point_name,
)
from orbitproof.verify.curve.other_point import enclose_crossings, enclose_other_point
from orbitproof.verify.curve.piece import (
    SINGULAR,
    UNCLEAR_SLOPE,
    PieceLimits,
    Progress,
    check_newton,
    in_units,
    prove_piece,
)
from orbitproof.verify.curve.piece_result import (
    NOT_PROVED,
    PROVED,
    Account,
    Computation,
    Interval,
    IntervalResult,
    PieceResult,
    about_pieces,
    attempt,
    broken_off,
)
from orbitproof.verify.curve.proved_curve import PRECISION as CURVE_PRECISION
from orbitproof.verify.curve.proved_curve import CurveTheorem, ProvedCurve, conclude, times_of
from orbitproof.verify.curve.proved_intervals import ProvedInterval
from orbitproof.verify.curve.tube import lower_end, read_tube, upper_end
from orbitproof.verify.curve.vertical_family import stiffness_at_rest, vertical_point
