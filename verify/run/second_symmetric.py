"""Whether the second proof of a symmetric orbit or of a birth says the same as its certificate: its 14.3 and 15.4."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import acb, arb

from orbitproof.verify.evidence import ball_from_json
from orbitproof.verify.run.relation import NOT_CONFIRMED, Comparison, agreement
from orbitproof.verify.run.second_periodic import CROSSINGS, is_in_the_box
from orbitproof.verify.second_proof import ProvedBirth, ProvedSymmetric, Torsion

Pairs = dict[str, tuple[arb, Any]]


def compare_birth(certificate: Mapping[str, Any], result: ProvedBirth) -> Comparison:
    """Both points, the parameter, period, direction and kappa, ball by ball; the side; the point in the claim's box.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    results = certificate["results"]
    if results["side"] != result.side:
        return Comparison("disagrees", f"side: {results['side']} in the certificate, {result.side} here")
    pairs: Pairs = {name: (getattr(result, name), results[name]) for name in ("parameter", "period")}
    # Of the normal form, so that its sign has to be shown.
    pairs["normal_form.kappa"] = result.opening, results["opening"]
    named = ("point", "other_point", "direction")
    return _compared(certificate, result, named, pairs, ["kind and side"], ["gamma and beta but for their quotient"])


def compare_symmetric(certificate: Mapping[str, Any], result: ProvedSymmetric) -> Comparison:
    """Both points, period, level, stability parameters, rotation number and twist; the point in the claim's box.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    results = certificate["results"]
    pairs: Pairs = {"period": (result.period, results["period"])}
    pairs["half_period"] = result.period / 2, results["half_period"]
    if (result.level is None) != (results.get("level") is None):
        return Comparison("disagrees", "level: is here or in the certificate, and not in both")
    if result.level is not None:
        pairs["level"] = result.level, results["level"]
    found = _stability(results, result, pairs)
    if found is not None:
        return found
    parts = ["kind", f"stability ({results['stability']})"]
    if result.rotation_number is not None:
        found = _twist(results, result, pairs)
        if found is not None:
            return found
        parts.append("the sign of the twist")
    if result.torsion is not None:
        found = _torsion(results, result.torsion, pairs)
        if found is not None:
            return found
        parts.append("the sign of the determinant of the torsion")
    left = ["that the first integral is one"] if result.level is not None else []
    left += ["distances"] if results.get("least_distance") is not None else []
    return _compared(certificate, result, ("point", "other_point"), pairs, parts, left)


def _stability(results: Mapping[str, Any], result: ProvedSymmetric, pairs: Pairs) -> Comparison | None:
    """Stability parameters in some order, multipliers that belong to them, the word."""
    stored = [_complex(value) for value in results["stability_parameters"]]
    mine = list(result.stability)
    if len(stored) != len(mine):
        return Comparison("disagrees", "stability_parameters: another number of them")
    if len(mine) == 2 and not (mine[0].overlaps(stored[0]) and mine[1].overlaps(stored[1])):
        mine.reverse()
    for number, (value, entry) in enumerate(zip(mine, results["stability_parameters"], strict=True), start=1):
        pairs[f"stability parameter {number}, real part"] = value.real, entry["real"]
        pairs[f"stability parameter {number}, imaginary part"] = value.imag, entry["imaginary"]
    # There are none where it is not known which parameters are real.
    if len(results["multipliers"]) not in (0, len(mine)):
        return Comparison("disagrees", "multipliers: another number of them")
    for number, (value, entry) in enumerate(zip(mine, results["multipliers"], strict=False), start=1):
        at = _complex(entry)
        if not at.is_finite() or at.contains(0):
            return Comparison("cannot follow", "multipliers: an enclosure contains 0 or is not finite")
        # Of one pair with the sum 2 c and the product 1 the one that is stored, if that is told from the other.
        root = (value * value - 1).sqrt()
        near = [each for each in (value + root, value - root) if each.overlaps(at)]
        if not near:
            return Comparison("disagrees", "multipliers: they do not belong to the stability parameters")
        here = near[0] if len(near) == 1 else near[0].union(near[1])
        pairs[f"multiplier {number}, real part"] = here.real, at.real
        pairs[f"multiplier {number}, imaginary part"] = here.imag, at.imag
    stable = all(value.imag == 0 and abs(value) < 1 for value in mine)
    unstable = any(abs(value) > 1 or not value.imag.contains(0) for value in mine)
    word = results["stability"]
    if (word == "linearly stable" and unstable) or (word == "unstable" and stable):
        return Comparison("disagrees", f"stability: {word} in the certificate, and not here")
    if (word == "linearly stable" and not stable) or (word == "unstable" and not unstable):
        return Comparison("cannot follow", f"stability: that it is {word} is not shown here")
    return None


def _twist(results: Mapping[str, Any], result: ProvedSymmetric, pairs: Pairs) -> Comparison | None:
    """The rotation number, the twist in the coordinate that is named, and what is 0."""
    name, momentum = results["twist_coordinate"], results["twist_momentum"]
    if momentum != result.momentum:
        return Comparison("disagrees", f"twist_momentum: {momentum} in the certificate, {result.momentum} here")
    if name not in result.twists:
        return Comparison("cannot follow", f"twist_coordinate: the level is not shown to have the coordinate {name}")
    assert result.rotation_number is not None
    pairs["rotation_number"] = result.rotation_number, results["rotation_number"]
    pairs["normal_form.twist"] = result.twists[name], results["twist"]
    if not ball_from_json(results["defect"]).contains(0):
        return Comparison("disagrees", "defect: is not 0 in the certificate")
    return None


def _torsion(results: Mapping[str, Any], found: Torsion, pairs: Pairs) -> Comparison | None:
    """The rotation numbers; of the torsion what does not depend on the lengths of vectors."""
    for number, (value, entry) in enumerate(
        zip(found.rotation_numbers, results["rotation_numbers"], strict=True), start=1
    ):
        pairs[f"rotation number {number}"] = value, entry
    determinant = ball_from_json(results["torsion_determinant"])
    if determinant.contains(0) or (determinant > 0) != (found.determinant > 0):
        return Comparison("disagrees", "torsion_determinant: another sign than here")
    (a, b), (c, d) = ([ball_from_json(entry) for entry in row] for row in results["torsion"])
    (k, l), (m, n) = found.rows
    pairs["tau_11 tau_22/(tau_12 tau_21)"] = k * n / (l * m), a * d / (b * c)
    return None


def _compared(
    certificate: Mapping[str, Any],
    result: ProvedBirth | ProvedSymmetric,
    named: Sequence[str],
    pairs: Pairs,
    parts: Sequence[str],
    left: Sequence[str],
) -> Comparison:
    """Every ball with the stored one, and the point in the box of the candidate."""
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    for part in named:
        mine: Mapping[str, arb] = getattr(result, part)
        if set(results[part]) != set(mine):
            return Comparison("disagrees", f"{part}: other coordinates in the certificate")
        pairs |= {f"{part}.{name}": (ball, results[part][name]) for name, ball in mine.items()}
    is_in_box = is_in_the_box(claim, result.coordinates)
    return agreement([*parts, CROSSINGS], pairs, [*left, NOT_CONFIRMED], is_in_box)


def _complex(entry: Mapping[str, Any]) -> acb:
    return acb(ball_from_json(entry["real"]), ball_from_json(entry["imaginary"]))
