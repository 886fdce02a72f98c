"""What ends a verification and is no hypothesis of its theorem: the other conditions of a `Reason`."""

from __future__ import annotations

STOPS = frozenset((
    "bifurcations", "collision", "complete", "crossing count", "derivatives", "derived parameter", "distance",
    "evaluation", "exact checks", "guess", "half turns", "half-orbit", "integration", "lasting", "level", "level-box",
    "memory", "multiplicity", "multipliers",
    "newton", "piece", "plane", "precision", "process", "radii", "results", "section", "sheet", "singularity", "size",
    "slope", "stability", "start", "steps", "system", "theorem", "time", "tube", "unfinished", "verification",
))  # fmt: skip
"""A certificate gives one of these, or a hypothesis, where something is not proved (section 13.1)."""
