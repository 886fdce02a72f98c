"""Where orbits branch off: which theorem a candidate claims, its hypotheses, and its conclusion (section 9)."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from flint import arb

from orbitproof.shared.claims.fields import Title
from orbitproof.shared.formats import Candidate
from orbitproof.shared.stored import rules, stored
from orbitproof.verify.bifurcation.conditions import (
    Problem,
    check_enclosures,
    check_family,
    check_no_other_orbit,
    check_reduced_function,
    check_reduction,
    check_transversality,
    locate,
)
from orbitproof.verify.bifurcation.nondegeneracy import Nondegeneracy, check_family_of_maps, check_hamiltonian
from orbitproof.verify.bifurcation.reduction import DoublySymmetricFamily, Family
from orbitproof.verify.claim import (
    check_adapted_frames,
    check_frames,
    check_level,
    check_symmetries,
    point_on_fixed_set,
)
from orbitproof.verify.evidence import (
    Checklist,
    DerivativeTable,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    Reason,
    Theorem,
    dot,
    enclose,
    without_result,
)


@dataclass(frozen=True)
class BifurcationResults:
    """What is known about a proved bifurcation.

    Attributes:
        point: enclosure of the bifurcation point, by coordinate name.
        parameter_name: the bifurcation parameter, family parameter or first integral.
        parameter: its enclosure.
        side: "above", "below" or "both": parameter values at which the new orbits exist.
        normal_form: enclosures of the coefficients alpha and beta, and of the derivatives behind them.
        local: enclosures of the bifurcation point's coordinates p in the box.
    """

    point: Mapping[str, arb]
    parameter_name: Title
    parameter: arb
    side: Annotated[str, rules(enum=("above", "below", "both"))]
    normal_form: Mapping[str, arb]
    local: tuple[arb, ...] = stored(hidden=True, default=())


@dataclass(frozen=True)
class BifurcationTheorem:
    """The box of a claim contains exactly one bifurcation, of the kind that it names (9, 11.2 to 11.5).

    Attributes:
        claim: what the hypotheses are about; made by `theorem_of`, which refuses claims that no theorem is about.
        in_own_box: whether the claim is the level form of a candidate, and it is shown besides that the candidate's
            own box lies in that of the claim and contains the bifurcation point (section 12.3).
    """

    claim: Candidate
    in_own_box: bool = False

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        k, hamiltonian = self.claim.k, not self.claim.is_family_of_maps
        prefix = "H" if hamiltonian else ""
        names = ["family", *(f"regular-{i}" for i in range(1, k))] if k > 1 else []
        names += [f"{prefix}C2", f"{prefix}C3", f"{prefix}C4", "point"]
        if hamiltonian:
            names += ["dH/dp_0", "h_fp'", "h_b''" if self.claim.is_tangential else "h_b'"]
        else:
            names += ["G_01", "G_111"] if self.claim.is_tangential else ["G_11"]
        return around(self.claim, names, self.in_own_box)


def around(claim: Candidate, names: Sequence[str], in_own_box: bool) -> tuple[str, ...]:
    """The hypotheses of a theorem with these conditions, in the order of checking."""
    before = ["symmetries", "frames"]
    before += ["level"] if claim.uses_level else []
    before += ["adapted-frames"] if claim.uses_symmetry else []
    before += ["poincare-map"]
    before += ["half-orbit"] if claim.crossings > 1 else []
    return (*before, *names, *(("level-box", "candidate-box") if in_own_box else ()))


Tell = Callable[[Problem, Reason], Reason]
"""Why a condition failed, in better words (`refusals`)."""


def theorem_of(candidate: Candidate) -> BifurcationTheorem | Reason:
    """The theorem that a candidate claims, or why none applies."""
    kind, k = candidate.kind, candidate.k
    if not candidate.has_branch:
        return Reason("theorem", f"{kind}: no orbits branch off", "claim another kind")
    if candidate.breaks_symmetry != (k == 1):
        return Reason("theorem", f"{kind} with k = {k}", "symmetry breaking has k = 1, the other kinds k > 1")
    if kind == "touch_and_go" and k % 2 == 0:
        return Reason("theorem", f"touch-and-go is for odd k, this is k = {k}", "claim period_tupling for even k")
    if kind == "touch_and_go" and k > 3:
        message = f"at odd k = {k} >= 5 the second derivative G_11 vanishes: touch-and-go cannot happen"
        return Reason("theorem", message, "claim period_tupling for odd k >= 5 (section 11)")
    return BifurcationTheorem(candidate)


def parameter_name(candidate: Candidate) -> str:
    """Name of the bifurcation parameter: the family parameter or the first integral."""
    system = candidate.system
    return system.family_parameter or system.first_integral_name or "H"


def prove(
    candidate: Candidate,
    checklist: Checklist,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb] = (),
    tell: Tell = lambda _problem, reason: reason,
) -> Outcome[BifurcationResults]:
    """Check the theorem that `candidate` claims, given enclosures of derivatives of P, .., P^k and H.

    `checklist` already holds what was established before the integration (see `check_exactly`); the
    current precision of Arb is used. Every failure is a `NotProved` that names the condition. The
    times of the crossings, if given, go into the certificate. `tell` is asked about a claim of which a
    condition fails.
    """
    theorem = theorem_of(candidate)
    return conclude(theorem, check, candidate, checklist, iterates, first_integral, return_times, tell)


def conclude(
    theorem: Theorem | Reason,
    check: Callable[[Candidate, Checklist, Problem], BifurcationResults],
    candidate: Candidate,
    checklist: Checklist,
    iterates: Sequence[Sequence[DerivativeTable]],
    first_integral: DerivativeTable | None,
    return_times: Sequence[arb],
    tell: Tell,
) -> Outcome[BifurcationResults]:
    """What follows for any theorem about a box, whose conditions `check` looks at, one by one."""
    if isinstance(theorem, Reason):
        return NotProved(theorem, tuple(checklist.hypotheses))
    problem: Problem | None = None
    try:
        problem = check_enclosures(checklist, candidate, iterates, first_integral, return_times)
        return Proved(theorem, check(candidate, checklist, problem), tuple(checklist.hypotheses))
    except NotEstablishedError as error:
        reason = error.reason if problem is None else tell(problem, error.reason)
    except ArithmeticError as error:
        pending = (*theorem.hypotheses, "results")[len(checklist.hypotheses)]
        message = f"{pending} could not be evaluated: {without_result(error)}"
        reason = Reason(pending, message, "more precision", needs_precision=True)
    return NotProved(reason, tuple(checklist.hypotheses))


def prepare(candidate: Candidate, checklist: Checklist) -> None:
    """The exact hypotheses about coordinates, which need no integration."""
    check_frames(checklist, candidate)
    if candidate.uses_level:
        check_level(checklist, candidate)
    if candidate.uses_symmetry:
        check_adapted_frames(checklist, candidate)


def check_exactly(checklist: Checklist, candidate: Candidate) -> None:
    """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""
    check_symmetries(checklist, candidate.system, candidate.symmetry)
    prepare(candidate, checklist)


