"""The theorems about bifurcations in words (section 9)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from flint import arb

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation import BifurcationResults, TheoremInBox, parameter_name
from orbitproof.verify.claim import claim_in_words, sheet_in_words
from orbitproof.verify.evidence import decimal_interval, located

_DIGITS = 40


def bifurcation_in_words(theorem: TheoremInBox) -> str:
    """The theorem, in short."""
    statement = _statement(claim_in_words(theorem.claim))
    if not theorem.in_own_box:
        return statement
    return f"{statement} The candidate's own box lies in this box and contains the bifurcation point."


def _statement(candidate: Candidate) -> str:
    system, k = candidate.system, candidate.k
    parameter = parameter_name(candidate)
    if system.family_parameter is None:
        parameter = f"the first integral {parameter}" if len(parameter) == 1 else f"the {parameter}"
    fixed = ", ".join(candidate.parameters)
    m = candidate.crossings
    power = "Poincare map P" if m == 1 else f"power P = (Poincare map)^{m}"
    where = f"{power} of the {system.title}{f' ({fixed} as in the candidate)' if fixed else ''}"
    origin = (
        f"the R-symmetric period-two points of the {where} in the box are one regular curve"
        if not candidate.breaks_symmetry
        else f"the R- and {candidate.symmetry}-symmetric period-two points of the {where} in the box are one regular "
        "curve"
    )
    others = f"In the box there is no further R-symmetric point x with P^{2 * k}(x) = x" + (
        f", and none with P^(2i)(x) = x for an i < {k} off the first curve." if k > 1 else "."
    )
    if m > 1:
        times = "time" if m == 2 else f"{m - 1} times"
        others += f" No orbit that starts in the box is in Fix(R) when it meets the section for the first {times}."
    level = system.fixed_level
    if level is not None:
        where_level = f"{system.first_integral_name or 'H'} = {level.value}"
        others += f" All points are on the level {where_level}, those of the box with {sheet_in_words(system)}."
    if candidate.level_sign is not None:
        sign = ">" if candidate.level_sign > 0 else "<"
        names = ", ".join(candidate.titles)
        others += f" The box is in the coordinates {names}, with {system.level_coordinate} {sign} 0."
    if candidate.is_fold:
        return (
            f"{origin}; at exactly one point of it, the bifurcation point, it undergoes a fold, the parameter being "
            f"{parameter}: the derivative of the parameter along the curve vanishes there and nowhere else in the "
            f"box, and the second derivative is not zero. {others}"
        )
    tupled = (
        f"an R-symmetric orbit of period {k} of P^2 that meets Fix(R) twice near the point branches off"
        if k % 2 == 0
        else f"two R-symmetric orbits of period {k} of P^2, each of which meets Fix(R) once near the point, branch off"
    )
    if candidate.uses_symmetry and k > 1:
        tupled += f"; {candidate.symmetry} fixes the points of the first curve and maps the two orbits to each other"
    branch = {
        "symmetry_breaking": "a symmetry breaking bifurcation of P^2: a pair of R-symmetric period-two points, "
        f"exchanged by {candidate.symmetry}, branches off",
        "period_tupling": f"a period-{k}-tupling bifurcation of P^2: {tupled}",
        "touch_and_go": f"a touch-and-go bifurcation of P^2 of order {k}: a curve of R-symmetric points of period "
        f"{k} of P^2 crosses it",
    }[candidate.kind]
    return (
        f"{origin}; at exactly one point of it, the bifurcation point, the parameter being {parameter}, it "
        f"undergoes {branch}. {others}"
    )


def kind_in_words(claim: Candidate) -> str:
    """What the kind of bifurcation means that a claim names, told in words of the claim."""
    k = claim.k
    if claim.is_fold:
        return (
            "Fold means: on one side of the value of the parameter at the bifurcation point the box contains no point "
            "x of Fix(R) with P^2(x) = x; for every value on the other side that is near enough it contains exactly "
            "two, on two different orbits, and they merge at the bifurcation point."
        )
    along = "near the bifurcation point the family has one point for every value of the parameter near its value there"
    if not claim.is_tangential:
        return (
            f"Touch-and-go of order {k} means: {along}; besides it the points x of Fix(R) with P^{2 * k}(x) = x are "
            f"one more curve, which also has one point for every such value, and the two meet at the bifurcation "
            f"point only."
        )
    if claim.breaks_symmetry:
        return (
            f"Symmetry breaking means: {along}; on one side of this value only, there are exactly two further points "
            f"x of Fix(R) near by with P^2(x) = x, exchanged by {claim.symmetry}, and they merge at the bifurcation "
            f"point."
        )
    by = f"P^{k}" if k % 2 == 0 else claim.symmetry if claim.uses_symmetry else None
    exchanged = "" if by is None else f", exchanged by {by},"
    return (
        f"Period-{k}-tupling means: {along}; on one side of this value only, there are exactly two further points x of "
        f"Fix(R) near by with P^{2 * k}(x) = x{exchanged} and they merge at the bifurcation point."
    )


_SIDES = {
    "above": "for values of the parameter greater than that",
    "below": "for values of the parameter less than that",
    "both": "for values of the parameter on both sides of that",
}


def found_in_words(found: BifurcationResults, claim: Candidate, point: Mapping[str, arb]) -> Sequence[str]:
    """What was found, in lines: parameter and side of `found`, and its point by names as they are written."""
    where = ", ".join(located(name, ball, _DIGITS) for name, ball in point.items())
    return [
        f"The bifurcation point has {where}.",
        f"The parameter there, {parameter_name(claim)}, lies in {decimal_interval(found.parameter, _DIGITS)}.",
        f"The {'two' if claim.is_fold else 'new'} orbits exist {_SIDES[found.side]}.",
    ]
