"""Certificates of atlases checked again: curves, libration families, surfaces (section 13).

The form: digest, schema, names of the hypotheses, and the certificates that the file rests on. The conclusion: it is
made again from the stored results and from the certificates that the file carries, and the certificate that results is
compared with the stored one in all data. The integration: every stored interval is proved again, at
another precision, order and width; the bounds and enclosures that are found have to lie within the stored ones; and so
have the certificates of the bifurcations on the curve.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from typing import Any

from flint import arb

from orbitproof.shared.formats import AnyAtlas, AnyPiece, InputError
from orbitproof.shared.numbers import format_exact
from orbitproof.shared.systems import BRANCH_SYSTEMS, shown
from orbitproof.verify.branches.certificate import (
    ONE_A_LINE,
    SAID,
    SCHEMA,
    atlas_of,
    make_atlas_certificate,
    pieces_of,
    well_formed,
)
from orbitproof.verify.branches.conclusion import Watch, conclusion_of
from orbitproof.verify.branches.kinds import BranchKind, kind_of
from orbitproof.verify.branches.results import Result, Settings, condition_of, covers, results_from_json
from orbitproof.verify.certificate import (
    NOT_INTEGRATED,
    UNCHECKED_REASON,
    UNKNOWN,
    CannotBeCheckedError,
    Certificate,
    Examination,
    Finding,
    Given,
    NothingToCheckError,
    Recheck,
    confirmed,
    decimals,
    in_all_data,
    named_as,
    other_hypotheses,
    other_software,
    overlap,
    recheck,
    repeated,
    taken_names,
    unknown_reason,
)
from orbitproof.verify.curve.piece_result import Interval
from orbitproof.verify.evidence import as_found

_MORE = {"precision": 32, "order": 4, "width": 8}
_MORE_OF_SAME_WIDTH = {"precision": 32, "order": 4}
_MORE_BITS = {"precision": 32}
_NO_MORE: dict[str, int] = {}
"""What the second integration has more: it has to find bounds that are no larger than the stored ones. Polynomials of
higher degree are sometimes enclosed a little more widely, and longer steps too; what they do not confirm is proved with
those of the same width, then of the same order, and at last as it was: more bits do not make every bound smaller."""

_ENDED = ("time", "memory", "process")
"""Why a proof was not brought to an end."""

_LARGEST_ORDER = 99
_LARGEST = 4096
"""No setting of the integrator is larger."""

Document = Mapping[str, Any]


@dataclass(frozen=True)
class ProvedBefore:
    """An interval that a certificate says is proved, to be proved again.

    Attributes:
        name: of the interval, in messages.
        piece, interval: what is to be proved.
        settings: of the integrator, others than before.
        steps: how many the integration took.
        stated: what the certificate states of a system that is not known here; `None` if it is known.
        stability: whether the stability of its orbits is enclosed as well.
        lasting: whether their twist is.
        parts: of a surface, the parts of the interval that were proved one by one.
    """

    name: str
    piece: AnyPiece
    interval: Interval
    settings: Settings
    steps: int
    stated: Mapping[str, Any] | None
    stability: bool = False
    lasting: bool = False
    parts: tuple[Interval, ...] = ()


@dataclass(frozen=True)
class Means:
    """How a check has done what takes time.

    Attributes:
        check: certificates of bifurcations, again, in their order; with another integration if that is asked for.
        prove: proves intervals of the pieces of an atlas again, in any order, and calls the third argument with the
            name and the result of each; for the integration only.
        watch: shows which bifurcation is looked for on a curve, and how far a list is.
    """

    check: Callable[[Sequence[Certificate], bool], Sequence[Recheck]]
    prove: Callable[[AnyAtlas, Sequence[ProvedBefore], Callable[[str, Result], str]], None] | None = None
    watch: Watch = lambda names, word: nullcontext(lambda name: None)

    def conclude(
        self,
        atlas: AnyAtlas,
        results: Sequence[Result],
        rests_on: Sequence[Certificate],
        order: int | None,
        combinations: bool = False,
    ) -> Document:
        """What results and certificates of bifurcations give together."""

        def checked(entries: Sequence[Certificate]) -> Sequence[Recheck]:
            return self.check(entries, False)

        return conclusion_of(atlas, results, rests_on, checked, order, self.watch, combinations)


def _means(given: Given) -> Means:
    """The means that are given, or what checks one certificate after the other here."""
    means: Means = (
        Means(lambda entries, far: [recheck(e, far) for e in entries]) if given.means is None else given.means
    )
    return means


def order_of(document: Document) -> int | None:
    """Up to which order the certificate lists all resonances, if it does. Raises `ValueError` if it is no order."""
    listed = (document["conclusion"] or {}).get("complete")
    if listed is None:
        return None
    order = listed["order"]
    if type(order) is not int or not 1 <= order <= _LARGEST_ORDER:
        raise ValueError("the order of the complete list is no number from 1 to 99")
    return order


def lists_combinations(document: Document) -> bool:
    """Whether the certificate lists combination resonances."""
    return "combinations" in ((document["conclusion"] or {}).get("complete") or {})


def form(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """What its claim, its results and the certificates that it carries are."""
    document = certificate.document
    atlas = atlas_of(document)
    yield from taken_names(atlas.system, document["software"])
    symmetric = {piece.id for piece in atlas.pieces if piece.is_symmetric}
    try:
        results = results_from_json(atlas, document["results"])
    except InputError as error:
        place, _, message = str(error).partition(": ")
        yield Finding(place, message)
        return
    for index, result in enumerate(results):
        if result.piece in symmetric and result.is_proved:
            start, end = result.interval
            # What is proved about 0 there is proved of both halves together.
            if start <= 0 <= end and start != -end:
                yield Finding(f"results[{index}].interval", "contains the symmetric point and is not centred there")
        settings = (getattr(result.computation, name) for name in ("precision", "order", "width", "top", "steps"))
        if not all(value is None or 0 <= value <= _LARGEST for value in settings):
            yield Finding(f"results[{index}].computation", "the settings of the integrator are not possible")
    concluded = document["conclusion"]
    if concluded is None:
        yield Finding("conclusion", "the run was not finished, so there is none; run the same command again")
        return
    carried = _rests_on(document)
    for name in repeated(carried):
        yield Finding("rests_on", f"{name!r} appears twice: nothing says which of them the theorem is about")
    names, listed = [entry.id for entry in carried], [entry["id"] for entry in concluded["bifurcations"]]
    if listed != names:
        names, listed = list(map(shown, names)), list(map(shown, listed))
        yield Finding("rests_on", f"carries {', '.join(names) or 'nothing'}; listed: {', '.join(listed)}")
    found = [hypothesis["name"] for hypothesis in concluded["hypotheses"]]
    expected = kind_of(atlas).theorem(atlas).hypotheses
    if document["verdict"] == "proved":
        yield from other_hypotheses(found, expected, document)
    else:
        yield from unknown_reason(document["reason"], expected)
        examination.notes += (UNCHECKED_REASON,)


def conclusion(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether it follows from its results; certificates that are given have to be those that it carries."""
    document, means = certificate.document, _means(given)
    atlas = atlas_of(document)
    if atlas.system.name not in BRANCH_SYSTEMS:
        examination.notes += (f"{atlas.system.name}: {UNKNOWN}",)
    bifurcations = _rests_on(document)
    yield from _other_certificates(document, given.certificates)
    yield from decimals(document["results"], "results")
    results = results_from_json(atlas, document["results"])
    for index, result in enumerate(results):
        for place, text in kind_of(atlas).unshown(atlas, result):
            yield Finding(f"results[{index}].{place}", text)
    concluded = means.conclude(atlas, results, bifurcations, order_of(document), lists_combinations(document))
    examination.hypotheses = len(concluded["hypotheses"])
    # What is stored is what was read: its order is compared, and not how its numbers are written.
    stored = dict(zip(map(id, results), document["results"], strict=True))
    again = make_atlas_certificate(atlas, results, concluded, bifurcations, lambda result: stored[id(result)])
    again["statement"] = named_as(document["statement"], again["statement"])
    data = list(in_all_data(document, again, examination))
    yield from data
    if data:
        yield from other_software(document)


