"""One checked certificate as a theorem that stands alone: its system, its words, its numbers, its hypotheses."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import fields
from fractions import Fraction
from itertools import groupby
from typing import Any, cast

from flint import arb

from orbitproof.figures.report.document import (
    Block,
    Code,
    Formulas,
    Items,
    Math,
    Paragraph,
    Reference,
    Run,
    Runs,
    Table,
)
from orbitproof.figures.report.formulas import to_latex, typeset
from orbitproof.figures.report.margins import margin_of, margin_on_atlas, part_of
from orbitproof.figures.report.theorems import ARC, VERTEX, Checked
from orbitproof.shared.claims.fields import Matrix, Vector
from orbitproof.shared.formats import (
    KINDS,
    WithoutReversor,
    as_options,
)
from orbitproof.shared.numbers import format_rational, parse_exact
from orbitproof.shared.systems import shown
from orbitproof.verify.branches.kinds import kind_of as of_branches
from orbitproof.verify.certificate.kinds import box_kind, kind_named
from orbitproof.verify.claim import claim_in_words, keyed_in_words, names_in_words
from orbitproof.verify.evidence import ball_from_json, decimal_interval, exact_text, interval_text
from orbitproof.verify.words.curve import times_are_of_quarters

_DIGITS = 34
_SHORT = 12


def kind_of(entry: Checked) -> str:
    """What a theorem is about, from the claim."""
    kind, k = entry.certificate.kind, entry.certificate.k
    known = kind_named(kind)
    symmetry = entry.certificate.atlas.claim.symmetry if entry.part == ARC else None
    return known.titles.get(kind, known.said(k, kind).capitalize()).format(k=k, symmetry=symmetry)


def is_proved(entry: Checked) -> bool:
    """The verdict."""
    return entry.check.verdict == "proved"


def system_of(entry: Checked) -> tuple[str, ...]:
    """The lines of a certificate of a box that state its system, all before those of the box; empty for others."""
    if entry.part != VERTEX:
        return ()
    lines = str(entry.document["statement"]["in_full"]).split("\n")
    first = next((i for i, line in enumerate(lines) if line.startswith(_BOX)), 0)
    return tuple(lines[:first]) if _THEOREM in lines[first:] else ()


def system_blocks(lines: Sequence[str]) -> tuple[Block, ...]:
    """A system, in the words of its certificates."""
    return tuple(_blocks(lines))


def statement_blocks(entry: Checked, system: Reference | None = None) -> tuple[Block, ...]:
    """The theorem in full, in the words of its certificate: system, box, what is proved and what that means.

    Args:
        system: where the system stands that other theorems are about too; then what is proved comes first.
    """
    words = "in_full" if entry.part in (VERTEX, ARC) else "theorem"
    lines = str(entry.document["statement"][words]).split("\n")
    blocks: list[Block] = []
    if system is not None:
        lines = lines[len(system_of(entry)) :]
        theorem = lines.index(_THEOREM)
        blocks.append(Paragraph(("About ", system, ".")))
        lines = [*lines[theorem:], *lines[:theorem]]
    blocks += _blocks(lines)
    if entry.part == VERTEX:
        where = Reference(box_label(entry), "the table of boxes")
        blocks.append(Paragraph(("Centre, frame and radii stand exactly in ", where, ".")))
        blocks += _normal_form(entry)
    return (*blocks, *_notes(entry))


_THEOREM, _BOX = "Theorem.", "The box"
_EQUATION = re.compile(r"  ([\w']+) = (.*)")
_VALUE = re.compile(r"(.*) \(exactly (.*)\)")


def _blocks(lines: Sequence[str]) -> Iterator[Block]:
    """Lines that are indented are equations or entries of a list, as are those that begin with a hyphen.

    The line that says where the theorem begins is left out: all of it stands under the theorem's number.
    """
    for kind, group in groupby((line for line in lines if line != _THEOREM), _kind):
        if kind is Formulas:
            equations = [found.groups() for line in group if (found := _EQUATION.fullmatch(line)) is not None]
            yield Formulas(tuple((to_latex(left), _right(right)) for left, right in equations))
        elif kind is Items:
            yield Items(tuple(typeset(line.removeprefix("- ").strip()) for line in group))
        else:
            yield from (Paragraph(typeset(line[:1].upper() + line[1:])) for line in group)


def _kind(line: str) -> type[Block]:
    if _EQUATION.fullmatch(line):
        return Formulas
    return Items if line.startswith(("  ", "- ")) else Paragraph


def _right(text: str) -> str:
    """The right side of an equation: a formula, or a value with its exact form in words."""
    value = _VALUE.fullmatch(text)
    return to_latex(text) if value is None else rf"{value[1]} \quad \text{{(exactly {value[2]})}}"


def box_label(entry: Checked) -> str:
    """Where the exact box stands."""
    return f"box-{entry.certificate.id}"


def _normal_form(entry: Checked) -> Iterator[Block]:
    section = box_kind(entry.certificate.kind).normal_form_section
    balls = {name: ball for name, ball in entry.certificate.normal_form.items() if name in ("alpha", "gamma", "beta")}
    if balls:
        runs: list[Run] = [f"The coefficients of the normal form (section {section}):"]
        for name, ball in balls.items():
            runs += [" ", Math(rf"\{name}"), f" in {interval_text(ball, _DIGITS)}", "." if name == "beta" else ","]
        yield Paragraph(tuple(runs))


def _notes(entry: Checked) -> Iterator[Block]:
    for note in (*entry.check.notes, *([entry.check.open_place] if entry.check.open_place else [])):
        yield Paragraph((f"Note: {as_options(note)}.",))


def hypothesis_table(entry: Checked) -> Table:
    """The hypotheses of the theorem with their enclosures and margins."""
    rows: list[tuple[Runs, ...]] = []
    for each in entry.certificate.hypotheses:
        name, statement, section, enclosures = each.name, each.statement, each.section, each.enclosures
        lead: tuple[Runs, ...] = ((name,), (f"{statement} (section {section})",))
        if not enclosures:
            rows.append((*lead, ("exact",) if entry.part == VERTEX else (), ()))
        for key, ball in enclosures.items():
            rows.append((*lead, (f"{key}: {shown_ball(ball)}",), _margin(entry, name, key, ball)))
            lead = ((), ())
    kind = kind_of(entry)
    return Table(
        ("hypothesis", "what holds", "enclosure", "margin"), tuple(rows),
        f"Hypotheses of {kind[0].lower()}{kind[1:]}, {shown(entry.name)}", (0.12, 0.34, 0.34, 0.13),
    ).without_empty_columns()  # fmt: skip


def _margin(entry: Checked, hypothesis: str, name: str, ball: arb) -> Runs:
    margin = ""
    if entry.part == ARC:
        margin = margin_on_atlas(entry.certificate.atlas, hypothesis, name, ball)
    elif entry.part == VERTEX:
        margin = margin_of(entry.claim, entry.candidate, hypothesis, name, ball)
    return (margin,) if margin else ()


def shown_ball(ball: arb) -> str:
    """A ball as an interval of decimals, in few digits."""
    return decimal_interval(ball, _SHORT)


def piece_table(entry: Checked) -> Table:
    """The proved intervals of a curve or surface: in how many parts, and for curves the margin of the tube."""
    atlas = entry.certificate.atlas
    tubes: dict[str, Sequence[Fraction]] = {piece.id: (piece.tube,) for piece in atlas.libration_pieces()}
    tubes |= {piece.id: piece.tube for piece in atlas.curve_pieces()}
    rows: list[tuple[Runs, ...]] = []
    for result in entry.document["results"]:
        if result["verdict"] == "proved":
            piece, tube = str(result["piece"]), tubes.get(result["piece"])
            parts: Runs = (str(len(result["parts"])),) if "parts" in result else ()
            margin: Runs = () if tube is None else (_tube_margin(result["deviation"], tube),)
            times = (shown_ball(ball_from_json(result["time"])),)
            rows.append(((piece,), (_interval(result["interval"]),), parts, times, margin))
    times_of = f"{of_branches(atlas).time}s"
    if atlas.is_of_symmetric_orbits and times_are_of_quarters(atlas.system):
        times_of = "T"
    return Table(
        ("piece", "s", "parts", times_of, "deviation from the polynomial"), tuple(rows),
        f"Proved intervals, {shown(entry.name)}", (0.12, 0.22, 0.08, 0.25, 0.25),
    ).without_empty_columns()  # fmt: skip


def _interval(ends: Sequence[str]) -> str:
    return "[" + ", ".join(exact_text(parse_exact(end)) for end in ends) + "]"


def _tube_margin(deviations: Sequence[str], tube: Sequence[Fraction]) -> str:
    worst = max(parse_exact(text) / width for text, width in zip(deviations, tube, strict=True))
    return part_of(worst, "of the tube")


def box_table(entry: Checked) -> Table:
    """Parameters and box of a claim, exactly; with a level form also the candidate's own box."""
    if not entry.candidate.uses_reversor:
        return _table_of(cast(WithoutReversor, entry.candidate))
    claim, candidate = claim_in_words(entry.claim), claim_in_words(entry.candidate)
    rows: list[tuple[Runs, ...]] = [
        ((Math(to_latex(name)),), (Code(format_rational(value)),)) for name, value in candidate.parameters.items()
    ]
    rows += _box_rows(claim.centre, claim.frame, claim.radii, claim.titles, "")
    if entry.claim is not entry.candidate:
        own = candidate.centre, candidate.frame, candidate.radii, candidate.titles
        rows += _box_rows(*own, ", the candidate's own box")
    title = f"The box of {shown(entry.name)}; entries of A that are 0 are left out"
    return Table(("", "exact value"), tuple(rows), title, (0.26, 0.68))


