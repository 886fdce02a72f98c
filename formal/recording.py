"""The verifier's own approximations, written down while it follows the orbits of a row. Nothing rests on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, log2

from flint import fmpz_poly

from orbitproof.formal.arithmetic import Format, Node, Poly, Program
from orbitproof.shared.formats import Candidate
from orbitproof.shared.systems import Program as SharedProgram
from orbitproof.verify.algebra import Arithmetic, PreparedProgram, Series, prepare
from orbitproof.verify.bifurcation import check_exactly, prove
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.evidence import Checklist, IntegrationFailure, Proved, bounds, guarded
from orbitproof.verify.flow import Expansion
from orbitproof.verify.flow.field_along import FieldAlong
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import Coordinates, IntegratorSettings, enclose_iterates
from orbitproof.verify.poincare.iterates import Integration
from orbitproof.verify.poincare.settings import PHYSICAL

_EPS_BITS = 100
_MORE_BITS = 48
_SPARE_BITS = 3
_BITS_FOR_A_BIT = 6 / 5
"""The first grade of a series is known to 5/6 of its bits, and the parameter follows from it."""


def integers(polynomials: Sequence[fmpz_poly]) -> list[Poly]:
    """Coefficients as integers."""
    return [[int(c) for c in p.coeffs()] for p in polynomials]


def program_of(prepared: PreparedProgram) -> Program:
    """A prepared program with the names of Coq."""
    nodes = []
    for node in prepared.nodes[prepared.inputs :]:
        kind = {"constant": "const", "pow": "power"}.get(node.operation, node.operation)
        places = () if kind == "const" else tuple(i for i in (node.left, node.right) if i >= 0)
        nodes.append(Node(kind, places, node.value))
    return Program(prepared.inputs, tuple(nodes), prepared.outputs)


def recorded(program: SharedProgram) -> Program:
    """A program of a system."""
    return program_of(prepare(program))


def format_of(arithmetic: Arithmetic) -> Format:
    """The format of the verifier, with the scale of bounds."""
    grading = arithmetic.grading
    eps = arithmetic.bits + (grading.top + 1) * arithmetic.grade_bits + _EPS_BITS
    return Format(grading.weights, grading.top, arithmetic.bits, arithmetic.grade_bits, arithmetic.degree + 1, eps)


@dataclass(frozen=True)
class Approximation:
    """An approximate solution over one step.

    Attributes:
        length: dyadic.
        solution: for each component, for each monomial.
        powers: about the powers in the field on it, in the order of the program.
    """

    length: Fraction
    solution: list[list[Poly]]
    powers: list[list[Poly]]


@dataclass
class Leg:
    """From one crossing to the next: steps of the flow, then those onto the section."""

    steps: list[Approximation] = field(default_factory=list)
    onto: list[Approximation] = field(default_factory=list)


class _Observed:
    """An expansion whose solutions are written down; the last one of an expansion is the one that was taken."""

    def __init__(self, inner: Expansion, into: list[Approximation]) -> None:
        self._inner, self._into, self._place = inner, into, len(into)
        self.step_size = inner.step_size

    def shortened(self, step: Fraction) -> Fraction:
        """See `flow.Expansion`."""
        return self._inner.shortened(step)

    def crossing(self, section: int, step: Fraction, starts_on_section: bool) -> Fraction | None:
        """See `flow.Expansion`."""
        return self._inner.crossing(section, step, starts_on_section)

    def solve(self, along: FieldAlong, step: Fraction) -> None:
        """See `flow.Expansion`."""
        self._inner.solve(along, step)
        nodes = along.program.nodes
        solution, powers = along._solution, along._evaluation.coefs
        found = Approximation(
            step,
            [integers(row) for row in solution],
            [integers(powers[i]) for i, node in enumerate(nodes) if node.operation == "pow"],
        )
        self._into[self._place :] = [found]


class _Recorder:
    """The verifier's oracle, watched."""

    def __init__(self, size: int) -> None:
        self.size = size
        self.legs = [Leg()]

    def expand(
        self, program: PreparedProgram, arithmetic: Arithmetic, state: Sequence[Series], parameters: Sequence[Series]
    ) -> Expansion:
        """See `poincare.Oracle`."""
        leg = self.legs[-1]
        # On the way onto the section there is one component more, the elapsed time.
        into = leg.steps if len(state) == self.size else leg.onto
        return _Observed(ORACLE.expand(program, arithmetic, state, parameters), into)

    def regularised_steps(
        self,
        own: Coordinates,
        other: Coordinates,
        point: Sequence[float],
        parameters: Sequence[float],
        level: float,
        arithmetic: Arithmetic,
    ) -> int:
        """See `poincare.Oracle`."""
        return 0


def precision_for(certificate: Certificate, claim: Candidate) -> int:
    """Bits with which the parameter is known as well in the system's own coordinates as the certificate knows it.

    In regularised coordinates fewer are lost on the way. A guess that is wrong costs a check.
    """
    precision = certificate.computation.precision
    if certificate.computation.coordinates in (None, PHYSICAL):
        return precision
    assert certificate.parameter is not None
    low, high = bounds(certificate.parameter)
    for tried in range(precision, precision + 5 * _MORE_BITS, _MORE_BITS):
        with guarded(tried), suppress(IntegrationFailure):
            checklist = Checklist()
            check_exactly(checklist, claim)
            found = enclose_iterates(claim, IntegratorSettings(tried, coordinates=PHYSICAL), ORACLE)
            integral = None if claim.is_family_of_maps else found.first_integral
            outcome = prove(claim, checklist, found.iterates, integral, found.return_times)
            if isinstance(outcome, Proved):
                own_low, own_high = bounds(outcome.results.parameter)
                missing = max(0.0, log2((own_high - own_low) / (high - low)) + _SPARE_BITS)
                return tried + 8 * ceil(missing * _BITS_FOR_A_BIT / 8)
    return precision


def record(
    candidate: Candidate, precision: int, start: Callable[[Format], dict[int, tuple[list[Poly], list[float]]]]
) -> tuple[Format, list[Leg]]:
    """Follow the orbits of a claim's box once more, and write down the approximations.

    Args:
        start: components of the initial state that are to be replaced: known parts and bounds of the rest.

    Raises `IntegrationFailure`.
    """
    recorder = _Recorder(len(candidate.system.state))
    with guarded(precision):
        integration = Integration(candidate, IntegratorSettings(precision, coordinates=PHYSICAL), recorder)
        returns = integration.returns
        form = format_of(returns.arithmetic)
        for place, (known, errors) in start(form).items():
            returns.state[place] = Series(returns.arithmetic, [fmpz_poly(p) for p in known], errors)
        for _ in range(integration.crossings):
            returns.next_crossing()
            recorder.legs.append(Leg())
    return form, recorder.legs[:-1]
