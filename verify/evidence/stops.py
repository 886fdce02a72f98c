"""What ends a verification and is no hypothesis of its theorem: the other conditions of a `Reason`."""

from __future__ import annotations

from enum import StrEnum


class Stop(StrEnum):
    """A closed set: a certificate gives one of these, or a hypothesis, where something is not proved (section 13.1)."""

    BIFURCATIONS = "bifurcations"
    COLLISION = "collision"
    COMPLETE = "complete"
    CROSSING_COUNT = "crossing count"
    DERIVED_PARAMETER = "derived parameter"
    DISTANCE = "distance"
    EVALUATION = "evaluation"
    EXACT_CHECKS = "exact checks"
    HALF_ORBIT = "half-orbit"
    INTEGRATION = "integration"
    LEVEL = "level"
    LEVEL_BOX = "level-box"
    MEMORY = "memory"
    MULTIPLICITY = "multiplicity"
    NEWTON = "newton"
    PIECE = "piece"
    PRECISION = "precision"
    PROCESS = "process"
    RADII = "radii"
    RESULTS = "results"
    SECTION = "section"
    SINGULARITY = "singularity"
    SIZE = "size"
    STABILITY = "stability"
    STEPS = "steps"
    SYSTEM = "system"
    THEOREM = "theorem"
    TIME = "time"
    TUBE = "tube"
    UNFINISHED = "unfinished"
    VERIFICATION = "verification"
