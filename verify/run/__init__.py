"""Where tasks are done, side by side, and what people see of it."""

from orbitproof.shared.processes import GRACE_SECONDS, Answer, Failure, Progress, Report, Task
from orbitproof.verify.run.cluster import connected, engine_of
from orbitproof.verify.run.options import ArgumentParser, gibibytes, interrupted, positive_seconds, whole_number
from orbitproof.verify.run.processes import Engine, Processes, Work
from orbitproof.verify.run.progress import Display
from orbitproof.verify.run.workplace import (
    CHECK_SECONDS,
    GIBIBYTE,
    INTEGRATION_SECONDS,
    LONG_CHECK_SECONDS,
    CheckLimits,
    Workplace,
    apart,
)
