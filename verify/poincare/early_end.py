"""Integrations that are given up early, because it can be seen that they will be of no use (section 10.3)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import ceil, log2

from orbitproof.shared.formats import Candidate
from orbitproof.verify.evidence import DerivativeTable, IntegrationFailure
from orbitproof.verify.poincare.box_format import LOSS_DIVISOR, log2_of
from orbitproof.verify.poincare.iterates import Integration


@dataclass(frozen=True)
class HalfReturns:
    """What is known of a candidate's box after some half returns, P the map of one.

    Attributes:
        before: derivatives of the kernel coordinates at the crossings before the end of the first one.
        kernels: those of the components of pi_q P, pi_q P^2, ..
        image: after two of them, those of the candidate's coordinates at P^2, by name; a parameter is not among them.
    """

    before: tuple[tuple[DerivativeTable, ...], ...]
    kernels: tuple[tuple[DerivativeTable, ...], ...]
    image: Mapping[str, DerivativeTable]


Decide = Callable[[Candidate, HalfReturns], None]
"""Looks at half returns; raises `NotEstablishedError` if there is no point in going on."""


class EarlyEnd:
    """A `Watch` that ends an integration.

    Args:
        accuracy: bits that the errors of the last crossing and of its derivative should have; `None` goes on in any
            case.
        decide: called after every half return but the last.
    """

    def __init__(self, accuracy: tuple[int, int] | None, decide: Decide = lambda _candidate, _found: None) -> None:
        self.accuracy, self.decide = accuracy, decide
        self.first_error_bits = (0.0, 0.0)

    def after_step(self, integration: Integration) -> None:
        """See `Watch`."""
        if integration.returns.steps == 1:
            self.first_error_bits = _error_bits(integration)

    def after_return(self, integration: Integration) -> None:
        """See `Watch`."""
        if self.accuracy is not None:
            number, half = len(integration.iterates), integration.candidate.crossings
            if number % half == 0:
                self.decide(integration.candidate, _half_returns(integration, number == 2 * half))
            if number == min(2, integration.crossings - 1):
                self._check_accuracy(integration, number, self.accuracy)

    def _check_accuracy(self, integration: Integration, number: int, accuracy: tuple[int, int]) -> None:
        """Give up if the errors, growing as they did so far, would exceed what the last crossing needs.

        Errors differ between the two ends of a half return; after two returns they compare best.
        """
        missing, last, bits = 0, integration.crossings, integration.box.arithmetic.bits
        for begin, now, wanted in zip(self.first_error_bits, _error_bits(integration), accuracy, strict=True):
            missing = max(missing, ceil(wanted - begin + (begin - now) * last / number))
        if missing > 0:
            raise IntegrationFailure(
                "precision",
                f"{bits} bits are too few: at the last crossing {missing} would be missing",
                "give `max_precision` more",
                needs_precision=True,
                enough_precision=bits + 8 + missing * LOSS_DIVISOR // (LOSS_DIVISOR - 1),
            )


def _half_returns(integration: Integration, with_image: bool) -> HalfReturns:
    candidate, iterates = integration.candidate, integration.iterates
    half, coordinates = candidate.crossings, candidate.system.state
    names = [name for name in candidate.coordinates if name in coordinates] if with_image else []
    tables = integration.tables([integration.state[coordinates.index(name)] for name in names])
    image = dict(zip(names, tables, strict=True))
    return HalfReturns(tuple(iterates[: half - 1]), tuple(iterates[half - 1 :: half]), image)


def _error_bits(integration: Integration) -> tuple[float, float]:
    """Bits of the worst error of the state and of its derivative in the variable of weight 1."""
    weights, state = integration.box.arithmetic.grading.weights, integration.returns.state
    linear = min(log2_of(scale) for scale, weight in zip(integration.box.scales, weights, strict=True) if weight == 1)
    value = max(log2(x.errors[0]) for x in state)
    return -value, -max(value, max(log2(x.errors[1]) for x in state) - linear)
