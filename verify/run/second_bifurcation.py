"""Whether the second proof of a bifurcation of periodic orbits says the same as its certificate: its 10.8 and 11.5."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from flint import arb

from orbitproof.verify.run.relation import Comparison, agreement
from orbitproof.verify.run.second_periodic import COUNTS, CROSSINGS, compare_multipliers, is_in_the_box, is_within
from orbitproof.verify.second_proof import ProvedPeriodicBifurcation, ProvedTorus

_NOT_CONFIRMED = "that the candidate's box holds no other bifurcations"


def compare_bifurcation(certificate: Mapping[str, Any], result: ProvedPeriodicBifurcation) -> Comparison:
    """Point, value and period, ball by ball; multipliers, side, kappa and criticality; the point in the claim's box.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    words: dict[str, tuple[Any, Any]] = {"kind": (claim["kind"], result.kind), "side": (results["side"], result.side)}
    words["known multiplier"] = results["known"], result.known
    words["is_fixed"] = results.get("is_fixed"), result.is_fixed
    if result.name is not None:
        words["parameter_name"] = results["parameter_name"], result.name
    criticality = results.get("criticality")
    if None not in (criticality, result.criticality):
        words["criticality"] = criticality, result.criticality
    found = _words(words)
    if found is not None:
        return found
    if criticality is not None and result.criticality is None:
        return Comparison("cannot follow", f"criticality: that it is {criticality} is not shown here")
    if (result.level is None) != (results.get("level") is None):
        return Comparison("disagrees", "level: is here or in the certificate, and not in both")
    pairs = {name: (getattr(result, name), results[name]) for name in ("parameter", "period")}
    pairs["normal_form.kappa"] = result.opening, results["opening"]
    if result.level is not None:
        pairs["level"] = result.level, results["level"]
    parts = ["kind and side", *(["criticality"] if criticality is not None else [])]
    parts += ["where S takes the orbit"] if result.is_fixed is not None else []
    left = ["that the first integral is one"] if claim.get("level") is not None else []
    return _numbers(certificate, result, pairs, parts, [*left, _NOT_CONFIRMED, "the stability of new orbits"])


def compare_torus(certificate: Mapping[str, Any], result: ProvedTorus) -> Comparison:
    """Point, value, period, the pair and both coefficients, ball by ball; multipliers, side, criticality; the box.

    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    words: dict[str, tuple[Any, Any]] = {"kind": (claim["kind"], result.kind)}
    words |= {name: (results[name], getattr(result, name)) for name in ("side", "criticality")}
    words["parameter_name"] = results["parameter_name"], result.name
    found = _words(words)
    if found is not None:
        return found
    pairs = {name: (getattr(result, name), results[name]) for name in ("parameter", "period")}
    pairs |= {f"normal_form.{name}": (getattr(result, name), results[name]) for name in ("speed", "lyapunov")}
    pairs["multiplier, real part"] = result.multiplier.real, results["multiplier"]["real"]
    pairs["multiplier, imaginary part"] = result.multiplier.imag, results["multiplier"]["imaginary"]
    return _numbers(
        certificate, result, pairs, ["kind, side and criticality"], [_NOT_CONFIRMED, "the stability of the torus"]
    )


def _words(words: Mapping[str, tuple[Any, Any]]) -> Comparison | None:
    for name, (theirs, ours) in words.items():
        if theirs != ours:
            return Comparison("disagrees", f"{name}: {theirs} in the certificate, {ours} here")
    return None


def _numbers(
    certificate: Mapping[str, Any],
    result: ProvedPeriodicBifurcation | ProvedTorus,
    more: Mapping[str, tuple[arb, Any]],
    parts: Sequence[str],
    left: Sequence[str],
) -> Comparison:
    """Every ball with the stored one, the multipliers, and the point in the box of the candidate."""
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    if set(results["point"]) != set(result.point):
        return Comparison("disagrees", "point: other coordinates in the certificate")
    pairs = {f"point.{name}": (ball, results["point"][name]) for name, ball in result.point.items()} | dict(more)
    found = compare_multipliers(results["multipliers"], result, on_level=claim.get("level") is not None)
    if isinstance(found, Comparison):
        return found
    middle = claim["level"] if result.name is None else claim["parameters"][result.name]
    places = (
        is_in_the_box(claim, list(result.point.values())),
        is_within(result.parameter, middle, claim["parameter_radius"]),
    )
    is_in_box = False if False in places else None if None in places else True
    return agreement([*parts, CROSSINGS, COUNTS], pairs | found, left, is_in_box, "point with the value")