def _table_of(claim: WithoutReversor) -> Table:
    """All numbers of a claim that uses no symmetry, under the names of its fields; those of its box last."""
    names = names_in_words(claim.system)
    rows: list[tuple[Runs, ...]] = [
        ((Math(to_latex(name)),), (Code(format_rational(value)),))
        for name, value in keyed_in_words(claim.system, claim.parameters).items()
    ]
    box = {"centre": claim.centre, "frame": getattr(claim, "frame", ()), "radii": claim.radii}
    for each in fields(claim):
        rows += [] if each.name in box else _numbers(each.name, getattr(claim, each.name))
    rows += _box_rows(**box, coordinates=[names.get(name, name) for name in claim.coordinates], which="")
    title = f"The box of {shown(claim.id)}; entries of vectors and matrices that are 0 are left out"
    return Table(("", "exact value"), tuple(rows), title, (0.26, 0.68))


def _numbers(name: str, value: Any) -> Iterator[tuple[Runs, ...]]:
    """The numbers of a field, each under its place."""
    if isinstance(value, int | Fraction):
        yield (Code(name),), (Code(format_rational(Fraction(value))),)
    elif isinstance(value, tuple):
        for place, inner in enumerate(value):
            yield from _numbers(f"{name}[{place}]", inner) if inner else ()


