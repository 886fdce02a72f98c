"""What each kind of theorem offers to certificates: how they are checked again and what they say; of boxes all more."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from flint import arb

from orbitproof.verify.certificate.document import AnyStatement
from orbitproof.verify.certificate.levels import CannotBeCheckedError, Examination, Finding, Recheck
from orbitproof.verify.evidence import Checklist, Outcome, Reason, Theorem
from orbitproof.verify.poincare import IntegratorSettings

if TYPE_CHECKING:
    from orbitproof.verify.certificate.certificate import Certificate

Claim = TypeVar("Claim")
Found = TypeVar("Found")
Results = TypeVar("Results")
Progress = Callable[[float], None]

Key = tuple[str, str]
"""What a certificate can be for those that rest on it, and its id: that of an index has the id of its curve."""


@dataclass(frozen=True)
class Given:
    """What a check is given beside the certificate.

    Attributes:
        certificates: those that it rests on; of a branch, certificates of bifurcations that it has to carry.
        checks: what checking those that it rests on has shown.
        means: how what takes time is done, where the kind has a choice; `None` for what is usual.
        progress: is called with the share that is done.
    """

    certificates: Sequence[Certificate] = ()
    checks: Mapping[Key, Recheck] = field(default_factory=dict)
    means: Any = None
    progress: Progress | None = None

    def check_of(self, entry: Certificate) -> Recheck:
        """What checking one that it rests on has shown. Raises `ValueError` for the check of another certificate."""
        check = self.checks[entry.key]
        if check.stands_without_place and check.digest != entry.digest:
            raise ValueError(f"checks: {entry.id!r}: is the check of another certificate")
        return check

    def all_stand(self) -> None:
        """Raises `CannotBeCheckedError` if one that it rests on does not stand."""
        for entry in self.certificates:
            if not (check := self.check_of(entry)).stands_without_place:
                raise CannotBeCheckedError(f"the certificate {entry.called} does not stand: {check.why}")


Step = Callable[["Certificate", Given, Examination], Iterable[Finding]]
"""One level of a check (section 13)."""


@dataclass(frozen=True, kw_only=True)
class Kind:
    """One kind of theorem; each is a module of `verify.theorems`, and `kinds` finds it.

    Attributes:
        names: of the claims.
        schema: the format of its documents.
        part: what its certificates can be for those that rest on them.
        levels: form, conclusion and integration; `None` for those of boxes.
        rests_on: among certificates that are given, those that one needs, in its order. Raises `InputError` if one is
            not there.
        more: what a certificate says besides, by name.
        said: the claim in a word or two, from k and the kind.
        titles: what a theorem is about as a heading, by the name of its claim, with places for `k` and `symmetry`.
        tells_new_orbits: whether a side, if there is one, is that of new orbits.
        legend: the claim in the legend of a picture, from k and the kind; `None` for what is `said`.
        called: a certificate in a sentence, with a place for its id.
        found_as: the name by which a certificate has what is proved of one orbit: `orbit`, or `periodic`.
        extent: how much it is about, in words.
        well_formed: raises `InputError` if the document of a file is none of the kind although it fits its schema.
        one_a_line: the keys that lead to lists whose entries have a line each in a file.
    """

    names: tuple[str, ...]
    schema: str
    part: str
    said: Callable[[int, str], str]
    titles: Mapping[str, str] = field(default_factory=dict)
    levels: tuple[Step, Step, Step] | None = None
    rests_on: Callable[[Certificate, Sequence[Certificate]], tuple[Certificate, ...]] = lambda entry, given: ()
    more: Mapping[str, Callable[[Certificate], Any]] = field(default_factory=dict)
    tells_new_orbits: bool = True
    legend: Callable[[int, str], str] | None = None
    called: str = "{}"
    found_as: str = ""
    extent: Callable[[Certificate], str] = lambda entry: ""
    well_formed: Callable[[Mapping[str, Any], Path], None] = lambda document, path: None
    one_a_line: tuple[tuple[str, ...], ...] = ()


@dataclass(frozen=True, kw_only=True)
class BoxKind(Kind, Generic[Claim, Found, Results]):
    """One kind of claim about a box.

    Attributes:
        enclosures: the type of what a proof is evaluated from. How it is written down, read, and compared with that of
            another integration follows from its fields.
        results: the type of what is proved then, in the same way; its `point`, if it has
            one, is that of the claim, by coordinate.
        statement: the claim in full, but for the theorem; the second argument is its level form, if its box and
            coordinates are those that the hypotheses are about.
        theorem_of: the theorem that a candidate claims, or why none applies; the second argument is as before.
        level_form: the same claim with the level of the first integral as parameter, if there is one.
        check_own_box: that what is proved of the level form holds for the claim's own box, from both claims and the
            point that was found; raises `NotEstablishedError`. `None` where there is no level form.
        first_precision: bits to begin with, for so many digits.
        check_exactly: all hypotheses that need no integration; raises `NotEstablishedError` for the first that fails.
        enclose: what its proof is evaluated from. Raises `NotEstablishedError` if there is none, or the claim is false.
        prove: check the claim, given what was enclosed, if anything.
        on_side: what there is on the side of the parameter that is proved, from the kind.
        normal_form_section: of the coefficients among the `attributes`.
        picture: which one shows it: "box", "birth", "meeting", "orbit", "stable orbit", "periodic orbit",
            "bifurcation", "connection"; "" for none.
        attributes: what a `Certificate` says of the results beside their point; the rest is as of what is not proved.
        besides: what else the screen tells of the results, in short lines.
        missing: how many digits the results lack, of so many that are wanted.
        in_words: the theorem in short.
        in_full: so that it stands alone: system, box, theorem, what its words mean, what was found.
        variables: of the tables of derivatives among the enclosures.
    """

    schema: str = "certificates"
    part: str = "vertex"
    enclosures: type[Found]
    results: type[Results]
    statement: Callable[[Claim, Claim | None], AnyStatement]
    theorem_of: Callable[[Claim, Claim | None], Theorem | Reason]
    level_form: Callable[[Claim], Claim | None] = lambda claim: None
    check_own_box: Callable[[Checklist, Claim, Claim, Mapping[str, arb]], None] | None = None
    first_precision: Callable[[Claim, int], int]
    check_exactly: Callable[[Checklist, Claim], None]
    enclose: Callable[[Claim, IntegratorSettings, Progress | None], Found]
    prove: Callable[[Claim, Checklist, Found | None], Outcome[Results]]
    on_side: Callable[[str], str] = lambda kind: "new orbits"
    normal_form_section: str = "9.5"
    picture: str = ""
    attributes: Callable[[Results], dict[str, Any]]
    besides: Callable[[Claim, Results], Iterable[str]] = lambda claim, found: ()
    missing: Callable[[Results, int], int]
    in_words: Callable[[Any], str]
    in_full: Callable[[Claim, Any, Results], str]
    variables: Callable[[Any], int] = lambda claim: len(claim.radii)
