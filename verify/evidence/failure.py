"""Why an integration gave no enclosure."""

from __future__ import annotations

from dataclasses import replace

from orbitproof.verify.evidence.outcome import NotEstablishedError, Reason


def without_result(error: ArithmeticError | ValueError) -> str:
    """What happened where arithmetic of balls ends in an exception, in words."""
    if isinstance(error, ZeroDivisionError):
        return "a divisor may vanish, or a matrix may be singular"
    if isinstance(error, OverflowError):
        return "a number leaves the range of floating-point numbers"
    return " ".join(f"the arithmetic has no result: {error}".split())


class IntegrationFailure(NotEstablishedError):
    """The integrator could not enclose what was asked for: the claim is not proved.

    The arguments are those of `Reason`, which the exception carries.
    """

    def __init__(
        self,
        condition: str,
        message: str,
        remedy: str,
        needs_precision: bool = False,
        enough_precision: int | None = None,
    ) -> None:
        super().__init__(Reason(condition, message, remedy, needs_precision, enough_precision))

    def at(self, time: float) -> IntegrationFailure:
        """This failure with the time at which it happened."""
        self.reason = replace(self.reason, reached=time)
        return self

    def __str__(self) -> str:
        return f"{self.reason.message}; {self.reason.remedy}"
