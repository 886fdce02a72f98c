"""Claims of every kind proved, each in the run of its kind: what `verify.certify` asks for, as values."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from pathlib import Path
from typing import Any

from orbitproof.shared.claims import AnyAtlas
from orbitproof.shared.claims.index_along import IndexAlong
from orbitproof.shared.claims.life import Life
from orbitproof.shared.claims.web import Web
from orbitproof.shared.formats import (
    BoxClaim,
    CatalogueRows,
    InputError,
    check_writable,
    read_atlas,
    read_catalogue_rows,
    read_claims,
    stated_format,
)
from orbitproof.shared.numbers import parse_exact
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import Certificate, Limits, repeated, write_certificate
from orbitproof.verify.certificate.kinds import kind_named
from orbitproof.verify.run.workplace import Workplace

AnyClaim = BoxClaim | AnyAtlas | Web | Life | IndexAlong | CatalogueRows
"""What can be proved: of a box, a branch, curves joined into a graph, the index along a curve, rows of a catalogue."""


@dataclass(frozen=True)
class Asked:
    """What a proof is given beside the claim.

    Attributes:
        rests_on: certificates on which it may rest.
        workplace: where it is done.
        output: a file for the certificates.
        fresh: whether nothing that is in the file is kept.
        options: those of the kind that are not left out, by name.
    """

    rests_on: Sequence[Certificate]
    workplace: Workplace
    output: Path | None
    fresh: bool
    options: Mapping[str, Any]

    def curve(self, name: str | None = None) -> Certificate:
        """The curve on which the claim rests: the one of this id, or the only one. Raises `InputError`."""
        curves = [entry for entry in self.rests_on if entry.key[0] == "arc" and name in (None, entry.id)]
        if len(curves) != 1:
            which = "one curve" if name is None else f"the curve {shown(name)}, once"
            raise InputError(f"rests_on: the claim rests on {which}; give its certificate")
        return curves[0]


def _rows(claims: Sequence[Any], asked: Asked) -> list[Certificate]:
    from orbitproof.verify.run.rows import RowRun

    if asked.rests_on:
        raise InputError("rests_on: a claim about a box rests on nothing; leave it out, or ask verify.places")
    limits = Limits(timeout=asked.workplace.timeout, **asked.options)
    run = RowRun(claims, claims, limits, asked.output, asked.fresh, asked.fresh)
    run.prove(asked.workplace)
    return [run.done[claim.id] for claim in claims]


def _branch(claims: Sequence[Any], asked: Asked) -> list[Certificate]:
    from orbitproof.verify.branches import kind_of
    from orbitproof.verify.run.branches import conclude_run, limits_of, prove_pieces, started

    (claim,) = claims
    for name in repeated(asked.rests_on):
        raise InputError(f"rests_on: id {name!r} appears twice; give each certificate once")
    if asked.rests_on and not kind_of(claim).holds_points:
        raise InputError("rests_on: orbits are looked for on curves of symmetric orbits only; leave it out")
    limits = limits_of(claim, timeout=asked.workplace.timeout, **asked.options)
    run = started(claim, limits, asked.output, asked.fresh)
    prove_pieces(run, asked.workplace)
    return [conclude_run(run, asked.rests_on, asked.workplace)]


def _web(claims: Sequence[Any], asked: Asked) -> list[Certificate]:
    from orbitproof.shared.codec import to_json
    from orbitproof.shared.formats.web import web_from_json
    from orbitproof.verify.branches import certified_web, claiming_indices
    from orbitproof.verify.run.web_command import certify_graph

    (claim,) = claims
    web = web_from_json(to_json(claim), "web")
    web = claiming_indices(web, asked.rests_on) if asked.options.get("indices") else web
    return _written(certify_graph(web, certified_web, asked.rests_on, asked.workplace), asked)


def _life(claims: Sequence[Any], asked: Asked) -> list[Certificate]:
    from orbitproof.shared.codec import to_json
    from orbitproof.shared.formats.life import life_from_json
    from orbitproof.verify.branches.life import certified_life
    from orbitproof.verify.run.web_command import certify_graph

    (claim,) = claims
    life = life_from_json(to_json(claim), "life")
    return _written(certify_graph(life, certified_life, asked.rests_on, asked.workplace), asked)


def _index(claims: Sequence[Any], asked: Asked) -> list[Certificate]:
    from orbitproof.verify.run.index_command import certify_the_index

    (claim,) = claims
    return _written(certify_the_index(asked.curve(claim.curve), asked.workplace), asked)


def _catalogue(claims: Sequence[Any], asked: Asked) -> list[Certificate]:
    from orbitproof.shared.formats import table_form
    from orbitproof.verify.branches import WITHIN, certified_table
    from orbitproof.verify.run.catalogue_command import certify_rows

    (rows,) = claims
    table = asked.options.get("table")
    if table is not None:
        check_writable(Path(table))
        table_form(Path(table))
    within = asked.options.get("within", WITHIN)
    distance = parse_exact(within) if isinstance(within, str) else Fraction(within)
    if not distance > 0:
        raise ValueError(f"within: {within} is not positive")
    certificate = certify_rows(rows, asked.curve(), distance, asked.workplace)
    if table is not None:
        certified_table(rows, certificate.document).write(Path(table))
    return _written(certificate, asked)


def _written(certificate: Certificate, asked: Asked) -> list[Certificate]:
    if asked.output is not None:
        write_certificate(asked.output, certificate.document)
    return [certificate]


@dataclass(frozen=True)
class _Way:
    """How claims of some kinds are proved.

    Attributes:
        prove: all claims that one file of certificates holds, in their order.
        about: what they are about, in words.
        options: what can be asked for besides.
        several: whether a file holds several.
    """

    prove: Callable[[Sequence[Any], Asked], list[Certificate]]
    about: str
    options: tuple[str, ...] = ()
    several: bool = False


_WAYS: Mapping[str, _Way] = {
    "vertex": _Way(_rows, "a box", ("scheduler", "digits", "max_precision", "level", "other_boxes"), several=True),
    "arc": _Way(
        _branch,
        "a branch",
        ("scheduler", "complete", "combinations", "lasting", "max_splits", "precision", "order", "width", "top"),
    ),
    "web": _Way(_web, "a graph of curves", ("indices",)),
    "life": _Way(_life, "a graph of curves"),
    "index": _Way(_index, "an index"),
    "catalogue": _Way(_catalogue, "rows of a catalogue", ("within", "table")),
}
"""By what certificates of the kind can be for those that rest on them."""


def read_any_claims(path: Path) -> list[AnyClaim]:
    """The claims of a file: those of candidates, an atlas, a graph of curves, or rows of a catalogue.

    Raises `InputError`.
    """
    schema = stated_format(path, "give the path of a file of claims")
    if schema == "candidates":
        return list(read_claims(path))
    if schema == "atlas":
        return [read_atlas(path)]
    if schema == "web":
        from orbitproof.shared.formats.web import read_web

        return [read_web(path)]
    if schema == "life-claim":
        from orbitproof.shared.formats.life import read_life_claim

        return [read_life_claim(path)]
    return [read_catalogue_rows(path)]


def _part(claim: object) -> str:
    """What its certificate can be for others. Raises `TypeError` for what is no claim."""
    if not isinstance(claim, AnyClaim):
        words = "explore.refine, read_candidates and read_atlas give some"
        raise TypeError(f"claims: {type(claim).__name__} is no claim that can be proved; {words}")
    said: Any = getattr(claim, "claim", claim)
    return kind_named(said.kind).part


def certified(claims: Sequence[AnyClaim], asked: Asked) -> list[Certificate]:
    """The certificates of claims of any kinds, in their order; those that one file can hold are proved in one run.

    `asked` has the options as they were given, `None` for what is left out. Raises `InputError` for what cannot be
    asked of such a claim, and as the runs do.
    """
    parts = [_part(claim) for claim in claims]
    groups: list[list[int]] = []
    for part in dict.fromkeys(parts):
        way, own = _WAYS[part], [i for i, each in enumerate(parts) if each == part]
        groups += [own] if way.several else [[i] for i in own]
        for name, value in asked.options.items():
            if value is not None and name not in way.options:
                raise InputError(f"{name}: is not asked of a claim about {way.about}; leave it out")
        if way.several:
            for name in repeated([claims[i] for i in own]):  # type: ignore[misc]
                raise InputError(f"claims: id {name!r} appears twice; give each candidate its own id")
    if asked.output is not None:
        if len(groups) > 1:
            raise InputError("output: holds rows, or one certificate of another kind; prove these claims one by one")
        check_writable(asked.output)
    given = {name: value for name, value in asked.options.items() if value is not None and name != "scheduler"}
    asked = replace(asked, options=given)
    found: dict[int, Certificate] = {}
    for group in groups:
        found |= zip(group, _WAYS[parts[group[0]]].prove([claims[i] for i in group], asked), strict=True)
    return [found[i] for i in range(len(claims))]
