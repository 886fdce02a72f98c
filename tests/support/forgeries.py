"""Certificates changed on purpose: well formed, with a new digest, and checked at a level without processes."""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

from support import atlas_work
from support.chain_cases import parabola
from support.conclusions import conclude
from support.stored import value_of, values

from orbitproof.shared import format_exact, parse_exact
from orbitproof.shared.claims import Atlas
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import read_atlas
from orbitproof.verify.branches import Means, ProvedBefore, make_atlas_certificate
from orbitproof.verify.branches.curve_conclusion import told
from orbitproof.verify.certificate import (
    Certificate,
    Computation,
    Given,
    Recheck,
    digest,
    make_certificate,
    recheck,
    rechecking,
)
from orbitproof.verify.run.branch_tasks import task_again
from orbitproof.verify.surface import conclude_surface
from orbitproof.verify.theorems.surface import told as surface_told

DATA = Path(__file__).parents[1] / "data"

Document = dict[str, Any]
Place = tuple[str | int, ...]
Prover = Callable[[Mapping[str, Any], Callable[[float, str], None]], Mapping[str, Any]]


def forged(document: Mapping[str, Any], change: Callable[[Document], Any]) -> Document:
    """A changed copy with a digest that fits."""
    entry = copy.deepcopy(dict(document))
    change(entry)
    entry["digest"] = digest(entry)
    return entry


def forged_elsewhere(document: Mapping[str, Any], change: Callable[[Document], Any]) -> Document:
    """The same, said to be made by another version, which may word things otherwise."""
    software = {**document["software"], "orbitproof": "0.0.1"}
    return forged({**document, "software": software}, change)


def balls_of(value: Any, place: Place = ()) -> Iterator[tuple[Place, str]]:
    """The balls of tables as they are stored, with keys and indices down to them."""
    if isinstance(value, str) and " +- " in value:
        yield place, value
    elif isinstance(value, (dict, list)):
        for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
            yield from balls_of(inner, (*place, key))


def noticed(check: Recheck) -> bool:
    """Whether a check has found the change, or tells the words anew that were changed."""
    return not check.stands or check.rendered is not None


def conclusion_of(atlas: Atlas, results: Sequence[Mapping[str, Any]], rests_on: Sequence[Certificate]) -> Document:
    """What results give together, as JSON."""
    if atlas.is_surface:
        return surface_told(conclude_surface(atlas, values(results)))
    return told(conclude(atlas, results, rests_on))


def atlas_certificate(atlas: Atlas, results: Sequence[Document], rests_on: Sequence[Certificate] = ()) -> Document:
    """The certificate that results give."""
    return make_atlas_certificate(atlas, values(results), conclusion_of(atlas, results, rests_on), rests_on)


def checked(document: Mapping[str, Any], prover: Prover | None = None, given: Sequence[Certificate] = ()) -> Recheck:
    """The certificate of an atlas, checked up to its conclusion, or with a `prover` up to the integration."""

    def prove(atlas: Atlas, intervals: Sequence[ProvedBefore], finished: Callable[[str, Document], str]) -> None:
        assert prover is not None
        for each in intervals:
            argument = task_again(atlas, each, None).argument
            finished(each.name, value_of(prover(argument, lambda fraction, label: None)))

    means = Means(lambda entries, integrate: [recheck(entry, integrate) for entry in entries], prove)
    return recheck(Certificate(document), prover is not None, given=Given(given, means=means))


def checked_by(document: Mapping[str, Any], curve: Certificate, examined: Recheck) -> Recheck:
    """The certificate of an index or of rows, checked as far as its curve."""
    return recheck(Certificate(document), given=Given((curve,), {curve.key: examined}))


def honest(results: Sequence[Mapping[str, Any]], pieces: Sequence[Mapping[str, Any]] | None = None) -> Prover:
    """A prover that finds for each piece what these results say, and nothing for others.

    With `pieces`, nothing for a piece either that is none of them as it stands.
    """

    def prover(argument: Mapping[str, Any], report: Callable[[float, str], None]) -> Mapping[str, Any]:
        for result in results if pieces is None or argument["piece"] in pieces else ():
            if result["piece"] == argument["piece"]["id"] and argument["interval"] == result["interval"]:
                return result
        reason = {"condition": "newton", "message": "there is no such orbit", "remedy": ""}
        head = {"piece": argument["piece"]["id"], "interval": argument["interval"]}
        return {**head, "verdict": "not proved", "reason": reason, "computation": {"seconds": 0.0}}

    return prover


