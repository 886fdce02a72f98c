"""The half return near the points of a box of Fix(R), by all coordinates of the section (section 6.1)."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.shared.stored import rules
from orbitproof.verify.algebra import Series
from orbitproof.verify.evidence import MAX_ORDER, Briefs, MultiIndex, guarded, indices_up_to
from orbitproof.verify.poincare.box_format import BOX_RATIO, check_size
from orbitproof.verify.poincare.derivatives import derivative_table
from orbitproof.verify.poincare.iterates import box_of, default_order
from orbitproof.verify.poincare.oracle import Oracle
from orbitproof.verify.poincare.returns import Returns
from orbitproof.verify.poincare.settings import IntegratorSettings

Derivatives = Mapping[MultiIndex, arb]
"""Partial derivatives of a function, by multi-index."""


@dataclass(frozen=True)
class HalfReturn:
    """Derivatives up to order 3 by (p, q) of the half return, at all points of the box of a candidate, where q = 0.

    p are the coordinates of the box, 1 + n of them, q the n state coordinates other than that of the section that R
    negates, in their order. Derivatives stand in the lexicographic order of their multi-indices.

    Attributes:
        image: of the coordinates of P^m on Fix(R), in the order of the claim's `centre_coordinates`, then of the q.
        first_integral: of the first integral at the point that is followed; `None` without one.
    """

    image: Annotated[tuple[Briefs, ...], rules(maxItems=64)]
    first_integral: Briefs | None

    def is_complete(self, n: int, has_integral: bool) -> bool:
        """Whether all derivatives are there, of a claim with n of the q."""
        wanted = len(indices_up_to(1 + 2 * n, MAX_ORDER))
        rows = [*self.image, *([] if self.first_integral is None else [self.first_integral])]
        there = len(self.image) == 1 + 2 * n and (self.first_integral is not None) == has_integral
        return there and all(len(row) == wanted for row in rows)


def named(derivatives: Briefs, variables: int) -> Derivatives:
    """Stored derivatives by their multi-indices. Raises `ValueError` if they are not all of these."""
    return dict(zip(sorted(indices_up_to(variables, MAX_ORDER)), derivatives, strict=True))


def enclose_half_return(
    candidate: Candidate,
    settings: IntegratorSettings,
    oracle: Oracle,
    progress: Callable[[float], None] | None = None,
) -> HalfReturn:
    """Follow the points of the section about a candidate's box to crossing number m of the section.

    `progress` is called after every step with a rough fraction of the work done; what it raises passes through.
    Raises `IntegrationFailure` if something could not be enclosed.
    """
    report = progress or (lambda _fraction: None)
    with guarded(settings.precision):
        order = settings.order if settings.order is not None else default_order(settings.precision)
        box = box_of(candidate, settings.precision, order, across=True)
        check_size(box.arithmetic.grading, box.scales)
        system = candidate.system

        def derivatives(element: Series) -> Briefs:
            table = derivative_table(element, box.scales, BOX_RATIO).box
            return tuple(table[index] for index in sorted(table))

        returns = Returns(system, box.arithmetic, box.point, oracle, settings.coordinates, box.level)
        for number in range(candidate.crossings):
            done = number / candidate.crossings
            state, _ = returns.next_crossing(lambda _steps, done=done: report(done))  # type: ignore[misc]
        image = {**box.point, **dict(zip(system.state, state, strict=True))}
        kernel = [system.state[index] for index in system.kernel_coordinates]
        names = (*system.centre_coordinates, *kernel)
        return HalfReturn(
            tuple(derivatives(image[name]) for name in names),
            None if box.level is None else derivatives(box.level),
        )
