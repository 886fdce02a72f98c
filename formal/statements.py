"""What Coq has evaluated of a row (`statement.txt`), read once more and compared with the claim of a certificate.

The file is Coq's own print of the record that `all_checked` is about. Of a wording that is not expected nothing is
read, and what is not read is not the claim.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.formal.arithmetic import Node, Program
from orbitproof.formal.recording import recorded
from orbitproof.formal.rows import Affine, claim_of, starts_of, stated_of
from orbitproof.shared.formats import Candidate
from orbitproof.verify.certificate import Certificate
from orbitproof.verify.claim import quadratic_coefficient

_BEGIN = "     = "
_END = """
     : Programs.program * nat * nat * (list rational * list initial) *
       option (Programs.program * rational * bigZ * initial) *
       (list bigZ * option (list bigZ) * list (list rational) * nat) * option Programs.program * claim * option box
statement : checked Conclusion.the_bifurcation
Axioms:"""
_TOKEN = re.compile(r"\s*(\{\||\|\}|:=|[()\[\];,]|-?[0-9]+|[A-Za-z_][\w'.]*)(?:%[a-z]\w*)?")
_SIDES = {"above": 1, "below": -1, "both": 0}


@dataclass(frozen=True)
class Applied:
    """A name with its module, as Coq prints it, and what it is applied to: a file can define a `None` of its own."""

    head: str
    to: tuple[Any, ...] = ()


_NONE = Applied("None")


def _some(value: Any) -> Applied:
    return Applied("Some", (value,))


class _Reader:
    """A term of Coq: numbers, lists, tuples, applied names; records by their fields, rational numbers as such."""

    def __init__(self, text: str) -> None:
        """Raises `ValueError` for what is no word of a term."""
        self._words: list[str] = []
        place, text = 0, text.rstrip()
        while place < len(text):
            found = _TOKEN.match(text, place)
            if found is None:
                raise ValueError(text[place : place + 20])
            self._words.append(found[1])
            place = found.end()
        self._words.append("")
        self._place = 0

    def whole(self) -> Any:
        """All of the text. Raises `ValueError`."""
        result = self._term()
        self._expect("")
        return result

    @property
    def _next(self) -> str:
        return self._words[self._place]

    def _expect(self, *words: str) -> str:
        found = self._next
        if found not in words:
            raise ValueError(f"{found} where {words} should be")
        self._place += 1
        return found

    def _term(self) -> Any:
        head = self._atom()
        arguments = []
        while self._next and self._next not in {")", "]", "|}", ";", ",", ":="}:
            arguments.append(self._atom())
        if not arguments:
            return head
        if not isinstance(head, Applied) or head.to:
            raise ValueError(f"{head} is applied")
        return Applied(head.head, tuple(arguments))

    def _atom(self) -> Any:
        word = self._expect(self._next)
        if word == "(":
            parts = self._until(")", ",", self._term)
            return parts[0] if len(parts) == 1 else tuple(parts)
        if word == "[":
            return [] if self._next == "]" and self._expect("]") else self._until("]", ";", self._term)
        if word == "{|":
            return _record(self._until("|}", ";", self._field))
        if re.fullmatch(r"-?[0-9]+", word):
            return int(word)
        if not re.match(r"[A-Za-z_]", word):
            raise ValueError(word)
        return Applied(word)

    def _until(self, end: str, between: str, read: Callable[[], Any]) -> list[Any]:
        parts = [read()]
        while self._expect(end, between) == between:
            parts.append(read())
        return parts

    def _field(self) -> tuple[str, Any]:
        name = self._atom()
        self._expect(":=")
        if not isinstance(name, Applied):
            raise ValueError(f"{name} is no field")
        return name.head, self._term()


def _record(fields: list[tuple[str, Any]]) -> Any:
    found = dict(fields)
    if len(found) < len(fields):
        raise ValueError("a field is there twice")
    if found.keys() != {"over", "under"}:
        return found
    over, under = found["over"], found["under"]
    if not (isinstance(over, int) and isinstance(under, int) and under > 0):
        raise ValueError(f"{over} / {under}")
    return Fraction(over, under)


def _node(node: Node) -> Applied:
    places, value, name = node.places, node.value, f"Programs.{node.operation.capitalize()}"
    match node.operation:
        case "const" | "scale":
            return Applied(name, (*places, value.numerator, value.denominator))
        case "power":
            return Applied(name, (*places, -value.numerator, value.denominator))
        case _:
            return Applied(name, places)


def _program(program: Program) -> dict[str, Any]:
    return {
        "Programs.inputs": program.inputs,
        "Programs.nodes": list(map(_node, program.nodes)),
        "Programs.outputs": list(program.outputs),
    }


def _affine(start: Affine | None) -> Applied:
    return Applied("OfLevel") if start is None else Applied("Affine", (start.centre, list(start.row)))


def _box(claim: Candidate) -> tuple[list[Fraction], list[Applied]]:
    return list(claim.radii), list(map(_affine, starts_of(claim)))


def _claimed(entry: Certificate) -> list[tuple[str, Any]]:
    """Each part of what Coq evaluates, with its name, as the certificate has it. Raises `InputError`."""
    claim = claim_of(entry)
    system = claim.system
    level, integral = _NONE, _NONE
    if claim.level_sign is not None or not claim.is_family_of_maps:
        assert system.first_integral_program is not None
        first = _program(recorded(system.first_integral_program))
        if claim.level_sign is None:
            integral = _some(first)
        else:
            coefficient = quadratic_coefficient(system)
            assert coefficient
            of = Applied("Affine", (claim.centre[0], list(claim.frame[0])))
            level = _some((first, 1 / coefficient, claim.level_sign, of))
    symmetry, own = _NONE, _NONE
    if claim.symmetry is not None and claim.k == 1:
        symmetry = _some(list(system.symmetries[claim.symmetry]))
    if "level_form" in entry.statement:
        assert isinstance(entry.candidate, Candidate)
        own = _some(_box(entry.candidate))
    return [
        ("field", _program(recorded(system.program))),
        ("dimension", len(system.state)),
        ("section", system.section_index),
        ("box", _box(claim)),
        ("level", level),
        ("signs of R", list(system.reversing_symmetry)),
        ("signs of S", symmetry),
        ("frame of q", [list(row) for row in claim.kernel_frame]),
        ("crossings of a half orbit", claim.crossings),
        ("first integral", integral),
        ("multiplicity", claim.k),
        ("kind", Applied("true" if claim.is_tangential else "false")),
        ("side", _SIDES[str(entry.side)]),
        ("ends of the parameter", stated_of(entry)),
        ("own box", own),
    ]


def _printed(text: str) -> list[Any]:
    """The same parts, as Coq has printed them. Raises `ValueError` for another text."""
    term, sign, rest = text.partition("\n     : ")
    ends_so = " ".join((sign + rest).split()).startswith(" ".join(_END.split()))
    # The second value is that of the last line of the script.
    if not (term.startswith(_BEGIN) and ends_so and len(re.findall(f"(?m)^{_BEGIN}", text)) == 2):
        raise ValueError("another statement")
    field, dimension, section, box, level, (r, s, q, crossings), integral, claim, own = _Reader(
        term.removeprefix(_BEGIN)
    ).whole()
    if isinstance(own, Applied) and own.head == "Some":
        (of,) = own.to
        # Weights are a choice: they say which products are kept.
        own = _some((of["radii"], of["starts"])) if of.keys() == {"weights", "radii", "starts"} else of
    parts = (claim.pop(name) for name in ("multiplicity", "tangential", "claimed_side", "stated"))
    return [field, dimension, section, box, level, r, s, q, crossings, integral, *parts, own, *claim]


def difference(entry: Certificate, text: str) -> str:
    """Which parts of what Coq has printed are not the claim of a certificate; empty if all of them are.

    Raises `InputError` for certificates of which there is no formal check.
    """
    claimed = _claimed(entry)
    try:
        printed = _printed(text)
        others = [name for (name, wanted), found in zip(claimed, printed, strict=True) if found != wanted]
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError):
        return "what Coq states was not understood"
    return f"what Coq states is not what the certificate claims: {', '.join(others)}" if others else ""
