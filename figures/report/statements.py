"""One checked certificate as a theorem that stands alone: its system, its words, its numbers, its hypotheses."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from typing import Any

from flint import arb

from orbitproof.figures.report.document import Block, Code, Formulas, Items, Math, Paragraph, Place, Run, Runs, Table
from orbitproof.figures.report.formulas import name_to_latex, program_to_latex, typeset
from orbitproof.figures.report.margins import margin_of, part_of
from orbitproof.figures.report.theorems import Checked, CheckedAtlas, CheckedRow
from orbitproof.shared.numbers import format_exact, parse_exact
from orbitproof.shared.systems import Program
from orbitproof.verify.evidence import ball_from_json, decimal_interval, exact_text, interval_text

_DIGITS = 34
_SHORT = 12

_KINDS = {
    "symmetry_breaking": "Symmetry breaking",
    "period_tupling": "Period {k}-tupling",
    "touch_and_go": "Touch-and-go of order {k}",
}
_CURVES = {
    "arc": "A curve of symmetric periodic orbits",
    "loop": "A closed curve of symmetric periodic orbits",
    "symmetric-arc": "A curve of symmetric periodic orbits, mapped to itself by {symmetry}",
    "symmetric-loop": "A closed curve of symmetric periodic orbits, mapped to itself by {symmetry}",
}
_SIDES = {
    "above": "greater than its value at the bifurcation point",
    "below": "less than its value at the bifurcation point",
    "both": "on both sides of its value at the bifurcation point",
}
_NAMES = {"alpha": r"\alpha", "beta": r"\beta"}


def name_of(entry: Checked) -> str:
    """The id of a certificate."""
    return entry.certificate.id if isinstance(entry, CheckedRow) else str(entry.document["id"])


def kind_of(entry: Checked) -> str:
    """What a theorem is about, from the claim."""
    if isinstance(entry, CheckedRow):
        return _KINDS[entry.candidate.kind].format(k=entry.candidate.k)
    if entry.atlas.is_surface:
        return "Symmetry breaking over a range of parameters"
    return _CURVES[entry.atlas.claim.kind].format(symmetry=entry.atlas.claim.symmetry)


def is_proved(entry: Checked) -> bool:
    """The verdict."""
    return entry.check.verdict == "proved"


def statement_blocks(entry: Checked) -> tuple[Block, ...]:
    """What is proved: the system, the words of the certificate, and for a bifurcation its box and enclosures."""
    if isinstance(entry, CheckedAtlas):
        statement = entry.document["statement"]
        return (*_setting(statement, entry.atlas.parameters), *_words(str(statement["theorem"])), *_notes(entry))
    statement = entry.certificate.statement
    return (
        *_setting(statement, entry.candidate.parameters),
        *_box(entry),
        *_words(str(entry.certificate.theorem)),
        *_results(entry),
        *_notes(entry),
    )


def _setting(statement: Mapping[str, Any], parameters: Mapping[str, Fraction]) -> Iterator[Block]:
    """The equations, from the straight-line programs that the certificate states."""
    field = Program.from_text(statement["vector_field"])
    state = field.inputs[: len(field.outputs)]
    equations = list(program_to_latex(field, [rf"\dot{{{name_to_latex(name)}}}" for name in state]))
    title = statement.get("names", {}).get("system", "system")
    coordinates = ", ".join(name_to_latex(name) for name in state)
    yield Paragraph((f"The {title} is the vector field ", Math("f"), " in the coordinates ", Math(f"({coordinates})"),
                     " with"))  # fmt: skip
    yield Formulas(tuple(equations))
    given: list[Run] = []
    opening = "Its parameter is " if len(parameters) == 1 else "Its parameters are "
    for name, value in parameters.items():
        given += [", " if given else opening, Math(f"{name_to_latex(name)} ="), f" {exact_text(value)}"]
    if given:
        yield Paragraph((*given, ", where ", Code("0xMp-E"), " is the hexadecimal integer M divided by 2 to the E."))
    for name, text in statement.get("derived_parameters", {}).items():
        yield Paragraph(("The parameter ", Math(name_to_latex(name)), " is a root of the right side of"))
        yield Formulas(program_to_latex(Program.from_text(text), ["0"]))
    if statement.get("first_integral") is not None:
        name = statement.get("names", {}).get("first_integral", "first integral")
        yield Paragraph((f"Its first integral, the {name}, is",))
        yield Formulas(program_to_latex(Program.from_text(statement["first_integral"]), ["H"]))
    runs: list[Run] = ["It is reversible: ", Math("R = " + _diagonal(statement["reversing_symmetry"])), " satisfies ",
                       Math(r"f(Rx) = -R f(x)")]  # fmt: skip
    if statement.get("symmetry") is not None:
        runs += ["; ", Math("S = " + _diagonal(statement["symmetry"])), " satisfies ", Math(r"f(Sx) = S f(x)")]
    section = name_to_latex(str(statement["section"]))
    runs += [". ", Math(r"\mathrm{Fix}(R)"), " is the set of points that R leaves where they are, and ", Math("P"),
             " maps a point of the section ", Math(rf"\{{{section} = 0\}}"),
             " to the next crossing of it, in either direction."]  # fmt: skip
    yield Paragraph(tuple(runs))


def _diagonal(signs: Sequence[int]) -> str:
    return r"\mathrm{diag}(" + ", ".join(str(sign) for sign in signs) + ")"


def _words(theorem: str) -> Iterator[Block]:
    """The words of the certificate: a paragraph for each line, lists as lists."""
    items: list[Runs] = []
    for line in theorem.split("\n"):
        if line.startswith("- "):
            items.append(typeset(line[2:]))
            continue
        if items:
            yield Items(tuple(items))
            items = []
        yield Paragraph(typeset(line[:1].upper() + line[1:]))
    if items:
        yield Items(tuple(items))


def box_label(entry: CheckedRow) -> str:
    """Where the exact box stands."""
    return f"box-{entry.certificate.id}"


def _box(entry: CheckedRow) -> Iterator[Block]:
    claim = entry.claim
    names = ", ".join(claim.coordinates)
    centre = ", ".join(_approximate(value, 20) for value in claim.centre)
    radii = ", ".join(_approximate(value, 3) for value in claim.radii)
    yield Paragraph((
        f"The box consists of the points with coordinates ({names}) equal to ", Math(r"c + A p"), " for ",
        Math(r"|p_i| \le R_i"), f"; the centre c is about ({centre}), the radii are about ({radii}); c, A and R stand "
        "exactly in ", Place(box_label(entry), "the table of boxes"), ".",
    ))  # fmt: skip


def _approximate(value: Fraction, digits: int) -> str:
    return f"{float(value):.3g}" if digits <= 3 else _decimal(value, digits)


def _decimal(value: Fraction, digits: int) -> str:
    """A number rounded to the nearest with so many decimals."""
    sign, scaled = "-" if value < 0 else "", round(abs(value) * 10**digits)
    whole, rest = divmod(scaled, 10**digits)
    return f"{sign}{whole}" if rest == 0 else f"{sign}{whole}.{rest:0{digits}d}".rstrip("0")


def _results(entry: CheckedRow) -> Iterator[Block]:
    certificate = entry.certificate
    if certificate.parameter is None:
        return
    items: list[Runs] = [(f"{certificate.parameter_name} in {interval_text(certificate.parameter, _DIGITS)}",)]
    items += [
        (Math(name_to_latex(name)), f" in {interval_text(ball, _DIGITS)}") for name, ball in certificate.point.items()
    ]
    items += [
        (Math(_NAMES[name]), f" in {interval_text(ball, _DIGITS)} (coefficient of the normal form)")
        for name, ball in certificate.normal_form.items()
        if name in _NAMES
    ]
    yield Paragraph(("The bifurcation point has",))
    yield Items(tuple(items))
    side = _SIDES[str(certificate.side)]
    yield Paragraph((
        f"Near it the new orbits exist for values of the {certificate.parameter_name} {side}.",
    ))  # fmt: skip


def _notes(entry: Checked) -> Iterator[Block]:
    for note in entry.check.notes:
        yield Paragraph((f"Note: {note}.",))


def hypothesis_table(entry: Checked) -> Table:
    """The hypotheses of the theorem with their enclosures and margins."""
    if isinstance(entry, CheckedRow):
        hypotheses = [
            (item.name, item.statement, item.section, item.enclosures) for item in entry.certificate.hypotheses
        ]
        radii = {"": entry.claim.radii, "candidate-box": entry.candidate.radii}
    else:
        hypotheses = [
            (item["name"], item["statement"], item["section"],
             {name: ball_from_json(ball) for name, ball in item["enclosures"].items()})
            for item in entry.document["conclusion"]["hypotheses"]
        ]  # fmt: skip
        radii = {"": ()}
    rows: list[tuple[Runs, ...]] = []
    for name, statement, section, enclosures in hypotheses:
        lead: tuple[Runs, ...] = ((name,), (f"{statement} (section {section})",))
        if not enclosures:
            rows.append((*lead, ("exact" if isinstance(entry, CheckedRow) else "",), ()))
        for key, ball in enclosures.items():
            rows.append((*lead, (f"{key}: {_shown(ball)}",), (margin_of(name, key, ball, radii),)))
            lead = ((), ())
    return Table(
        ("hypothesis", "what holds", "enclosure", "margin"), tuple(rows),
        f"Hypotheses of {kind_of(entry).lower()}, {name_of(entry)}", (0.12, 0.34, 0.34, 0.13),
    )  # fmt: skip


def _shown(ball: arb) -> str:
    return decimal_interval(ball, _SHORT)


def piece_table(entry: CheckedAtlas) -> Table:
    """The proved intervals of a curve, each with the margin of its tube, or of a surface."""
    if entry.atlas.is_surface:
        rows = tuple(
            ((str(result["piece"]),), (_interval(result["interval"]),), (str(len(result["parts"])),),
             (_shown(ball_from_json(result["time"])),))
            for result in entry.document["results"] if result["verdict"] == "proved"
        )  # fmt: skip
        return Table(("piece", "s", "parts", "half periods"), rows, f"Proved intervals, {name_of(entry)}",
                     (0.12, 0.36, 0.12, 0.32))  # fmt: skip
    tubes = {piece.id: piece.tube for piece in entry.atlas.curve_pieces()}
    rows = tuple(
        ((str(result["piece"]),), (_interval(result["interval"]),), (_shown(ball_from_json(result["time"])),),
         (_tube_margin(result["deviation"], tubes[result["piece"]]),))
        for result in entry.document["results"] if result["verdict"] == "proved"
    )  # fmt: skip
    return Table(
        ("piece", "s", "half periods", "deviation from the polynomial"), rows,
        f"Proved intervals, {name_of(entry)}", (0.1, 0.3, 0.28, 0.25),
    )  # fmt: skip


def _interval(ends: Sequence[str]) -> str:
    return "[" + ", ".join(f"{float(parse_exact(end)):g}" for end in ends) + "]"


def _tube_margin(deviations: Sequence[str], tube: Sequence[Fraction]) -> str:
    worst = max(parse_exact(text) / width for text, width in zip(deviations, tube, strict=True))
    return part_of(worst, "of the tube")


def box_table(entry: CheckedRow) -> Table:
    """Parameters and box of a claim, exactly."""
    claim = entry.claim
    rows: list[tuple[Runs, ...]] = [
        ((Math(name_to_latex(name)),), (Code(format_exact(value)),)) for name, value in claim.parameters.items()
    ]
    for index, value in enumerate(claim.centre):
        rows.append(((Math(f"c_{{{index}}}"), f", {claim.coordinates[index]}"), (Code(format_exact(value)),)))
    for i, row in enumerate(claim.frame):
        rows += [((Math(f"A_{{{i}{j}}}"),), (Code(format_exact(value)),)) for j, value in enumerate(row) if value]
    rows += [((Math(f"R_{{{index}}}"),), (Code(format_exact(value)),)) for index, value in enumerate(claim.radii)]
    return Table(("", "exact value"), tuple(rows), f"The box of {name_of(entry)}; entries of A that are 0 are left out",
                 (0.2, 0.74))  # fmt: skip


def parameter_text(entry: Checked) -> str:
    """The parameter at a bifurcation, for the summary."""
    if not isinstance(entry, CheckedRow) or entry.certificate.parameter is None:
        return ""
    return f"{entry.certificate.parameter_name} in {interval_text(entry.certificate.parameter, 20)}"