def _rests_on(document: Document) -> Sequence[Certificate]:
    """The certificates of bifurcations that the conclusion was made with."""
    return [Certificate.from_json(entry, f"rests_on[{index}]") for index, entry in enumerate(document["rests_on"])]


def _other_certificates(document: Document, given: Sequence[Certificate]) -> Iterator[Finding]:
    """Where a file carries other certificates than those that were given beside it."""
    if not given:
        return
    carried = {entry["id"]: entry["digest"] for entry in document["rests_on"]}
    beside = {entry.id: entry.without_place().to_json().get("digest") for entry in given}
    for name in sorted({*carried, *beside}):
        if carried.get(name) != beside.get(name):
            yield Finding(
                "rests_on", f"{shown(name)}: the certificate is {carried.get(name)}, given is {beside.get(name)}"
            )


def integration(certificate: Certificate, given: Given, examination: Examination) -> Iterator[Finding]:
    """Whether its intervals and the certificates that it carries are proved again, within what is stored."""
    document, means = certificate.document, _means(given)
    assert means.prove is not None
    atlas = atlas_of(document)
    if not any(result.is_proved for result in results_from_json(atlas, document["results"])):
        raise NothingToCheckError(NOT_INTEGRATED.format(what="proved intervals"))
    results: dict[str, Result] = {}
    findings: dict[str, list[Finding]] = {}
    contradictions: list[Finding] = []
    kind = kind_of(atlas)
    for more in (_MORE, _MORE_OF_SAME_WIDTH, _MORE_BITS, _NO_MORE):
        intervals, before = _intervals(document, atlas, more)
        examination.precision = min((interval.settings["precision"] for interval in intervals), default=0)

        def finished(name: str, fresh: Result, before: Mapping[str, Result] = before) -> str:
            fresh = as_found(fresh)
            contradictions.extend(_contradictions(before[name], fresh, kind))
            results[name], findings[name] = fresh, list(_interval_findings(before[name], fresh, kind))
            return f"{fresh.verdict} again"

        if remaining := [interval for interval in intervals if findings.get(interval.name, True)]:
            # What is not answered is not confirmed.
            findings.update({each.name: [Finding(each.name, "was not integrated again")] for each in remaining})
            means.prove(atlas, remaining, finished)
    # What was not brought to an end says nothing of the interval.
    ended = {name: result.reason for name, result in results.items() if condition_of(result) in _ENDED}
    found = [finding for name, entries in findings.items() if name not in ended for finding in entries]
    yield from dict.fromkeys(contradictions)
    yield from found
    if contradictions or found:
        return
    if ended:
        name, reason = next(iter(ended.items()))
        raise CannotBeCheckedError(f"{name}: {reason.message}; {reason.remedy}" if reason else name)
    if document["verdict"] != "proved":
        return
    concluded = means.conclude(atlas, list(results.values()), [], order_of(document), lists_combinations(document))
    if concluded["verdict"] != "proved":
        yield Finding("integration", f"the theorem is not proved again: {concluded['reason']['message']}")
    on_curve = {entry["id"] for entry in document["conclusion"]["bifurcations"] if entry["on_curve"]}
    bifurcations = [entry for entry in _rests_on(document) if entry.id in on_curve]
    checks = means.check(bifurcations, True)
    for check in checks:
        yield from (Finding(f"bifurcation {shown(check.id)}, {entry.place}", entry.message) for entry in check.findings)
    for check in checks:
        if check.obstacle:
            raise CannotBeCheckedError(f"bifurcation {shown(check.id)}: {check.obstacle}")