def check(candidate: Candidate, checklist: Checklist, problem: Problem) -> BifurcationResults:
    """The conditions, one by one; raises `NotEstablishedError` for the first that is not shown."""
    k = candidate.k
    family: Family
    if k > 1:
        family = check_family(checklist, problem)
        for i in range(1, k):
            check_no_other_orbit(checklist, problem, i)
        reduction = check_reduction(checklist, problem, family)
    else:
        reduction = check_reduction(checklist, problem, None)
        family = DoublySymmetricFamily(reduction)
    check_reduced_function(checklist, problem, family, reduction)
    check_transversality(checklist, problem, family, reduction)
    point = locate(checklist, problem, family, reduction)
    if problem.first_integral is None:
        conclusion = check_family_of_maps(checklist, candidate, reduction, point)
    else:
        conclusion = check_hamiltonian(checklist, candidate, problem, family, reduction, point)
    return results_at(candidate, problem, point.where, conclusion)


def results_at(
    candidate: Candidate, problem: Problem, where: tuple[arb, ...], conclusion: Nondegeneracy
) -> BifurcationResults:
    """What is known of the bifurcation point, from the enclosure of its coordinates p and from its type."""
    coordinates = [
        enclose(origin) + dot([enclose(value) for value in row], where)
        for origin, row in zip(candidate.centre, candidate.frame, strict=True)
    ]
    named = dict(zip(candidate.coordinates, coordinates, strict=True))
    if candidate.level_sign is not None:
        named = point_on_fixed_set(candidate, named)
    parameter = coordinates[0] if problem.first_integral is None else problem.first_integral.value(where)
    normal_form = {name: ball for name, ball in conclusion.normal_form.items() if ball.is_finite()}
    return BifurcationResults(named, parameter_name(candidate), parameter, conclusion.side, normal_form, tuple(where))