def _box_rows(
    centre: Vector, frame: Matrix, radii: Vector, coordinates: Sequence[str], which: str
) -> Iterator[tuple[Runs, ...]]:
    for index, value in enumerate(centre):
        yield (Math(f"c_{{{index}}}"), f", {coordinates[index]}{which}"), (Code(format_rational(value)),)
    for i, row in enumerate(frame):
        for j, value in enumerate(row):
            if value:
                yield (Math(f"A_{{{i}{j}}}"), which), (Code(format_rational(value)),)
    for index, value in enumerate(radii):
        yield (Math(f"R_{{{index}}}"), which), (Code(format_rational(value)),)


def parameter_text(entry: Checked) -> str:
    """The parameter at a bifurcation, the period of an orbit, or what is on a curve or surface, for the summary."""
    if entry.part == ARC:
        return _extent(entry)
    if entry.part != VERTEX:
        return kind_named(entry.certificate.kind).extent(entry.certificate)
    if entry.certificate.parameter is None:
        return ""
    return f"{entry.certificate.parameter_name} in {interval_text(entry.certificate.parameter, 20)}"


def _extent(entry: Checked) -> str:
    conclusion, covers, names = (
        entry.document["conclusion"],
        entry.certificate.atlas.claim.covers,
        names_in_words(entry.certificate.atlas.system),
    )
    parts = []
    if covers is not None:
        name = names.get(covers.coordinate, covers.coordinate)
        parts.append(f"{name} from {exact_text(covers.start)} to {exact_text(covers.end)}")
    for what, are_orbits in (("bifurcation", False), ("orbit", True)):
        there = [each["on_curve"] and (each["kind"] not in KINDS) == are_orbits for each in conclusion["bifurcations"]]
        if number := sum(there):
            parts.append(f"{number} certified {what}s on it" if number > 1 else f"one certified {what} on it")
    if "complete" in conclusion:
        parts.append(f"list of resonances to k = {conclusion['complete']['order']}")
    return "; ".join(parts)
