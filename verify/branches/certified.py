"""Certificates as points that may lie on a curve (section 15.8)."""

from __future__ import annotations

from collections.abc import Callable

from orbitproof.shared.claims import BOX_KINDS
from orbitproof.shared.formats import Atlas, InputError, candidate_from_json, read_system
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import SYSTEMS, ReversibleSystem
from orbitproof.verify.certificate import Certificate, Recheck
from orbitproof.verify.certificate.stated_system import stated
from orbitproof.verify.curve import CertifiedPoint, certified_systems
from orbitproof.verify.reversor_breaking import BreakingResults, is_shifted_by

Examine = Callable[[Certificate], Recheck]
"""Shows that a certificate's conclusion follows from what it stores."""


def certified_point(atlas: Atlas, certificate: Certificate, examine: Examine) -> CertifiedPoint:
    """What a certificate that fits its schema proves of a point, for a curve."""
    name, kind, k = certificate.id, certificate.kind, certificate.k
    if kind not in BOX_KINDS:
        # Its coordinates may be near the curve's although others, which R negates, are not 0.
        return CertifiedPoint(name, kind, k, "it is about an orbit that need not be symmetric")
    system = _own_system(atlas, certificate)
    if isinstance(system, str):
        return CertifiedPoint(name, kind, k, system, True)
    if not certificate.proved:
        return CertifiedPoint(name, kind, k, f"the certificate says {certificate.verdict!r}")
    examined = examine(certificate)
    if not examined.stands_without_place:
        return CertifiedPoint(name, kind, k, f"the certificate does not stand: {examined.why}")
    statement, orbit = certificate.statement, certificate.orbit
    candidate, signs = statement["candidate"], statement.get("symmetry")
    return CertifiedPoint(
        name,
        kind,
        k,
        parameters={name: parse_exact(text) for name, text in candidate["parameters"].items()},
        reversor=system.reversor,
        crossings=candidate.get("crossings", 1),
        symmetry=candidate.get("symmetry"),
        signs=None if signs is None else tuple(signs),
        point=certificate.point,
        parameter_name=str(certificate.parameter_name),
        parameter=certificate.parameter,
        stability=() if orbit is None else orbit.stability.parameters,
        other_point=None if orbit is None else orbit.other_point,
        shifted_by=_shifting(certificate, system),
        direction=getattr(certificate.results, "direction", None),
    )


def _shifting(certificate: Certificate, system: ReversibleSystem) -> tuple[str, ...]:
    """The symmetries that are shown to shift the orbit by half its period (Lemma 27.6)."""
    found: BreakingResults = certificate.results
    if getattr(found, "direction", None) is None:
        return ()
    known = {**SYSTEMS, system.name: system}
    candidate = candidate_from_json(certificate.statement["candidate"], "statement.candidate", known)
    return tuple(name for name in system.symmetries if is_shifted_by(candidate, found, name))


def _own_system(atlas: Atlas, certificate: Certificate) -> ReversibleSystem | str:
    """The system of a certificate, which is one in which points of the curve are certified; or why it is another."""
    statement = certificate.statement
    own_systems = {system.name: system for system in certified_systems(atlas.system)}
    try:
        # The system of the atlas may be one that is not known here, described by its certificate alone.
        system, parameters = read_system(statement["candidate"], "statement.candidate", {**SYSTEMS, **own_systems})
    except (InputError, KeyError, ValueError) as error:
        return f"the certificate cannot be read: {error}"
    if system.name not in own_systems:
        return f"it is about another system, {system.name}"
    wanted = own_systems[system.name]
    if system.fixed_level != wanted.fixed_level:
        return "it is about another level"
    if (system.section, system.reversing_symmetry) != (wanted.section, wanted.reversing_symmetry):
        return "it is about another section or another reversing symmetry"
    for name, value in atlas.parameters.items():
        if parameters.get(name) != value:
            return f"it is about another value of {name}"
    own = stated(wanted, None)
    if statement["vector_field"] != own["vector_field"]:
        return f"it is about another vector field than that of {system.name} now"
    # exp(x) and exp(x + 1) have the same field in plain arithmetic.
    functions = [vars(each) for each in own["functions"] or ()]
    if list(statement.get("functions") or ()) != functions:
        return f"it is about other functions in the field than those of {system.name} now"
    if wanted.fixed_level is not None and statement.get("first_integral") != own["first_integral"]:
        return f"it is about another first integral than that of {system.name} now"
    return system
