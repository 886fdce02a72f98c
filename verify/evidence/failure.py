"""Why an integration gave no enclosure."""

from __future__ import annotations


class IntegrationFailure(Exception):
    """The integrator could not enclose what was asked for: the claim is not proved.

    Attributes:
        condition: short key of what failed.
        message: what happened.
        remedy: what to try.
        needs_precision: whether more precision may mend it.
        enough_precision: bits that are expected to be enough, where that is known.
    """

    def __init__(self, condition: str, message: str, remedy: str, needs_precision: bool = False) -> None:
        """Describe the failure; set `enough_precision` afterwards where it is known."""
        super().__init__(f"{message}; {remedy}")
        self.condition = condition
        self.message = message
        self.remedy = remedy
        self.needs_precision = needs_precision
        self.enough_precision: int | None = None
