"""Where tasks are done, side by side, and what people see of it."""

from orbitproof.shared.processes import GRACE_SECONDS, Answer, Failure, Progress, Report, Task
from orbitproof.verify.engines.checks import (
    CHECK_SECONDS,
    GIBIBYTE,
    INTEGRATION_SECONDS,
    LONG_CHECK_SECONDS,
    CheckLimits,
    apart,
)
from orbitproof.verify.engines.cluster import connected, engine_of
from orbitproof.verify.engines.options import ArgumentParser, gibibytes, positive_seconds, whole
from orbitproof.verify.engines.processes import Engine, Processes, Work
from orbitproof.verify.engines.progress import Display, aligned
