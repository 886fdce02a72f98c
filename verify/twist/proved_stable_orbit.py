"""A symmetric orbit that is stable for ever: hypotheses and results (sections 28.1 and 28.6)."""

from __future__ import annotations

from dataclasses import dataclass, fields

from flint import arb

from orbitproof.shared.claims.fields import Identifier
from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation import check_exactly
from orbitproof.verify.evidence import (
    Checklist,
    Outcome,
    Reason,
    all_finite,
    concluded,
    dot,
    enclose,
    excludes_zero,
    is_positive,
    show,
    sign,
)
from orbitproof.verify.newton import Jet
from orbitproof.verify.orbit import (
    OrbitResults,
    OrbitTheorem,
    check_orbit,
    full_return_jets,
    half_return_jets,
    jets_on_level,
)
from orbitproof.verify.twist.following import StableOrbitEnclosures
from orbitproof.verify.twist.normal_form import Rotation, Twist, rotation_of, stability_parameter, twist_of

_RESONANCES = (1, 2, 3, 4)


@dataclass(frozen=True, kw_only=True)
class StableOrbitResults(OrbitResults):
    """What is known of a proved orbit that is stable for ever.

    Attributes:
        rotation_number: omega / (2 pi), in (0, 1/2): by what part of a turn orbits near by turn in a period.
        twist_coordinate, twist_momentum: the coordinates t and q of the section in which the twist is measured.
        twist: tau: a small invariant curve that encloses the area A of the (t, q) turns by about omega + tau A / pi.
        defect: enclosure of Re(conj(lambda) c_1), which is 0 by reversibility.
    """

    rotation_number: arb
    twist_coordinate: Identifier
    twist_momentum: Identifier
    twist: arb
    defect: arb


@dataclass(frozen=True)
class StableOrbitTheorem:
    """The box of a claim contains exactly one point of an orbit as claimed, which is stable for ever (Theorem 28.6)."""

    claim: Candidate

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        names = OrbitTheorem(self.claim).hypotheses
        integrated = names.index("poincare-map")
        more = ("return-map", "elliptic", "non-resonance", "twist")
        return (*names[:integrated], "plane", *names[integrated:], *more)


def stable_orbit_theorem(claim: Candidate) -> StableOrbitTheorem | Reason:
    """The theorem that a claim asks for, or why there is none: n has to be 1 (28.1)."""
    return (
        StableOrbitTheorem(claim) if len(claim.system.kernel_coordinates) == 1 else Reason("plane", *_no_plane(claim))
    )


def _no_plane(claim: Candidate) -> tuple[str, str]:
    n = len(claim.system.kernel_coordinates)
    message = (
        f"stability for ever is claimed of an orbit with n = {n}, of which it is not known: twist decides for n = 1"
    )
    return message, "claim it in a system with n = 1, such as the planar problem, or claim an orbit only"


def check_stable_orbit_exactly(checklist: Checklist, claim: Candidate) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_exactly(checklist, claim)
    message, remedy = _no_plane(claim)
    statement = "R negates one coordinate of the section: n = 1, and the section on a level is a plane"
    with checklist.hypothesis("plane", "28.1", statement, remedy) as evidence:
        evidence.require(len(claim.system.kernel_coordinates) == 1, message)


def prove_stable_orbit(
    claim: Candidate, checklist: Checklist, enclosures: StableOrbitEnclosures | None
) -> Outcome[StableOrbitResults]:
    """Check that the box contains exactly one orbit as claimed, stable for ever; `None` stands for no enclosures.

    `checklist` already holds what was established before the integration; the current precision of Arb is used.
    """

    def check() -> StableOrbitResults:
        orbit = check_orbit(checklist, claim, enclosures)
        assert enclosures is not None
        functions = _check_return(checklist, claim, enclosures)
        rotation = _check_elliptic(checklist, functions, orbit)
        _check_resonances(checklist, rotation)
        place, area = _own_area(claim, enclosures)
        found = _check_twist(checklist, claim, functions, rotation, area)
        return StableOrbitResults(
            **{each.name: getattr(orbit, each.name) for each in fields(OrbitResults)},
            rotation_number=rotation.cosine.acos() / (2 * arb.pi()),
            twist_coordinate=place,
            twist_momentum=claim.system.state[claim.system.kernel_coordinates[0]],
            twist=found.twist,
            defect=found.defect,
        )

    return concluded(StableOrbitTheorem(claim), checklist, check)


