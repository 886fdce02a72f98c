"""What need not be known."""

from __future__ import annotations

from dataclasses import dataclass

from orbitproof.verify.evidence.outcome import Reason


@dataclass(frozen=True)
class NotKnown:
    """What stands where something is not known, which is not needed for what is proved: why it is not."""

    reason: Reason

    stored_key = "reason"
