"""What each kind of claim about a box offers to certificates: theorem, enclosures, proof, their numbers, results."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Set
from typing import Any, Protocol, TypeVar

from flint import arb

from orbitproof.verify.certificate.levels import Finding
from orbitproof.verify.certificate.tables import derivative_name
from orbitproof.verify.evidence import Checklist, DerivativeTable, Outcome, Reason, Theorem
from orbitproof.verify.poincare import IntegratorSettings

Claim = TypeVar("Claim")
Found = TypeVar("Found")
Results = TypeVar("Results")
Progress = Callable[[float], None]


class RowKind(Protocol[Claim, Found, Results]):
    """One kind of claim; `kinds.KINDS` has them all.

    Attributes:
        names: of the claims, as candidates say them.
        enclosures: the type of what a proof is evaluated from.
        results: the type of what is proved then.
        keys: of enclosures in certificates.
        with_distance: whether the distance that a system names is part of what is proved.
    """

    names: tuple[str, ...]
    enclosures: type[Found]
    results: type[Results]
    keys: Set[str]
    with_distance: bool

    def theorem_of(self, candidate: Claim, form: Claim | None) -> Theorem | Reason:
        """The theorem that a candidate claims, or why none applies; `form` is its level form, if that is checked."""

    def level_form(self, candidate: Claim) -> Claim | None:
        """The same claim with the level of the first integral as parameter, if there is one."""

    def first_precision(self, candidate: Claim, digits: int) -> int:
        """Bits to begin with, for so many digits."""

    def check_exactly(self, checklist: Checklist, candidate: Claim) -> None:
        """All hypotheses that need no integration; raises `NotEstablishedError` for the first that fails."""

    def enclose(self, candidate: Claim, settings: IntegratorSettings, progress: Progress | None) -> Found:
        """What its proof is evaluated from. Raises `NotEstablishedError` if there is none, or the claim is false."""

    def prove(self, candidate: Claim, checklist: Checklist, found: Found | None) -> Outcome[Results]:
        """Check the claim, given what was enclosed, if anything."""

    def to_json(self, found: Found) -> dict[str, Any]:
        """Enclosures as a certificate carries them. Raises `ValueError` if one is not finite."""

    def from_json(self, entry: Mapping[str, Any], dimension: int, computation: Mapping[str, Any]) -> Found:
        """The same enclosures. Raises `ValueError` that names what cannot be read."""

    def tables(self, found: Found) -> Iterator[tuple[str, DerivativeTable]]:
        """The tables among them, by name."""

    def numbers(self, found: Found) -> Iterator[tuple[str, arb]]:
        """The other numbers, by name."""

    def unconfirmed(self, stored: Mapping[str, Any], found: Results, place: str) -> Iterator[Finding]:
        """What a certificate says of the results, and what a new proof does not confirm."""

    def said(self, k: int, kind: str) -> str:
        """The claim in a word or two."""

    def attributes(self, results: Mapping[str, Any], source: str) -> dict[str, Any]:
        """What a `Certificate` says of stored results. Raises `InputError`, `KeyError` or `ValueError`."""


def all_numbers(kind: RowKind[Any, Found, Results], found: Found) -> dict[str, arb]:
    """Every number of what was enclosed, by name. Raises `ValueError` if one would hide another of its name."""
    derivatives = [
        (f"{derivative_name(index)} of {name}, {part}", ball)
        for name, table in kind.tables(found)
        for part, source in (("box", table.box), ("centre", table.centre))
        for index, ball in source.items()
    ]
    named = [*derivatives, *kind.numbers(found)]
    if len(dict(named)) != len(named):
        raise ValueError("two of the numbers that are enclosed have one name")
    return dict(named)


def of_iterates(iterates: tuple[tuple[DerivativeTable, ...], ...]) -> Iterator[tuple[str, DerivativeTable]]:
    """The tables of P, P^2, .., by name."""
    for i, components in enumerate(iterates, start=1):
        for j, table in enumerate(components, start=1):
            yield f"q_{j}(P^{i})", table
