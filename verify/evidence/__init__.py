"""What counts as shown: comparisons of balls, hypotheses with their enclosures, outcomes."""

from orbitproof.verify.evidence.balls_as_text import (
    ball_from_json,
    ball_to_json,
    balls_to_json,
    certain_digits,
    count_certain_digits,
    interval_text,
    located,
    range_text,
)
from orbitproof.verify.evidence.comparisons import (
    FUNCTIONS,
    EmptyIntersectionError,
    all_finite,
    bounds,
    dot,
    dyadic_above,
    enclose,
    exact_value,
    excludes_zero,
    hull,
    is_below,
    is_inside,
    is_outside,
    is_positive,
    meet,
    power,
    sign,
    symmetric,
    total,
    up_to,
)
from orbitproof.verify.evidence.concluding import concluded
from orbitproof.verify.evidence.decimals import decimal_above, decimal_interval
from orbitproof.verify.evidence.derivatives import (
    MAX_ORDER,
    Brief,
    Briefs,
    DerivativeTable,
    MultiIndex,
    index_factorial,
    indices_of_degree,
    indices_up_to,
)
from orbitproof.verify.evidence.exact_as_text import exact_interval_text, exact_text
from orbitproof.verify.evidence.failure import IntegrationFailure, without_result
from orbitproof.verify.evidence.not_known import NotKnown
from orbitproof.verify.evidence.outcome import (
    Checklist,
    Evidence,
    Hypothesis,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    Theorem,
    show,
)
from orbitproof.verify.evidence.outcome_as_json import (
    as_said,
    hypothesis_to_json,
    one_line,
    outcome_to_json,
    quoted,
    quoted_name,
    reason_to_json,
)
from orbitproof.verify.evidence.precision import GUARD_BITS, guarded
from orbitproof.verify.evidence.sources import ON_WHICH_NOTHING_RESTS, installed, software
from orbitproof.verify.evidence.stops import STOPS
