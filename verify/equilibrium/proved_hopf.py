"""One Hopf point in a box, and the periodic orbits that are born there (sections 36.6 to 36.9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from flint import acb, arb, arb_mat

from orbitproof.shared.claims import HopfPoint
from orbitproof.shared.claims.fields import Title
from orbitproof.verify.equilibrium.box import NARROWER, check_field, point_of, require_zero
from orbitproof.verify.equilibrium.enclosures import HopfEnclosures, pairs
from orbitproof.verify.equilibrium.equations import (
    Derivatives,
    derivatives_of,
    equations_of,
    left_eigenvector,
    names_of,
    product,
    radii_of,
    solved,
)
from orbitproof.verify.equilibrium.spectrum import Spectrum, spectrum_of
from orbitproof.verify.evidence import Checklist, Outcome, concluded, enclose, excludes_zero, is_positive, sign


@dataclass(frozen=True)
class HopfResults:
    """What is known of a proved Hopf point, in the units of its system.

    Attributes:
        point: enclosures of the coordinates of the equilibrium, by name.
        parameter_name, parameter: what varies, and its value there.
        frequency: omega, the eigenvalues of the pair being +- i omega.
        period: 2 pi/omega, the limit of the periods of the orbits that are born.
        eigenvalues: the others; none has real part 0.
        speed: the derivative of the real part of the pair in the parameter.
        lyapunov: the first Lyapunov coefficient, for an eigenvector of length 1 in the coordinates of the system.
        side: the values of the parameter for which there are the periodic orbits: above or below that of the point.
        criticality: "supercritical" if the coefficient is negative: within the centre manifold the orbits attract;
            "subcritical" if it is positive.
    """

    point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    frequency: arb
    period: arb
    eigenvalues: Spectrum
    speed: arb
    lyapunov: arb
    side: Literal["above", "below"]
    criticality: Literal["supercritical", "subcritical"]

    @property
    def is_attracting(self) -> bool:
        """Whether the orbits that are born are asymptotically stable; if not they are unstable."""
        return self.criticality == "supercritical" and self.eigenvalues.is_stable


@dataclass(frozen=True)
class HopfTheorem:
    """The box of a claim contains exactly one Hopf point, at which periodic orbits are born (Theorem 36.7)."""

    claim: HopfPoint

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        own = ["functions"] if self.claim.system.defined else []
        return *own, "field", "imaginary-pair", "others", "crossing", "lyapunov"


@dataclass(frozen=True)
class _ImaginaryPair:
    """The point that was found: omega, q, and the derivatives of the field there."""

    omega: arb
    q: list[acb]
    known: Derivatives


def prove_hopf(claim: HopfPoint, checklist: Checklist, found: HopfEnclosures | None) -> Outcome[HopfResults]:
    """Check that the box contains exactly one Hopf point as claimed, given the enclosures; `None` stands for none.

    `checklist` already holds what was established before; the current precision of Arb is used.
    """

    def check() -> HopfResults:
        size = len(claim.centre)
        further: dict[str, tuple[Sequence[Sequence[arb | acb]], int]] = {}
        if found is not None:
            further["derivatives at the centre"] = found.linear, size
            further["second derivatives"] = found.second, len(pairs(size))
            further["third derivatives"] = [[value] for value in found.third], 1
        check_field(checklist, "36.6", () if found is None else found.field, size, size + 1, further)
        assert found is not None
        statement = "interval Newton: f = 0, A q = i omega q, <k, q> = <k, k> have exactly one solution inside the box"
        with checklist.hypothesis("imaginary-pair", "36.6", statement, NARROWER) as evidence:
            matrix, residual = equations_of(claim, found)
            where = require_zero(evidence, names_of(size), matrix, residual, radii_of(claim))
        values = [enclose(value) for row in claim.kernel for value in row]
        u, v = ([a + b for a, b in zip(values[part], where[size + 2 :][part], strict=True)] for part in _parts(size))
        omega = enclose(claim.frequency) + where[size + 1]
        place = _ImaginaryPair(omega, list(map(acb, u, v)), derivatives_of(found))
        others = _check_others(checklist, place)
        left, speed = _check_crossing(checklist, claim, place)
        lyapunov = _check_lyapunov(checklist, place, left)
        return HopfResults(
            point_of(claim, where[:size]),
            claim.parameter,
            enclose(claim.parameters[claim.parameter]) + where[size],
            omega,
            2 * arb.pi() / omega,
            others,
            speed,
            lyapunov,
            "above" if sign(speed) * sign(lyapunov) < 0 else "below",
            "supercritical" if sign(lyapunov) < 0 else "subcritical",
        )

    return concluded(HopfTheorem(claim), checklist, check)


def _parts(size: int) -> tuple[slice, slice]:
    return slice(0, size), slice(size, 2 * size)


def _check_others(checklist: Checklist, place: _ImaginaryPair) -> Spectrum:
    """No eigenvalue but the pair has real part 0; the others."""
    statement = "the other eigenvalues have real parts that are not 0"
    remedy = "smaller radii; if one is on the imaginary axis, this is no such point"
    with checklist.hypothesis("others", "36.7", statement, remedy) as evidence:
        evidence.require(is_positive(place.omega), "omega may not be positive")
        found = spectrum_of(beside_pair(place.known.matrix, place.q))
        for number, value in enumerate(found.values):
            evidence.record(f"real part {number}", value.real)
        evidence.require(found.is_hyperbolic, "one of them may have real part 0", needs_precision=True)
    return found


def beside_pair(matrix: Sequence[Sequence[arb]], q: Sequence[acb]) -> list[list[arb]]:
    """A matrix whose eigenvalues are those of A but for the pair of the eigenvector q (36.7).

    Raises `ZeroDivisionError` if real and imaginary part of q may be dependent.
    """
    size = len(q)
    u, v = [value.real for value in q], [value.imag for value in q]
    # Any two coordinates may be left out: the two in which u and v are least dependent.
    areas = {(i, j): abs(u[i] * v[j] - u[j] * v[i]) for i in range(size) for j in range(i)}
    dropped = max(areas, key=lambda pair: float(areas[pair].mid()))
    kept = [i for i in range(size) if i not in dropped]
    frame = arb_mat([[u[i], v[i], *(arb(int(i == k)) for k in kept)] for i in range(size)])
    moved = frame.solve(arb_mat([list(row) for row in matrix]) * frame)
    return [[moved[i, j] for j in range(2, size)] for i in range(2, size)]


def _check_crossing(checklist: Checklist, claim: HopfPoint, place: _ImaginaryPair) -> tuple[list[acb], arb]:
    """The pair crosses the imaginary axis while the parameter varies; the row l, and how fast."""
    statement = f"the real part of the pair has a derivative in {claim.parameter} that is not 0"
    with checklist.hypothesis("crossing", "36.8", statement, "smaller radii, or more precision") as evidence:
        known = place.known
        left = left_eigenvector(known.matrix, place.omega, place.q)
        moved = [-value for value in solved(known.matrix, known.rate)]
        along = [a + b for a, b in zip(known.quadratic(moved, place.q), known.mixed(place.q), strict=True)]
        speed = evidence.record("speed", product(left, along).real)
        evidence.require(excludes_zero(speed), "it may be 0", needs_precision=True)
    return left, speed


def _check_lyapunov(checklist: Checklist, place: _ImaginaryPair, left: Sequence[acb]) -> arb:
    """The first Lyapunov coefficient is not 0; it, for an eigenvector of length 1."""
    statement = "the first Lyapunov coefficient is not 0"
    with checklist.hypothesis("lyapunov", "36.8", statement, "smaller radii, or more precision") as evidence:
        known, q, omega = place.known, place.q, place.omega
        other = [value.conjugate() for value in q]
        mean = solved(known.matrix, known.quadratic(q, other))
        twice = [
            [acb(0, 2 * omega) * int(i == j) - value for j, value in enumerate(row)]
            for i, row in enumerate(known.matrix)
        ]
        second = solved(twice, known.quadratic(q, q))
        whole = (
            product(left, known.third)
            - 2 * product(left, known.quadratic(q, mean))
            + product(left, known.quadratic(other, second))
        )
        length = product(q, other).real
        lyapunov = evidence.record("l_1", whole.real / (2 * omega * length))
        evidence.require(excludes_zero(lyapunov), "it may be 0", needs_precision=True)
    return lyapunov
