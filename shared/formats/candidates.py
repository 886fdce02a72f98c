"""Reading and writing the JSON formats: candidates and certificates.

Schemas stand beside this module in ``schemas/``; unknown keys, JSON floats where exact numbers
belong, NaN and infinities are refused. Errors are `InputError`, one line that names the file, the
field and the remedy. Files are written whole or not at all.
"""

from __future__ import annotations

import json
import os
import re
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cache
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

from orbitproof.shared.numbers import format_exact, format_rational, parse_exact
from orbitproof.shared.systems import MASS_PARAMETERS, SYSTEMS, DescriptionError, ReversibleSystem, describe, described

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator
    from jsonschema.exceptions import ValidationError

FOLD = "fold"
ONCE = ("symmetry_breaking", FOLD)
"""Kinds of bifurcations of period-two points, k = 1; all others have k > 1."""
KINDS = (*ONCE, "period_tupling", "touch_and_go")


class InputError(Exception):
    """Bad input, in one line: what (file and field), why, and what to do about it."""


@dataclass(frozen=True)
class Candidate:
    """A claim: the box ``centre + frame * (P_0 x P_1 x P_2)`` contains a bifurcation.

    Attributes:
        id: unique name within a file.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters, by name.
        kind: one of `KINDS`.
        k: multiplicity; 1 exactly for symmetry breaking and folds.
        symmetry: name of the symmetry that breaks, for symmetry breaking.
        centre: shape (1 + n,), in the order of `coordinates`.
        frame: shape (1 + n, 1 + n), rows; column j is the direction of p_j.
        kernel_frame: shape (n, n), rows; q_i is row i times the kernel coordinates.
        radii: shape (1 + n,), half-widths of P_0, P_1, P_2, all positive.
        provenance: free-form, ignored by the verifier.
        level_sign: `None`, or, if the first integral is the first coordinate, the sign of the system's
            level coordinate, which follows from it on Fix(R).
        crossings: m, how often a half orbit, from Fix(R) to Fix(R), meets the section after its start; P^m then
            stands for P.
    """

    id: str
    system: ReversibleSystem
    parameters: Mapping[str, Fraction]
    kind: str
    k: int
    centre: tuple[Fraction, ...]
    frame: tuple[tuple[Fraction, ...], ...]
    kernel_frame: tuple[tuple[Fraction, ...], ...]
    radii: tuple[Fraction, ...]
    symmetry: str | None = None
    provenance: Mapping[str, Any] = field(default_factory=dict)
    level_sign: int | None = None
    crossings: int = 1

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""

        def refuse(name: str, why: str, remedy: str) -> NoReturn:
            raise InputError(f"{name}: {why}; {remedy}")

        if not isinstance(self.id, str) or not self.id or not self.id.isprintable():
            refuse("id", f"{self.id!r} has characters that cannot be printed, or none", "use letters, digits and signs")
        if self.kind not in KINDS:
            refuse("kind", f"{self.kind!r} is unknown", f"give one of {', '.join(KINDS)}")
        if not isinstance(self.k, int) or self.k < 1:
            refuse("k", f"{self.k!r} is no multiplicity", "give an integer, at least 1")
        if not isinstance(self.crossings, int) or self.crossings < 1:
            refuse("crossings", f"{self.crossings!r} is no number of crossings", "give an integer, at least 1")
        if self.symmetry is not None and self.symmetry not in self.system.symmetries:
            known = ", ".join(self.system.symmetries) or "none"
            refuse("symmetry", f"{self.system.name} has no symmetry {self.symmetry!r}", f"known: {known}")
        names, kernel = self.coordinates, len(self.system.kernel_coordinates)
        size, wanted = len(names), ", ".join(names)
        for name, values in (("centre", self.centre), ("radii", self.radii)):
            if len(values) != size:
                refuse(name, f"{len(values)} numbers", f"{self.system.name} needs {size}: {wanted}")
        for name, matrix, n in (("frame", self.frame, size), ("kernel_frame", self.kernel_frame, kernel)):
            if len(matrix) != n or any(len(row) != n for row in matrix):
                refuse(name, "wrong shape", f"give {n} rows of {n} numbers")
        numbers: dict[str, Sequence[Sequence[Fraction]]] = {
            **{f"parameters.{name}": [[value]] for name, value in self.parameters.items()},
            "centre": [self.centre],
            "frame": self.frame,
            "kernel_frame": self.kernel_frame,
            "radii": [self.radii],
        }
        for name, rows in numbers.items():
            for value in (value for row in rows for value in row):
                if not isinstance(value, (int, Fraction)):
                    refuse(name, f"{value!r} is no exact number", "give Fractions, shared.parse_exact reads them")
                try:
                    short_enough = _can_be_written(Fraction(value), name.startswith("parameters"))
                except ValueError:
                    refuse(name, f"{_short(str(value))} is neither dyadic nor decimal", "round it to a decimal number")
                if not short_enough:
                    why = "a number is too long to be written exactly"
                    refuse(name, why, "give fewer digits or an exponent closer to 0")
        for position, radius in enumerate(self.radii):
            if radius <= 0:
                refuse(f"radii[{position}]", "not positive", "give positive half-widths")

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre, 1 + n of them."""
        return self.system.centre_coordinates if self.level_sign is None else self.system.level_coordinates

    @property
    def is_family_of_maps(self) -> bool:
        """Whether the first coordinate is the bifurcation parameter: a family parameter or the level of H."""
        return self.system.family_parameter is not None or self.level_sign is not None

    def to_json(self, provenance: bool = True) -> dict[str, Any]:
        """The JSON object of the candidate. All numbers must be dyadic or decimal fractions."""
        result: dict[str, Any] = {
            "id": self.id,
            "system": describe(self.system),
            "parameters": {name: format_rational(value) for name, value in self.parameters.items()},
            "kind": self.kind,
            "k": self.k,
            "symmetry": self.symmetry,
            "centre": [format_exact(value) for value in self.centre],
            "frame": [[format_exact(value) for value in row] for row in self.frame],
            "kernel_frame": [[format_exact(value) for value in row] for row in self.kernel_frame],
            "radii": [format_exact(value) for value in self.radii],
        }
        if self.level_sign is not None:
            result |= {"parameter": "first integral", "level_sign": self.level_sign}
        if self.crossings != 1:
            result["crossings"] = self.crossings
        if provenance:
            result["provenance"] = dict(self.provenance)
        return result


@cache
def _validator(name: str) -> Draft202012Validator:
    # Imported late: it takes most of the time of a command that reads nothing.
    from jsonschema import Draft202012Validator

    text = resources.files("orbitproof.shared").joinpath("schemas", f"{name}.schema.json").read_text("utf-8")
    return Draft202012Validator(json.loads(text))


def _refuse_constant(text: str) -> NoReturn:
    raise ValueError(f"{text} is not allowed")


def _unique_keys(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for key, value in pairs:
        if key in result:
            raise ValueError(f"key {key!r} appears twice")
        result[key] = value
    return result


def read_document(path: Path, name: str) -> dict[str, Any]:
    """Read and validate a JSON document against the schema `name` ("candidates", "certificates").

    Raises `InputError` if the file cannot be read, is not JSON, or does not fit the schema.
    """
    try:
        text = path.read_text("utf-8")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); give the path of a {name} file") from None
    except UnicodeDecodeError:
        raise InputError(f"{path}: not a text file; give the path of a {name} file (JSON, UTF-8)") from None
    try:
        document = json.loads(text, parse_constant=_refuse_constant, object_pairs_hook=_unique_keys)
    except json.JSONDecodeError as error:
        raise InputError(
            f"{path}: not valid JSON at line {error.lineno}, column {error.colno} ({error.msg}); "
            "the file may be truncated: write it again"
        ) from None
    except (ValueError, RecursionError) as error:
        raise InputError(f"{path}: {error}; write numbers as exact strings and every key once") from None
    _refuse_other_format(document, name, path)
    validate_document(document, name, str(path))
    return document  # type: ignore[no-any-return]


_FORMATS = {
    "candidates": "candidates, to prove with: orbitproof verify {}",
    "certificates": "certificates, to check again with: orbitproof verify --recheck {}",
    "atlas": "an atlas, to prove with: orbitproof verify atlas {}",
    "atlas-certificate": "the certificate of an atlas, to check again with: orbitproof verify atlas --recheck {}",
    "family": "families, to search with: orbitproof explore candidates --from-family {}",
    "branches": "branches",
    "portraits": "portraits",
    "mass-curve": "curves over the mass",
    "tori": "tori, to draw with: orbitproof figures tori {}",
    "manifold": "a manifold, to draw with: orbitproof figures tori {}",
    "published": "published values",
    "system": "a system, to search with: orbitproof explore family --system {}",
}
"""What a file of each format holds, and the command for it."""


def _refuse_other_format(document: object, name: str, path: Path) -> None:
    """Say what the file is if it is another one of ours."""
    found = str(document.get("format")).removeprefix("orbitproof-") if isinstance(document, dict) else ""
    if found != name and found in _FORMATS:
        wanted = _FORMATS.get(name, name).partition(",")[0]
        raise InputError(f"{path}: field format: needs {wanted}; the file holds {_FORMATS[found].format(path)}")


def validate_document(document: object, name: str, source: str) -> None:
    """Check a JSON value against the schema `name`; raises `InputError` that names the field and the rule."""
    from jsonschema.exceptions import best_match

    error = best_match(_validator(name).iter_errors(document))
    if error is not None:
        where = _short(error.json_path.removeprefix("$").removeprefix(".")) or "the document"
        raise InputError(f"{source}: field {where}: {_broken_rule(error)}; see shared/schemas/{name}.schema.json")


_SIZES = {
    "minItems": "needs at least {} entries",
    "maxItems": "has room for {} entries",
    "minLength": "needs at least {} characters",
    "maxLength": "has room for {} characters",
    "minimum": "must be at least {}",
    "maximum": "must be at most {}",
    "exclusiveMinimum": "must be greater than {}",
}


def _broken_rule(error: ValidationError) -> str:
    """The rule in words. The value is quoted only if it is a short scalar: it may be a whole file."""
    rule = str(error.validator)
    wanted: Any = error.validator_value
    value: Any = error.instance
    schema: Any = error.schema
    if rule == "additionalProperties":
        unknown = sorted(str(key) for key in value if key not in schema.get("properties", {}))
        return f"unknown key {_short(unknown[0])!r}" + (f" and {len(unknown) - 1} more" if unknown[1:] else "")
    if rule == "required":
        return f"key {next(key for key in wanted if key not in value)!r} is missing"
    if rule == "not" and "required" in wanted:
        return f"must not have the key {wanted['required'][0]!r}"
    if isinstance(value, str) and value in MASS_PARAMETERS:
        text = f"is the name of a mass parameter; write its value, {format_exact(MASS_PARAMETERS[value])}"
    elif rule == "pattern":
        text = f"must have the form {wanted}"
    elif rule in ("const", "enum"):
        text = "must be " + " or ".join(json.dumps(choice) for choice in ([wanted] if rule == "const" else wanted))
    elif rule == "type":
        text = "must be of type " + " or ".join([wanted] if isinstance(wanted, str) else wanted)
    else:
        text = _SIZES.get(rule, f"breaks the rule {rule!r}").format(wanted)
    scalar = not isinstance(value, (dict, list))
    return f"{json.dumps(value)} {text}" if scalar and len(str(value)) <= _LONGEST_QUOTED else text


_LONGEST_QUOTED = 100


def _short(text: str) -> str:
    """A text of one line and readable length."""
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST_QUOTED else text[:_LONGEST_QUOTED] + " ..."


def read_candidates(path: Path) -> list[Candidate]:
    """Read a candidates file. Raises `InputError` for anything that is not a well-formed claim."""
    document = read_document(path, "candidates")
    candidates: list[Candidate] = []
    seen: set[str] = set()
    for index, entry in enumerate(document["candidates"]):
        source = f"{path}: field candidates[{index}]"
        candidate = candidate_from_json(entry, source)
        if candidate.id in seen:
            raise InputError(f"{source}.id: {candidate.id!r} appears twice; give each candidate its own id")
        seen.add(candidate.id)
        candidates.append(candidate)
    return candidates


def read_system(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = SYSTEMS
) -> tuple[ReversibleSystem, dict[str, Fraction]]:
    """The system of a JSON object, one of `systems` by name or one that it describes, and its fixed parameters.

    Raises `InputError` that names the field.
    """
    system = find_system(entry["system"], f"{source}.system", systems)
    parameters = {name: parse_exact(text) for name, text in entry["parameters"].items()}
    if set(parameters) != set(system.fixed_parameters):
        wanted = ", ".join(system.fixed_parameters) or "none"
        raise InputError(f"{source}.parameters: {system.name} takes the parameters: {wanted}; give exactly these")
    for name, value in parameters.items():
        interval = system.parameters[name]
        if not interval.contains(value):
            text = _short(entry["parameters"][name])
            raise InputError(f"{source}.parameters.{name}: {text} lies outside {interval}; choose a value inside")
    return system, parameters


def find_system(
    entry: str | Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem]
) -> ReversibleSystem:
    """One of `systems` by its name, or the system that a JSON object describes. Raises `InputError`."""
    if isinstance(entry, str):
        if entry not in systems:
            raise InputError(f"{source}: unknown system {entry!r}; known: {', '.join(systems)}")
        return systems[entry]
    try:
        return described(entry)
    except DescriptionError as error:
        raise InputError(f"{source}.{error}") from None


def candidate_from_json(
    entry: Mapping[str, Any], source: str, systems: Mapping[str, ReversibleSystem] = SYSTEMS
) -> Candidate:
    """A `Candidate` about one of `systems`, from a schema-valid JSON object; `InputError` names the field."""

    def refuse(name: str, why: str, remedy: str) -> NoReturn:
        raise InputError(f"{source}.{name}: {why}; {remedy}")

    system, parameters = read_system(entry, source, systems)
    kind, k = entry["kind"], entry["k"]
    symmetry = entry.get("symmetry")
    if (kind in ONCE) != (k == 1):
        refuse("k", f"{kind} with k = {k}", f"{' and '.join(ONCE)} have k = 1, the other kinds have k > 1")
    level_sign = entry.get("level_sign")
    if (entry.get("parameter") is None) != (level_sign is None):
        refuse("parameter", "parameter and level_sign belong together", "give both or none")
    if level_sign is not None and system.level_coordinate is None:
        refuse("parameter", f"{system.name} has no coordinate that follows from its first integral", "leave it out")
    try:
        return Candidate(
            id=entry["id"], system=system, parameters=parameters, kind=kind, k=k, symmetry=symmetry,
            centre=_vector(entry["centre"]), frame=_matrix(entry["frame"]), radii=_vector(entry["radii"]),
            kernel_frame=_matrix(entry["kernel_frame"]), provenance=entry.get("provenance", {}), level_sign=level_sign,
            crossings=entry.get("crossings", 1),
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"{source}.{error}") from None


def _can_be_written(value: Fraction, is_parameter: bool) -> bool:
    """Whether the text of a number, as `Candidate.to_json` writes it, fits the schema again."""
    schema: Any = _validator("candidates").schema
    kind, text = ("rational", format_rational(value)) if is_parameter else ("number", format_exact(value))
    return re.fullmatch(schema["$defs"][kind]["pattern"], text) is not None


def _vector(texts: Sequence[str]) -> tuple[Fraction, ...]:
    return tuple(parse_exact(text) for text in texts)


def _matrix(rows: Sequence[Sequence[str]]) -> tuple[tuple[Fraction, ...], ...]:
    return tuple(_vector(row) for row in rows)


def write_candidates(path: Path, candidates: Sequence[Candidate]) -> None:
    """Write a candidates file, whole or not at all. Raises `InputError` if it cannot be written."""
    document = {
        "format": "orbitproof-candidates",
        "version": 1,
        "candidates": [candidate.to_json() for candidate in candidates],
    }
    write_document(path, document, "candidates")


def write_document(path: Path, document: Mapping[str, Any], name: str) -> None:
    """Validate `document` against the schema `name` and write it atomically as JSON."""
    validate_document(document, name, f"{name} to be written")
    write_text(path, json.dumps(document, indent=1, allow_nan=False) + "\n")


def check_writable(path: Path) -> None:
    """Raise `InputError` if a file at `path` could not be written; call it before a long run."""
    if path.is_dir():
        raise InputError(f"{path}: is a folder; give the path of a file to write")
    if not path.parent.is_dir():
        raise InputError(f"{path}: folder {path.parent} does not exist; create it or choose another path")
    if not os.access(path.parent, os.W_OK) or (path.exists() and not os.access(path, os.W_OK)):
        raise InputError(f"{path}: cannot be written (permission denied); choose another path")


def write_text(path: Path, text: str) -> None:
    """Write a text file whole or not at all; raises `InputError`."""
    write_bytes(path, text.encode("utf-8"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write a file atomically: a temporary file in the same folder, then a rename. Raises `InputError`."""
    check_writable(path)
    temporary: str | None = None
    try:
        descriptor, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        with os.fdopen(descriptor, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except OSError as error:
        if temporary is not None and os.path.exists(temporary):
            os.unlink(temporary)
        raise InputError(f"{path}: cannot be written ({error.strerror}); free space or choose another path") from None