def _intervals(
    document: Document, atlas: AnyAtlas, more: Mapping[str, int]
) -> tuple[list[ProvedBefore], dict[str, Result]]:
    """The proved intervals, to be proved with other settings, and the stored result of each by its name."""
    pieces = {piece.id: piece for piece in atlas.pieces}
    names = kind_of(atlas).settings()
    is_stated = document["statement"]["atlas"]["system"] == atlas.system.name not in BRANCH_SYSTEMS
    intervals, before = [], {}
    results = results_from_json(atlas, document["results"])
    for number, result in enumerate(entry for entry in results if entry.is_proved):
        made = {name: value for name, value in vars(result.computation).items() if value is not None}
        name = f"{number + 1}: {result.piece} {ends_of(result.interval)}"
        settings = {name: int(made.get(name, value)) + more.get(name, 0) for name, value in names.items()}
        intervals.append(
            ProvedBefore(
                name,
                pieces[result.piece],
                result.interval,
                settings,
                max(1, int(made.get("steps", 1))),
                _stated(document) if is_stated else None,
                **kind_of(atlas).asked(result),
            )
        )
        before[name] = result
    return intervals, before


def _stated(document: Document) -> dict[str, Any]:
    """What a process needs to have the system of the file."""
    claim = document["statement"]["atlas"]
    return {
        "statement": {
            key: value for key, value in document["statement"].items() if key not in ("atlas", "theorem", "in_full")
        },
        "claim": {**claim, "pieces": claim["pieces"][:1]},
    }


