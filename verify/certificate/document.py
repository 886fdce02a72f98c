"""What certificates hold, as values: their JSON and its schema follow from the types (section 10.2)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from flint import arb

from orbitproof.shared.claims import BOX_KINDS, KINDS_WITHOUT_REVERSOR
from orbitproof.shared.claims.fields import Id, Identifier, Line, Numbers, PieceId, Title
from orbitproof.shared.stored import rules, stored

Verdict = Literal["proved", "not proved"]
Signs = tuple[Annotated[int, rules(enum=(1, -1))], ...]
Digest = Annotated[str, rules("digest", pattern=r"^sha256:[0-9a-f]{64}(?![\s\S])")]
Version = Annotated[str, rules("software", pattern=r"^(not installed|[A-Za-z0-9][A-Za-z0-9.:+_-]{0,99})(?![\s\S])")]
Software = Mapping[Version, Version]


def by_verdict(proved: Mapping[str, Any], not_proved: Mapping[str, Any]) -> dict[str, Any]:
    """What a schema says of an object with a `verdict`, by what that is: of its properties.

    A statement has its theorem, and a reason is missing, just if the verdict is "proved".
    """
    words = ("theorem", "in_full")
    return {
        "if": {"properties": {"verdict": {"const": "proved"}}},
        "then": {"properties": {"statement": {"required": list(words)}, "reason": {"type": "null"}, **proved}},
        "else": {
            "properties": {
                "statement": {"allOf": [{"not": {"required": [name]}} for name in words]},
                "reason": {"type": "object"},
                **not_proved,
            }
        },
    }


@dataclass(frozen=True, kw_only=True)
class Document:
    """What the certificate of a theorem of any kind says.

    Attributes:
        id: of the claim, or of the curve that it is about.
        reason: why the claim is not proved. Failure to verify is not a proof that it is false.
        software: names and versions of what made this certificate, with a digest of the sources.
        digest: SHA-256 of the certificate without this key, as JSON with sorted keys and no spaces.
    """

    id: Id
    verdict: Verdict
    software: Software
    digest: Digest


@dataclass(frozen=True, kw_only=True)
class Names:
    """What a theorem calls a system, its first integral, and the body that distances are from."""

    system: Title
    first_integral: Title | None = None
    distance_from: Title | None = None


@dataclass(frozen=True, kw_only=True)
class Stated:
    """A claim in full, of any kind, and the system that it is about.

    Attributes:
        claim: without provenance.
        vector_field, first_integral: as straight-line programs.
        names: what the theorem calls the system, its first integral, and the body that distances are from.
        theorem: what is proved, in words; absent if it is nothing.
        in_full: the same so that it stands alone: the system as formulas, the claim, what its words mean, the
            enclosures.
    """

    claim: Mapping[str, Any]
    vector_field: str
    first_integral: str | None
    names: Names
    theorem: str | None = None
    in_full: str | None = None


@dataclass(frozen=True)
class StatedFunction:
    """A state coordinate that is a function of others: of its argument, a straight-line program."""

    coordinate: Identifier
    function: Annotated[str, rules(enum=("sin", "cos", "exp", "log"))]
    argument: str


@dataclass(frozen=True, kw_only=True)
class StatedWithReversor(Stated):
    """A claim about symmetric orbits, with the system that it is about.

    Attributes:
        functions: the last state coordinates, if these are functions of the others at all states that are meant.
        reversing_symmetry, symmetry: the signs of R and S.
        section: the coordinate that vanishes on it.
        squared_distance: the square of the distance, as a straight-line program, if the results are about it.
    """

    reversing_symmetry: Signs
    symmetry: Signs | None
    section: Identifier
    functions: Annotated[tuple[StatedFunction, ...], rules(minItems=1, maxItems=20)] | None = None
    squared_distance: str | None = None


@dataclass(frozen=True, kw_only=True)
class StatementWithReversor(StatedWithReversor):
    """The statement of a candidate about symmetric orbits.

    Attributes:
        level_form: the candidate rewritten with the first integral as parameter: the hypotheses, the theorem and its
            box are about this form. Absent if they are about the candidate as it is.
        level_coordinate: with the first integral as parameter: the coordinate that follows from it, as a program.
    """

    claim: Annotated[
        Mapping[str, Any],
        rules(required=("kind", "k"), properties={"kind": {"enum": BOX_KINDS}, "k": {"type": "integer"}}),
    ] = stored("candidate")
    level_form: Mapping[str, Any] | None = None
    level_coordinate: str | None = None


@dataclass(frozen=True, kw_only=True)
class StatementWithoutReversor(Stated):
    """The statement of a candidate which uses no symmetry.

    Attributes:
        functions: as in `StatedWithReversor`.
    """

    claim: Annotated[
        Mapping[str, Any], rules(required=("kind",), properties={"kind": {"enum": tuple(KINDS_WITHOUT_REVERSOR)}})
    ] = stored("candidate")
    functions: Annotated[tuple[StatedFunction, ...], rules(minItems=1, maxItems=20)] | None = None


AnyStatement = StatementWithReversor | StatementWithoutReversor


@dataclass(frozen=True)
class Computation:
    """How a verdict was found.

    Attributes:
        precision: bits of the last attempt, 0 if there was none.
        order: time order of its Taylor expansions.
        steps: its integration steps.
        attempts: how many there were.
        seconds: of processor time, for all of it.
        coordinates: in which the orbits were followed, if the certificate says so.
        given_radii: half-widths of the box that was given, if the claim is not proved on it, and the candidate in the
            statement, on another one, is.
    """

    precision: Annotated[int, rules(minimum=0, maximum=65536)]
    order: Annotated[int, rules(minimum=0, maximum=4096)]
    steps: Annotated[int, rules(minimum=0)]
    attempts: Annotated[int, rules(minimum=0)]
    seconds: float
    coordinates: Annotated[Line, rules(maxLength=200)] | None = None
    given_radii: Numbers | None = None


@dataclass(frozen=True)
class RestsOn:
    """The certificate that proves a curve."""

    id: Id
    digest: Digest


@dataclass(frozen=True)
class StoredPlace:
    """Where an orbit lies on a proved curve.

    Attributes:
        rests_on: the certificate that proves the curve.
        mirrored: whether it is the mirror image that lies in the piece.
        other_point: whether it is the other point of the orbit on Fix(R).
    """

    rests_on: RestsOn
    piece: PieceId
    s: arb
    mirrored: bool
    other_point: bool
    statement: Line
