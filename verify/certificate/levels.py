"""The three levels at which every certificate is checked again: form, conclusion, integration (section 13).

What a certificate is about differs from kind to kind, and so does what the levels do; their order, what passing one
means, and how stored and new values are compared is the same for all and stands here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import TYPE_CHECKING, Any

from flint import arb

from orbitproof.shared.formats import InputError
from orbitproof.verify.evidence import (
    STOPS,
    ball_from_json,
    ball_to_json,
    bounds,
    decimal_interval,
    differs_here,
    is_of_this_program,
    one_line,
    quoted,
    quoted_name,
)

if TYPE_CHECKING:
    from orbitproof.shared.processes import Failure

_SHOWN_DIGITS = 45
_LONGEST_SHOWN = 100


class Level(IntEnum):
    """How far a certificate was checked; each level includes those before it."""

    NONE = 0
    FORM = 1
    CONCLUSION = 2
    INTEGRATION = 3


@dataclass(frozen=True)
class Meaning:
    """What a level looks at, how, and what is still to be believed after it."""

    checked: str
    how: str
    remains: str


MEANINGS: Mapping[Level, Meaning] = {
    Level.FORM: Meaning(
        "schema, digest, names and order of the hypotheses",
        "read",
        "all numbers and words",
    ),
    Level.CONCLUSION: Meaning(
        "all data that are stated, and the words that are printed",
        "derived from what is stored, with the system of the file's own program",
        "what is stored: that the tables of derivatives, and the proved intervals of curves and surfaces, are true",
    ),
    Level.INTEGRATION: Meaning(
        "what is stored, and what it rests on",
        "integrated again, at first with more bits and a higher order: proved again, and found within what is stored",
        "the theorems, this software, FLINT, numpy, Python, the processor",
    ),
}


WORDS = frozenset({
    ("statement", "theorem"), ("statement", "in_full"), ("conclusion", "statement"),
    ("hypotheses", "statement"), ("hypotheses", "section"),
    ("reason", "message"), ("reason", "remedy"), ("bifurcations", "reason"), ("place", "statement"),
    ("gaps", "reason"), ("open_extrema", "reason"),
})  # fmt: skip
"""The last two keys, indices left out, of what only words what other fields say. Nothing is decided by these fields:
words of another version are no defect, and are never printed. This version has no others than those that follow."""

REWORDED = "worded otherwise than by this version, which checks no foreign words: what it prints are its own"
"""What is said of a certificate whose data are as they should be, and whose words are not those that follow."""

FORGED_WORDS = (
    "it names this very version and these sources, which word what it proves otherwise: its words were changed"
)
"""What is said of one that cannot have its words from where it says that it was made."""


@dataclass(frozen=True)
class Finding:
    """Something in a certificate that is not as it should be: where it stands, and what is wrong.

    Both are made lines that can be printed. What they have of the file is quoted (`quoted`, `quoted_name`).

    Attributes:
        in_words: whether only words differ (`WORDS`).
    """

    place: str
    message: str
    in_words: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "place", one_line(self.place))
        object.__setattr__(self, "message", one_line(self.message))


class NothingToCheckError(Exception):
    """A certificate has nothing that a level could look at, so that it does not pass it; says what is missing."""


class CannotBeCheckedError(Exception):
    """Nothing is wrong with a certificate as far as can be seen, but it cannot be checked here; says why."""


@dataclass(frozen=True, repr=False)
class Recheck:
    """What checking one certificate again has shown.

    Attributes:
        id: the certificate's id.
        verdict: the stored verdict.
        hypotheses: how many hypotheses were evaluated again.
        findings: everything that is not as it should be, in the order of checking.
        precision: least bits of the second integration, 0 without one.
        level: the last level that it has passed.
        obstacle: why it cannot be checked further, empty if it can.
        notes: what a reader should know although nothing is wrong.
        open_place: what its place on a curve rests on, as long as that was not checked; empty without a place.
        rendered: the certificate with the words of this version, as JSON, if its own are others; only these may be
            printed.
        digest: the certificate's own, empty if it has none; one that stands has this content and no other.
    """

    id: str
    verdict: str
    hypotheses: int
    findings: tuple[Finding, ...]
    precision: int = 0
    level: Level = Level.NONE
    obstacle: str = ""
    notes: tuple[str, ...] = ()
    open_place: str = ""
    rendered: Mapping[str, Any] | None = None
    digest: str = ""

    def __repr__(self) -> str:
        return f"<Recheck {self.id!r}: {self.word}, level {self.passed:d} {self.passed.name.lower()}>"

    @property
    def stands(self) -> bool:
        """Whether all levels that were asked for and had something to look at were passed, and nothing was left out."""
        return self.stands_without_place and not self.open_place

    @property
    def stands_without_place(self) -> bool:
        """Whether it would stand if it did not say where on a curve it lies."""
        return not self.findings and not self.obstacle

    @property
    def passed(self) -> Level:
        """The last level that all of it has passed, its place on a curve included."""
        return min(self.level, Level.FORM) if self.open_place else self.level

    @property
    def word(self) -> str:
        """The outcome in words."""
        if self.findings:
            return "DOES NOT STAND"
        if not self.stands:
            return "cannot be checked here"
        return "stands" if self.rendered is None else "stands, worded otherwise"

    @property
    def why(self) -> str:
        """The first thing that keeps it from standing."""
        if self.findings:
            return f"{self.findings[0].place}: {self.findings[0].message}"
        return self.obstacle or self.open_place


def not_checked(name: str, verdict: str, failure: Failure) -> Recheck:
    """What is said of a certificate whose check was not brought to an end: nothing for it, and nothing against it."""
    return not_finished(Recheck(name, verdict, 0, ()), failure)


def not_finished(check: Recheck, failure: Failure) -> Recheck:
    """A check that had come so far and was not brought to an end."""
    return replace(check, obstacle=f"{failure.message}; {_REMEDIES[failure.kind]}")


_REMEDIES = {
    "process": "its numbers or its formulas are too large to be checked, or memory was short (`memory`, `jobs`)",
    "time": "give the check more time if you trust the file",
    "memory": "give `memory` more if you trust the file",
}


@dataclass
class Examination:
    """What the levels leave for the result while they are climbed; see `Recheck`.

    Attributes:
        made_by: the software that the certificate names.
    """

    made_by: Mapping[str, str] = field(default_factory=dict)
    hypotheses: int = 0
    precision: int = 0
    notes: tuple[str, ...] = ()
    open_place: str = ""
    rendered: Mapping[str, Any] | None = None
    stated: Any = None

    def in_data(self, findings: Iterable[Finding], rendered: Mapping[str, Any]) -> Iterator[Finding]:
        """The findings that are not about words; if some are, the words of `rendered` are to be printed.

        Of a certificate that this very program says to have made they are findings like others.
        """
        for finding in findings:
            if not finding.in_words:
                yield finding
            elif is_of_this_program(self.made_by):
                yield replace(finding, message=f"{FORGED_WORDS}; {finding.message}")
            else:
                self.rendered = rendered


Step = Callable[[Examination], Iterable[Finding]]
"""One level of one certificate. Raises `CannotBeCheckedError` or `NothingToCheckError` where it must; every other
exception is a finding."""


def climb(document: Mapping[str, Any], steps: Sequence[Step]) -> Recheck:
    """Take the levels one after the other, from `Level.FORM` on, up to the first at which something is found.

    `document` is the certificate as JSON, of any kind.
    """
    examination, level = Examination(document.get("software", {})), Level.NONE
    findings: list[Finding] = []
    obstacle = ""
    for number, step in enumerate(steps, start=1):
        try:
            findings.extend(step(examination))
        except NothingToCheckError as error:
            examination.notes += (str(error),)
            break
        except CannotBeCheckedError as error:
            obstacle = str(error)
        except MemoryError:
            obstacle = "there is not enough memory to check it; give `memory` more, or fewer `jobs`"
        except (InputError, ValueError) as error:
            findings.append(Finding("the certificate", str(error)))
        except Exception as error:
            said = f": {quoted(str(error))}" if str(error) else ""
            findings.append(Finding("the check", f"the check broke off: {type(error).__name__}{said}"))
        if findings or obstacle:
            break
        level = Level(number)
    notes = examination.notes if examination.rendered is None else (*examination.notes, REWORDED)
    return Recheck(
        str(document["id"]), str(document["verdict"]), examination.hypotheses, tuple(findings), examination.precision,
        level, obstacle, notes, examination.open_place, examination.rendered, str(document.get("digest", "")),
    )  # fmt: skip


def differences(stored: Any, again: Any, place: str, keys: tuple[str, ...] = ()) -> Iterator[Finding]:
    """Where two JSON values differ, in value or type; a ball is one value. `keys` lead to them, see `WORDS`."""
    if stored is again:
        return
    if isinstance(stored, Mapping) and isinstance(again, Mapping) and not is_ball(stored):
        for key in sorted({*stored, *again}):
            inner = f"{place}, {quoted_name(key)}" if place else quoted_name(key)
            if key not in stored:
                yield Finding(inner, "is missing")
            elif key not in again:
                yield Finding(inner, "does not belong here")
            else:
                yield from differences(stored[key], again[key], inner, (*keys, key))
        return
    if isinstance(stored, list) and isinstance(again, list) and len(stored) == len(again):
        for index, (left, right) in enumerate(zip(stored, again, strict=True)):
            yield from differences(left, right, f"{place}[{index}]", keys)
        return
    if stored == again and type(stored) is type(again):
        return
    if keys[-2:] in WORDS and isinstance(stored, str) and isinstance(again, str):
        # Foreign words are not printed, not even as a quotation.
        yield Finding(place, "is worded otherwise than what is stored says", True)
        return
    yield Finding(place, f"stored is {_shown(stored)}, evaluated again it is {_shown(again)}")


_APART = ("software", "digest")
"""What another run of the same proof may have otherwise."""


def in_all_data(document: Mapping[str, Any], fresh: Mapping[str, Any], examination: Examination) -> Iterator[Finding]:
    """Whether a certificate is what is concluded afresh, in all but the software; words apart, which are told anew."""
    old, new = ({key: value for key, value in entry.items() if key not in _APART} for entry in (document, fresh))
    yield from examination.in_data(differences(old, new, ""), {**new, **{key: document[key] for key in _APART}})


def is_ball(value: Any) -> bool:
    """Whether a JSON value is a ball; coordinates that a file calls mid and rad have balls as their values."""
    return (
        isinstance(value, Mapping)
        and {"mid", "rad"} <= value.keys() <= {"mid", "rad", "decimal"}
        and all(isinstance(each, str) for each in value.values())
    )


def decimals(value: Any, place: str) -> Iterator[Finding]:
    """Where the decimals beside a ball, anywhere in a JSON value, are not those of the ball."""
    if is_ball(value):
        yield from differences(value, ball_to_json(ball_from_json(value)), place)
    elif isinstance(value, Mapping):
        for key, inner in value.items():
            yield from decimals(inner, f"{place}, {quoted_name(key)}")
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from decimals(inner, f"{place}[{index}]")


def other_software(certificate: Mapping[str, Any]) -> Iterator[Finding]:
    """What may explain differences: another version rounds or words differently."""
    made_by = certificate.get("software", {})
    other = [
        f"{name} {quoted_name(str(made_by.get(name)))}, here {version}"
        for name, version in differs_here(made_by).items()
    ]
    if other:
        yield Finding("software", f"the certificate was made with {'; '.join(other)}: prove it again with this one")


def other_hypotheses(
    stored: Sequence[str], expected: Sequence[str], certificate: Mapping[str, Any]
) -> Iterator[Finding]:
    """A finding unless the names of the hypotheses are those of the theorem, in order; then also who wrote them."""
    if tuple(stored) == tuple(expected):
        return
    missing = [name for name in expected if name not in stored]
    if missing and [name for name in expected if name in stored] == list(stored):
        text = f"{', '.join(missing)} {'is' if len(missing) == 1 else 'are'} not among them: prove the claim again"
    else:
        text = f"stored are {', '.join(map(quoted_name, stored))}; the theorem takes {', '.join(expected)}"
    yield Finding("hypotheses", text)
    yield from other_software(certificate)


def unknown_reason(reason: Mapping[str, Any], hypotheses: Sequence[str]) -> Iterator[Finding]:
    """A finding if a certificate says that it proves nothing for a reason that this program does not give."""
    condition = reason["condition"]
    if condition not in (*hypotheses, *STOPS):
        yield Finding("reason", f"{condition!r} is no hypothesis of the theorem, and nothing else that ends a proof")


def overlap(stored: arb, fresh: arb, place: str) -> Iterator[Finding]:
    """A finding unless two enclosures of the same number have a common point."""
    if stored.overlaps(fresh) is not True or not fresh.is_finite():
        shown = (decimal_interval(ball, _SHOWN_DIGITS) for ball in (stored, fresh))
        yield Finding(place, "stored is {}, disjoint from {}".format(*shown))


def confirmed(stored: arb, fresh: arb, place: str) -> Iterator[Finding]:
    """A finding unless `stored` contains the new enclosure."""
    if not (stored.is_finite() and fresh.is_finite()):
        yield Finding(place, "is not finite")
        return
    (low, high), (new_low, new_high) = bounds(stored), bounds(fresh)
    if not low <= new_low <= new_high <= high:
        shown = (decimal_interval(ball, _SHOWN_DIGITS) for ball in (stored, fresh))
        yield Finding(place, "stored is {}, which the new integration does not confirm: it finds {}".format(*shown))


def _shown(value: Any) -> str:
    if is_ball(value):
        try:
            return decimal_interval(ball_from_json(value), _SHOWN_DIGITS)
        except ValueError:
            return "not a ball"
    if isinstance(value, str):
        return quoted(value)
    text = repr(value)
    if len(text) <= _LONGEST_SHOWN:
        return text
    # A part of it could end in the middle of a quotation.
    return f"of {len(value)} entries" if isinstance(value, (Mapping, list)) else f"{text[:_LONGEST_SHOWN]} .."
