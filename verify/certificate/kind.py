"""What each kind of claim about a box offers to certificates: statement, theorem, enclosures, proof, results."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from flint import arb

from orbitproof.verify.certificate.document import AnyStatement
from orbitproof.verify.evidence import Checklist, Outcome, Reason, Theorem
from orbitproof.verify.poincare import IntegratorSettings

Claim = TypeVar("Claim")
Found = TypeVar("Found")
Results = TypeVar("Results")
Progress = Callable[[float], None]


@dataclass(frozen=True, kw_only=True)
class Kind(Generic[Claim, Found, Results]):
    """One kind of claim; each is a module of `verify.theorems`, and `kinds` finds it.

    Attributes:
        names: of the claims, as candidates say them.
        enclosures: the type of what a proof is evaluated from. How it is written down, read, and compared with that of
            another integration follows from its fields.
        results: the type of what is proved then, in the same way; its `point` is that of the claim, by coordinate.
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
        said: the claim in a word or two, from k and the kind.
        on_side: what there is on the side of the parameter that is proved, from the kind.
        attributes: what a `Certificate` says of the results beside their point; the rest is as of what is not proved.
        missing: how many digits the results lack, of so many that are wanted.
        in_words: the theorem in short.
        in_full: so that it stands alone: system, box, theorem, what its words mean, what was found.
        variables: of the tables of derivatives among the enclosures.
    """

    names: tuple[str, ...]
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
    said: Callable[[int, str], str]
    on_side: Callable[[str], str] = lambda kind: "new orbits"
    attributes: Callable[[Results], dict[str, Any]]
    missing: Callable[[Results, int], int]
    in_words: Callable[[Any], str]
    in_full: Callable[[Claim, Any, Results], str]
    variables: Callable[[Any], int] = lambda claim: len(claim.radii)
