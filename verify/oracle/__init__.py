"""Approximations, precisions, attempts (sections 3 and 10.3): whatever comes from this room, nothing false follows."""

from orbitproof.verify.oracle.approximations import ORACLE
from orbitproof.verify.oracle.boxes import box_asked_for
from orbitproof.verify.oracle.precision import (
    GREATEST_PRECISION,
    LEAST_PRECISION,
    LEVELS,
    Limits,
    Verdict,
    accuracy_bits,
    first_precision,
    missing_bits,
    more_precision,
    steps_of_centre,
)
from orbitproof.verify.oracle.sharpened import counsel
from orbitproof.verify.oracle.steps import steps_about