def _check_return(checklist: Checklist, claim: Candidate, found: StableOrbitEnclosures) -> tuple[Jet, ...]:
    """The derivatives of the half return are there and finite, and so are those of the full return."""
    statement = "the half return has a regular derivative on the level, and the full return R P^-1 R P finite jets"
    functions: tuple[Jet, ...] = ()
    with checklist.hypothesis("return-map", "19.8", statement, "smaller radii or more precision") as evidence:
        half, has_integral = found.half_return, claim.system.first_integral is not None
        complete = half.is_complete(1, has_integral)
        evidence.require(complete, "a derivative is missing, or there is one too many")
        if complete:
            functions = full_return_jets(half_return_jets(claim, half))
            names = ("dp/dp", "dp/dq", "dq/dp", "dq/dq")
            entries = [jet[index] for jet in functions for index in ((1, 0), (0, 1))]
            for name, ball in zip(names, entries, strict=True):
                evidence.record(name, ball)
            balls = [ball for jet in functions for ball in jet.coefficients.values()]
            evidence.require(all_finite(balls), "an enclosure is not finite", needs_precision=True)
    return functions


def _check_elliptic(checklist: Checklist, functions: tuple[Jet, ...], orbit: OrbitResults) -> Rotation:
    """The multipliers are two numbers on the unit circle that are not real."""
    statement = "the stability parameter s lies in (-1, 1)"
    remedy = "claim an orbit only, or another one: this one may be unstable"
    with checklist.hypothesis("elliptic", "28.2", statement, remedy) as evidence:
        (other,) = orbit.stability.parameters or (None,)
        s = evidence.record("s", stability_parameter(functions))
        evidence.require(
            other is not None and bool(other.real.overlaps(s)), "s is not that of the orbit: an enclosure is wrong"
        )
        beyond = is_positive(s * s - 1)
        inside = is_positive(1 - s * s)
        evidence.require(inside, f"s is in {show(s)}", needs_precision=not beyond, excluded=beyond)
        rotation = rotation_of(functions) if inside else None
    assert rotation is not None
    return rotation


def _check_resonances(checklist: Checklist, rotation: Rotation) -> None:
    """No power of lambda up to the fourth is 1."""
    statement = "lambda, lambda^2, lambda^3 and lambda^4 are not 1"
    remedy = "more precision, or another orbit: at a resonance of order 3 or 4 nothing is said"
    with checklist.hypothesis("non-resonance", "28.3", statement, remedy) as evidence:
        power = rotation.multiplier
        for order in _RESONANCES:
            distance = evidence.record(f"abs(lambda^{order} - 1)", abs(power - 1))
            evidence.require(is_positive(distance), f"lambda^{order} may be 1", needs_precision=True)
            power = power * rotation.multiplier


def _own_area(claim: Candidate, found: StableOrbitEnclosures) -> tuple[str, arb]:
    """A state coordinate t by which orbits of the level are told apart on Fix(R), and dt dq by the area of the jets.

    Raises `ZeroDivisionError` if none has a derivative that is shown not to be 0.
    """
    system = claim.system
    slopes = [jet[1, 0] for jet in jets_on_level(claim, found.half_return)[: len(claim.radii)]]
    for name, row in zip(claim.coordinates, claim.frame, strict=True):
        area = dot([enclose(value) for value in row], slopes)
        if name in system.state and excludes_zero(area):
            return name, abs(area)
    raise ZeroDivisionError("no coordinate of Fix(R) is shown to change along the level")


def _check_twist(
    checklist: Checklist, claim: Candidate, functions: tuple[Jet, ...], rotation: Rotation, area: arb
) -> Twist:
    """The twist is not 0, and has the sign that is claimed, if one is."""
    wanted = claim.twist
    sentence = "is not 0" if wanted is None else f"is {'positive' if wanted > 0 else 'negative'}"
    statement = f"the twist tau {sentence}, and Re(conj(lambda) c_1) may be 0"
    with checklist.hypothesis(
        "twist", "28.3", statement, "smaller radii or more precision, or another orbit"
    ) as evidence:
        found = twist_of(functions, rotation)
        found = Twist(found.twist / area, found.defect / area)
        tau, defect = evidence.record("tau", found.twist), evidence.record("Re(conj(lambda) c_1)", found.defect)
        evidence.require(not excludes_zero(defect), f"it is in {show(defect)}: an enclosure is wrong")
        decided = sign(tau)
        evidence.require(decided != 0, f"tau is in {show(tau)}", needs_precision=True)
        evidence.require(wanted in (None, decided), f"tau is in {show(tau)}", excluded=True)
    return found
