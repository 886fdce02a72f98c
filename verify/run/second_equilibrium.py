"""Whether second proofs of equilibria, Hopf points and curves say the same as their certificates: their 17.6, 18.4."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby, pairwise
from typing import Any

from flint import arb

from orbitproof.verify.evidence import ball_from_json
from orbitproof.verify.run.relation import Comparison, agreement
from orbitproof.verify.run.second_periodic import compare_places, is_within
from orbitproof.verify.second_proof import ProvedCurve, ProvedEquilibrium, ProvedHopf

_SIDES = "how many eigenvalues are left and right of the axis"
_FUNCTIONS = "that functions keep their values along orbits"


def compare_equilibrium(certificate: Mapping[str, Any], result: ProvedEquilibrium | ProvedHopf) -> Comparison:
    """The point and eigenvalues, ball by ball, and of a Hopf point all that is stored; the point in the claim's box.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    if set(results["point"]) != set(result.point):
        return Comparison("disagrees", "point: other coordinates in the certificate")
    pairs = {f"point.{name}": (ball, results["point"][name]) for name, ball in result.point.items()}
    places = list(map(is_within, result.point.values(), claim["centre"], claim["radii"]))
    parts = [_SIDES]
    if isinstance(result, ProvedHopf):
        words = {name: (results[name], getattr(result, name)) for name in ("side", "criticality")}
        words["parameter_name"] = results["parameter_name"], result.name
        for name, (theirs, ours) in words.items():
            if theirs != ours:
                return Comparison("disagrees", f"{name}: {theirs} in the certificate, {ours} here")
        pairs |= {name: (getattr(result, name), results[name]) for name in ("parameter", "frequency")}
        pairs["period"] = 2 * arb.pi() / result.frequency, results["period"]
        pairs |= {f"normal_form.{name}": (getattr(result, name), results[name]) for name in ("speed", "lyapunov")}
        places.append(is_within(result.parameter, claim["parameters"][result.name], claim["parameter_radius"]))
        places.append(is_within(result.frequency, claim["frequency"], claim["frequency_radius"]))
        for q, real, imaginary in zip(result.vector, *claim["kernel"], strict=True):
            places += [is_within(x, k, claim["kernel_radius"]) for x, k in ((q.real, real), (q.imag, imaginary))]
        parts = ["side and criticality", f"{_SIDES}, but for the pair"]
    mine = {"left": result.left, "right": result.right}
    found = compare_places(results["eigenvalues"], mine, result.multipliers, ("eigenvalue", "of the axis"))
    if isinstance(found, Comparison):
        return found
    left = [] if result.is_only else ["that the candidate's box holds no other"]
    parts += ["that the box holds no other"] if result.is_only else []
    left += [_FUNCTIONS] if certificate["statement"].get("functions") else []
    is_in_box = False if False in places else None if None in places else True
    return agreement(parts, pairs | found, left, is_in_box)


Sides = tuple[int, int] | None


def compare_curve(certificate: Mapping[str, Any], result: ProvedCurve) -> Comparison:
    """The ends, ball by ball; the folds; the order of the counts of eigenvalues.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    claim, stored = certificate["statement"]["atlas"]["claim"], certificate["conclusion"]
    is_closed, unlike = claim["kind"] == "equilibrium-loop", "disagrees" if claim.get("increasing") else "cannot follow"
    ends = {} if is_closed else {"start": result.start, "end": result.end}
    if any({*stored["ends"][key]} != {*point} for key, point in ends.items()):
        return Comparison("disagrees", "ends: other coordinates in the certificate")
    pairs = {
        f"{key}.{name}": (ball, stored["ends"][key][name])
        for key, point in ends.items()
        for name, ball in point.items()
    }
    for number, fold in enumerate(stored["folds"], start=1):
        held = None if fold.get("all_values") is None else ball_from_json(fold["all_values"])
        near = (each.value for each in result.extrema if each.is_maximum == fold["is_maximum"])
        if not any(held is None or value.overlaps(held) for value in near):
            return Comparison(unlike, f"fold {number}: there is none here")
    theirs = [(part["sides"]["left"], part["sides"]["right"]) if part["sides"] else None for part in stored["sides"]]
    ours: list[Sides] = [part.sides for part in result.parts]
    for place, there, here in (("beginning", theirs[0], ours[0]), ("end", theirs[-1], ours[-1])):
        if not is_closed and None not in (there, here) and there != here:
            return Comparison("disagrees", f"sides: {there} at the {place} in the certificate, {here} here")
    known, found = (_changes(sides) if is_closed else _decided(sides) for sides in (theirs, ours))
    if known != found:
        return Comparison("cannot follow", f"sides: {known} in the certificate, {found} here")
    parts = ["the closed curve" if is_closed else "the curve from end to end", "the folds", "the order of the counts"]
    left = [_FUNCTIONS] if certificate["statement"].get("functions") else []
    left += ["the point that is named"] if is_closed else []
    return agreement(parts, pairs, [*left, "where the counts change"], True, "")


def _decided(sides: Sequence[Sides]) -> list[Sides]:
    """Counts that are decided, each once where they do not change."""
    return [each for each, _ in groupby(each for each in sides if each is not None)]


def _changes(sides: Sequence[Sides]) -> set[Any]:
    """The counts round a loop, wherever it begins: those of neighbours, or the only one."""
    decided = _decided(sides)
    return {pair for pair in pairwise([*decided, *decided[:1]]) if pair[0] != pair[1]} or {*decided}