def of_parabola() -> tuple[Atlas, list[Document]]:
    """The pieces of y = beta^2/100 with true results."""
    atlas, _ = parabola()
    whole = {"integrator": {"precision": 80, "order": 40, "width": 40}, "interval": ["-0x1", "0x1"]}
    return atlas, [
        atlas_work.proving({**whole, "piece": to_json(piece)}, lambda fraction, label: None) for piece in atlas.pieces
    ]


def fabricated(point: Certificate, where: tuple[str, str], name: str) -> Certificate:
    """The tables of a true certificate in a box elsewhere, with everything that follows from them."""
    entry = point.to_json()
    claim = {**entry["statement"]["candidate"], "id": name, "centre": list(where)}
    entry["statement"]["candidate"] = claim
    stated = rechecking._read(entry)
    outcome = rechecking._conclude(stated.claim, entry["computation"]["precision"], stated.enclosures)
    return make_certificate(stated.candidate, outcome, Computation(**entry["computation"]), stated.enclosures)


@cache
def read(name: str) -> Atlas:
    """An atlas of tests/data."""
    return read_atlas(DATA / name)


@dataclass(frozen=True)
class Change:
    """One field of a document changed so that it stays well formed.

    Attributes:
        place: keys and indices down to the field.
        how: in one word.
        value: what stands there instead.
    """

    place: Place
    how: str
    value: Any

    @property
    def field(self) -> str:
        """The field without indices: changes of one class have the same."""
        return ".".join("*" if isinstance(key, int) else key for key in self.place)

    def apply(self, document: Document) -> None:
        """Make the change."""
        target: Any = document
        for key in self.place[:-1]:
            target = target[key]
        target[self.place[-1]] = self.value


_EXACT = re.compile(r"-?0x[0-9a-f]+(p[+-]?[0-9]+)?")
_DECIMAL = re.compile(r"-?[0-9]+(\.[0-9]+)?(e[+-]?[0-9]+)?")
_BALL = re.compile(r"(-?0x[0-9a-f]+(?:p-?[0-9]+)?) \+- (0x[0-9a-f]+(?:p-?[0-9]+)?)")


_SENTENCE = "It is proved that all orbits are stable"
_NAMES = ("id", "system", "first_integral", "distance_from", "piece", "symmetry", "condition", "name")


def changes(value: Any, place: Place = ()) -> Iterator[Change]:
    """Every field of a JSON value changed, each in the ways that keep it well formed."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from changes(inner, (*place, key))
        yield Change((*place, "more"), "unknown key", _SENTENCE)
        return
    if isinstance(value, list):
        for index, inner in enumerate(value):
            yield from changes(inner, (*place, index))
        return
    if place[-1] == "digest":
        return
    if isinstance(value, bool):
        yield Change(place, "turned", not value)
        yield Change(place, "other type", int(value))
    elif isinstance(value, (int, float)):
        yield Change(place, "other number", -value if value in (1, -1) else value + 1)
        if value in (0, 1):
            yield Change(place, "other type", bool(value))
    elif isinstance(value, str):
        yield from _other_text(value, place)


def _other_text(text: str, place: Place) -> Iterator[Change]:
    ball = _BALL.fullmatch(text)
    if ball is not None:
        middle, radius = (parse_exact(part) for part in ball.groups())
        yield Change(place, "moved", f"{format_exact(middle + 3 * radius + 1)} +- {format_exact(radius)}")
        if radius:
            yield Change(place, "narrowed", f"{format_exact(middle + radius / 2)} +- {format_exact(radius / 1024)}")
        return
    if _EXACT.fullmatch(text) or _DECIMAL.fullmatch(text):
        number = parse_exact(text)
        yield Change(place, "larger", format_exact(2 * number if number else parse_exact("0x1p-40")))
        yield Change(place, "smaller", format_exact(number / 2 if number else parse_exact("-0x1p-40")))
        return
    if place[-1] in _NAMES:
        yield Change(place, "sentence", f"{text}. {_SENTENCE}")
        yield Change(place, "newline", f"{text}\n")
    choices = {"above": "below", "below": "above", "both": "above", "proved": "not proved"}
    joined = "-" if place[-1] == "system" else " "
    yield Change(place, "other words", choices.get(text, f"{text}{joined}indeed"))


def changed(entry: dict[str, Any], change: Callable[[dict[str, Any]], object]) -> dict[str, Any]:
    """Another entry, as it was but for a change."""
    other = copy.deepcopy(entry)
    change(other)
    return other


def move(ball: dict[str, str], by: Fraction = Fraction(1, 2**20)) -> None:
    """Move the middle of a ball in JSON."""
    ball["mid"] = format_exact(parse_exact(ball["mid"]) + by)
