"""What to try next about a claim, with how many bits, on which box (section 10.3); nothing is proved by it."""

from orbitproof.verify.attempt.boxes import box_asked_for
from orbitproof.verify.attempt.precision import (
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
from orbitproof.verify.attempt.sharpened import counsel