def _contradictions(stored: Result, fresh: Result, kind: BranchKind) -> Iterator[Finding]:
    """Where a new proof of an interval and the stored one cannot both be true; no further integration mends that."""
    if not fresh.is_proved:
        return
    place = _place_of(stored)
    yield from overlap(_time(stored), _time(fresh), f"{place}, {kind.time}")
    yield from kind.contradictions(stored, fresh, place)


def _interval_findings(stored: Result, fresh: Result, kind: BranchKind) -> Iterator[Finding]:
    """What a new proof of an interval does not confirm."""
    place = _place_of(stored)
    if fresh.reason is not None:
        yield Finding(place, f"is not proved again: {fresh.reason.message}")
        return
    if not covers([fresh.interval], stored.interval):
        yield Finding(place, "is proved on less than that")
    yield from confirmed(_time(stored), _time(fresh), f"{place}, {kind.time}")
    for name in ("deviation", "slope_deviation"):
        bounds = getattr(stored, name), getattr(fresh, name)
        if len(bounds[0]) != len(bounds[1]):
            yield Finding(place, f"another number of bounds {name}")
        for j, (old, new) in enumerate(zip(*bounds, strict=False), start=1):
            if new > old:
                sizes = f"stored is {float(old):.6g}, the new integration finds {float(new):.6g}"
                yield Finding(f"{place}, {name} {j}", sizes)
    yield from kind.unconfirmed(stored, fresh, place)


def _place_of(result: Result) -> str:
    return f"piece {result.piece}, s in {ends_of(result.interval)}"


def ends_of(interval: Interval) -> str:
    """An interval of s in a message."""
    return f"[{', '.join(map(format_exact, interval))}]"


def _time(result: Result) -> arb:
    return arb(float("nan")) if result.time is None else result.time


OF_ANY_BRANCH: Mapping[str, Any] = {
    "schema": SCHEMA,
    "part": "arc",
    "levels": (form, conclusion, integration),
    "more": SAID,
    "extent": pieces_of,
    "well_formed": well_formed,
    "one_a_line": ONE_A_LINE,
}
"""What is the same of all kinds of branches."""
