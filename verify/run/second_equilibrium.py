"""Whether the second proof of an equilibrium or of a Hopf point says the same as its certificate: its 17.6."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from flint import arb

from orbitproof.verify.run.relation import Comparison, agreement
from orbitproof.verify.run.second_periodic import compare_places, is_within
from orbitproof.verify.second_proof import ProvedEquilibrium, ProvedHopf

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
