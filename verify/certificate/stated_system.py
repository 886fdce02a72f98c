"""The system that a certificate states, from the certificate alone (section 13.2).

A certificate carries the vector field and the first integral as straight-line programs, and the signs of R and S. That
is all that the verifier uses of a system, so a certificate can be checked where its system is not known. Programs are
read as data. What a system is called is a name: nothing is concluded from it.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from orbitproof.shared.formats import Candidate, WithoutReversor, candidate_to_json
from orbitproof.shared.systems import (
    LEVEL_NAME,
    Defined,
    ParameterRange,
    ReversibleSystem,
    System,
    is_title,
    program_from_text,
    program_function,
)
from orbitproof.verify.certificate.document import (
    Names,
    StatedFunction,
    StatementWithoutReversor,
    StatementWithReversor,
)
from orbitproof.verify.certificate.levels import CannotBeCheckedError
from orbitproof.verify.claim import level_program, quadratic_coefficient

_ANY = ParameterRange(None, None)


def stated(system: ReversibleSystem, symmetry: str | None, with_distance: bool = False) -> dict[str, Any]:
    """What statements about symmetric orbits say of their system, by field; with its distance if asked."""
    integral, distance = system.first_integral_program, system.squared_distance_program if with_distance else None
    return {
        "vector_field": system.program.text(),
        "first_integral": None if integral is None else integral.text(),
        "reversing_symmetry": system.reversing_symmetry,
        "symmetry": None if symmetry is None else system.symmetries[symmetry],
        "section": system.section,
        "functions": stated_functions(system),
        "names": Names(
            system=system.title,
            first_integral=system.first_integral_name,
            distance_from=system.distance_name if with_distance else None,
        ),
        "squared_distance": None if distance is None else distance.text(),
    }


def stated_functions(system: System) -> tuple[StatedFunction, ...] | None:
    """What statements say of the coordinates that are functions of others; `None` without such."""
    return (
        tuple(
            StatedFunction(each.name, each.function, argument.text())
            for each, argument in zip(system.defined, system.argument_programs, strict=True)
        )
        or None
    )


def with_reversor(
    candidate: Candidate, form: Candidate | None = None, with_distance: bool = False
) -> StatementWithReversor:
    """The statement of a claim about symmetric orbits; `form` as in `Kind.statement`."""
    system = candidate.system
    fixed = system.fixed_level
    sign = (form or candidate).level_sign if fixed is None else fixed.sign
    follows = sign is not None and bool(quadratic_coefficient(system))
    return StatementWithReversor(
        claim=candidate_to_json(candidate, provenance=False),
        level_form=None if form is None else candidate_to_json(form, provenance=False),
        level_coordinate=level_program(system, int(sign or 1)).text() if follows else None,
        **stated(system, candidate.symmetry, with_distance),
    )


def without_reversor(claim: WithoutReversor, form: WithoutReversor | None = None) -> StatementWithoutReversor:
    """The statement of a claim that uses no symmetry; such a one has no level form."""
    system = claim.system
    integral = None if claim.level is None else system.first_integral_program
    return StatementWithoutReversor(
        claim=candidate_to_json(claim, provenance=False),
        vector_field=system.program.text(),
        first_integral=None if integral is None else integral.text(),
        functions=stated_functions(system),
        names=Names(system=system.title, first_integral=None if integral is None else system.first_integral_name),
    )


def systems_with(
    known: Mapping[str, ReversibleSystem], statement: Mapping[str, Any], claim: Mapping[str, Any]
) -> Mapping[str, ReversibleSystem]:
    """`known` and the system of a statement, if it is none of them.

    Args:
        statement: of a certificate that fits its schema.
        claim: its candidate or atlas.

    Raises:
        CannotBeCheckedError: if the statement does not describe its system completely.
        ValueError: if what it says cannot be a reversible system.
    """
    name = claim["system"]
    if "reversing_symmetry" not in statement and isinstance(name, str) and name not in known:
        raise CannotBeCheckedError(
            f"the system {name!r} is not known here: a claim without symmetry describes it in full"
        )
    # A description says what the programs say; that both agree is seen when the statement is made again.
    if not isinstance(name, str):
        return known
    return known if name in known else {**known, name: _stated(statement, claim, name)}


def named_as(stored: Mapping[str, Any], again: Mapping[str, Any]) -> dict[str, Any]:
    """The statement `again` with its system called by name alone, and its level as before, where that is stored."""
    result = dict(again)
    level, own = stored.get("level_coordinate"), again.get("level_coordinate")
    if own is not None and is_level_text(level, own):
        result["level_coordinate"] = level
    for key in ("candidate", "level_form", "atlas"):
        system = result.get(key, {}).get("system")
        if isinstance(system, Mapping) and stored.get(key, {}).get("system") == system["name"]:
            result[key] = {**result[key], "system": system["name"]}
    return result


def is_level_text(stored: object, own: str) -> bool:
    """Whether a stored text is `own`, of a `level_program`, or what versions before 0.3 wrote in its place.

    They called the level ``level``, which says the same unless an input of the system is called so.
    """
    earlier = own.replace(f" = {LEVEL_NAME}\n", " = level\n")
    return stored == own or (stored == earlier and " = level\n" not in own)


def _stated(statement: Mapping[str, Any], claim: Mapping[str, Any], name: str) -> ReversibleSystem:
    where = f"the system {name!r} is not known here"
    if "derived_parameters" in statement:
        raise CannotBeCheckedError(f"{where}, and has parameters that follow from others: their ranges are not stated")
    names = statement["names"]
    # The title of a system under another reversor has that one's name after it.
    title, _, reversor = str(names["system"]).partition(", reversible under ")
    for text in (title, reversor or title, *(names[key] for key in names if key != "system")):
        if not is_title(text):
            raise ValueError(f"statement.names: {text!r} is no title of a system that is not known here")
    field = program_from_text(statement["vector_field"])
    text = statement.get("first_integral")
    integral = None if text is None else program_from_text(text)
    size = len(field.outputs)
    state, parameters = field.inputs[:size], field.inputs[size:]
    if integral is not None and (integral.inputs != field.inputs or len(integral.outputs) != 1):
        raise ValueError("statement.first_integral: is not a function of state and parameters of the vector field")
    text = statement.get("squared_distance")
    distance = None if text is None else program_from_text(text)
    if distance is not None and (distance.inputs != field.inputs or len(distance.outputs) != 1):
        raise ValueError("statement.squared_distance: is not a function of state and parameters of the vector field")
    defined = []
    for each, called in zip(
        statement.get("functions", ()), state[size - len(statement.get("functions", ())) :], strict=True
    ):
        argument = program_from_text(each["argument"])
        if each["coordinate"] != called or argument.inputs != field.inputs or len(argument.outputs) != 1:
            raise ValueError("statement.functions: are not the last state coordinates as functions of the others")
        defined.append(Defined(called, each["function"], program_function(argument, size)))
    symmetry, signs = _symmetry_of(claim), statement.get("symmetry")
    if (symmetry is None) != (signs is None):
        raise ValueError("statement.symmetry: the claim names a symmetry and its signs are missing, or the other way")
    if symmetry in field.inputs:
        raise ValueError(f"statement.symmetry: {symmetry!r} is the name of a coordinate or parameter as well")
    given = claim.get("parameters")
    if given is None:
        given = claim["pieces"][0]["parameters"]
    free = [parameter for parameter in parameters if parameter not in given]
    if len(free) > 1 or (integral is None) != (len(free) == 1):
        raise ValueError("parameters: all have to be given but the family parameter, if there is no first integral")
    system = ReversibleSystem(
        name=name,
        title=str(names["system"]),
        state=state,
        parameters=dict.fromkeys(parameters, _ANY),
        vector_field=program_function(field, size),
        defined=tuple(defined),
        reversing_symmetry=tuple(statement["reversing_symmetry"]),
        section=str(statement["section"]),
        symmetries={} if symmetry is None else {symmetry: tuple(signs or ())},
        family_parameter=free[0] if free else None,
        first_integral=None if integral is None else program_function(integral, size),
        first_integral_name=names.get("first_integral"),
        squared_distance=None if distance is None else program_function(distance, size),
        distance_name=names.get("distance_from"),
    )
    return _with_level_coordinate(system, statement, claim)


def _symmetry_of(claim: Mapping[str, Any]) -> str | None:
    name = claim["claim"].get("symmetry") if "claim" in claim else claim.get("symmetry")
    return None if name is None else str(name)


def _with_level_coordinate(
    system: ReversibleSystem, statement: Mapping[str, Any], claim: Mapping[str, Any]
) -> ReversibleSystem:
    """The system with the coordinate that follows from the first integral by the program that is stated for it."""
    form = statement.get("level_form", claim)
    sign, text = form.get("level_sign"), statement.get("level_coordinate")
    if sign is None or text is None:
        return system
    for index in system.fixed_coordinates:
        found = replace(system, level_coordinate=system.state[index])
        if quadratic_coefficient(found) and is_level_text(text, level_program(found, int(sign)).text()):
            return found
    raise ValueError("statement.level_coordinate: does not follow from the first integral that is stated")
