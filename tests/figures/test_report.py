"""A report tells what its certificates prove, in every format, and nothing of a certificate that does not stand."""

from __future__ import annotations

import copy
import json
import random
import re
from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import pytest
from flint import arb
from support import atlas_work
from support.claims import known, moved
from support.forgeries import DATA, atlas_certificate, forged, forged_elsewhere, read

from orbitproof.figures.commands.report import main
from orbitproof.figures.report import Refused, check_files, margin_of, typeset
from orbitproof.figures.report.document import Math, Table
from orbitproof.figures.report.formulas import to_latex
from orbitproof.shared.systems import BRANCH_SYSTEMS
from orbitproof.verify.certificate import Certificate, Limits, certify, digest, write_certificates
from orbitproof.verify.evidence import bounds, interval_text
from orbitproof.verify.run.branch_command import main as verify_atlas
from orbitproof.verify.words.formulas import equations

LIMITS = Limits(max_precision=256)


@pytest.fixture(scope="module")
def rows() -> list[Certificate]:
    """A touch-and-go bifurcation and a symmetry breaking, proved."""
    return [certify(known(name), LIMITS) for name in ("fs3", "em1")]


@pytest.fixture(scope="module")
def surface() -> dict[str, Any]:
    results = json.loads((DATA / "surface-results.json").read_text())
    return json.loads(json.dumps(atlas_certificate(read("surface.json"), results)))  # type: ignore[no-any-return]


@pytest.fixture(scope="module")
def files(rows: list[Certificate], surface: dict[str, Any], tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """A file of two rows, and a surface."""
    folder = tmp_path_factory.mktemp("certificates")
    write_certificates(folder / "rows.json", rows)
    (folder / "surface.json").write_text(json.dumps(surface))
    return [folder / "rows.json", folder / "surface.json"]


def words(*parts: Any) -> list[str]:
    return [str(part) for part in parts]


@pytest.fixture(scope="module")
def told(files: list[Path], tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The report on these files, with its pictures, by format."""
    folder = tmp_path_factory.mktemp("report")
    targets = {suffix: folder / f"report.{suffix}" for suffix in ("html", "tex", "md")}
    outputs = [word for target in targets.values() for word in ("-o", target)]
    assert main(words(*files, *outputs, "--quiet")) == 0
    return targets


class Page(HTMLParser):
    """Text, ids and links of a page; fails where tags are not closed in order."""

    VOID = frozenset(("meta", "img", "col"))

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: set[str] = set()
        self.links: list[str] = []
        self.pictures = 0
        self.text = ""
        self.feed(text)
        assert not self.open

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if tag not in self.VOID:
            self.open.append(tag)
        for key, value in attrs:
            if key == "id":
                assert value not in self.ids, value
                self.ids.add(str(value))
            elif key == "href":
                self.links.append(str(value))
        self.pictures += tag == "img" and str(dict(attrs)["src"]).startswith("data:image/png;base64,")

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "style" not in self.open:
            self.text += data


def test_an_html_report_holds_every_theorem_with_its_numbers_and_pictures(
    told: dict[str, Path], rows: list[Certificate]
) -> None:
    page = Page(told["html"].read_text("utf-8"))
    assert page.pictures == 3
    assert {link[1:] for link in page.links if link.startswith("#")} <= page.ids
    for number, row in enumerate(rows, start=1):
        assert f"Theorem {number}: {row.id}" in page.text
        assert row.parameter is not None
        for ball in (row.parameter, *row.point.values()):
            assert interval_text(ball, 40) in page.text
        for hypothesis in row.hypotheses:
            assert f"{hypothesis.statement} (section {hypothesis.section})" in page.text
        assert str(row.to_json()["digest"]) in page.text
        assert "0x" in page.text
    assert "mu = h^3 this is the point" in page.text or "Over mu in" in page.text or "There are smooth" in page.text


def test_every_format_says_the_same_theorems(told: dict[str, Path], rows: list[Certificate]) -> None:
    plain = {}
    for suffix, target in told.items():
        text = target.read_text("utf-8")
        plain[suffix] = Page(text).text if suffix == "html" else re.sub(r"\\allowbreak\{\}|[\\{}`]", "", text)
    for row in rows:
        assert row.parameter is not None
        for low_or_high in re.findall(r"-?[0-9.]+", interval_text(row.parameter, 40)):
            assert all(low_or_high in text for text in plain.values())
        assert all(str(row.to_json()["digest"]) in text for text in plain.values())


def test_a_system_stands_once_and_what_is_proved_before_the_box(files: list[Path], tmp_path: Path) -> None:
    two = [certify(replace(known("fs3"), id=name)) for name in ("one", "two")]
    write_certificates(tmp_path / "rows.json", [*two, certify(known("em1"))])
    assert main(words(tmp_path / "rows.json", "-o", tmp_path / "r.md", "-o", tmp_path / "r.html", "--quiet")) == 0
    page = Page((tmp_path / "r.html").read_text())
    assert (
        page.text.count("The Falkner-Skan equation:")
        == page.text.count("System 1") - page.text.count("About System 1")
        == 1
    )
    assert page.text.count("About System 1") == 2
    assert page.text.count("About System 2") == 1
    assert {"system-1", "system-2"} <= page.ids
    for part in (tmp_path / "r.md").read_text().split("About ")[1:]:
        assert part.index("The bifurcation point has") < part.index("The box, in the coordinates")


def test_a_latex_report_is_balanced_and_names_pictures_that_exist(told: dict[str, Path]) -> None:
    text = told["tex"].read_text("utf-8")
    depth = 0
    for token in re.findall(r"\\.|[{}]", text, re.DOTALL):
        depth += {"{": 1, "}": -1}.get(token, 0)
        assert depth >= 0
    assert depth == 0
    opened: list[str] = []
    for word, name in re.findall(r"\\(begin|end)\{([a-z*]+)\}", text):
        if word == "begin":
            opened.append(name)
        else:
            assert opened.pop() == name
    assert not opened
    labels = set(re.findall(r"\\label\{([^}]*)\}", text))
    assert set(re.findall(r"\\hyperref\[([^]]*)\]", text)) <= labels
    pictures = re.findall(r"\\includegraphics\[[^]]*\]\{([^}]*)\}", text)
    assert len(pictures) == 3
    assert all((told["tex"].parent / name).read_bytes().startswith(b"%PDF") for name in pictures)
    assert text.isascii()


def test_a_markdown_report_has_tables_of_even_width(told: dict[str, Path]) -> None:
    text = told["md"].read_text("utf-8")
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert rows
    for row, before in zip(rows[1:], rows, strict=False):
        if set(row) <= set("|- "):
            assert len(re.findall(r"(?<!\\)\|", row)) == len(re.findall(r"(?<!\\)\|", before))
    for name in re.findall(r"!\[.*\]\(([^)]*)\)", text):
        assert (told["md"].parent / name).read_bytes().startswith(b"\x89PNG")


def _other_side(entry: dict[str, Any]) -> None:
    entry["results"]["side"] = "above"


def _more_words(entry: dict[str, Any]) -> None:
    for key in ("theorem", "in_full"):
        entry["statement"][key] += " The orbits are stable."


def _other_system(entry: dict[str, Any]) -> None:
    entry["statement"]["names"]["system"] = "three-body problem of everything"


def test_the_words_of_a_certificate_are_told_anew(rows: list[Certificate], tmp_path: Path) -> None:
    foreign = Certificate.from_json(forged_elsewhere(rows[0].to_json(), _more_words))
    write_certificates(tmp_path / "rows.json", [foreign])
    target = tmp_path / "report.html"
    assert main(words(tmp_path / "rows.json", "-o", target, "--quiet", "--no-pictures")) == 0
    page = Page(target.read_text("utf-8"))
    assert "orbits are stable" not in page.text
    assert "worded otherwise" in page.text


@pytest.mark.parametrize("change", [_other_side, _other_system, _more_words])
def test_a_forged_certificate_is_refused_and_named(
    change: Callable[[Any], Any], files: list[Path], rows: list[Certificate], tmp_path: Path, capsys: Any
) -> None:
    false = Certificate.from_json(forged(rows[0].to_json(), change))
    write_certificates(tmp_path / "rows.json", [rows[1], false])
    target = tmp_path / "report.html"
    assert main(words(tmp_path / "rows.json", files[1], "-o", target, "--quiet")) == 1
    assert not target.exists()
    errors = capsys.readouterr().err.splitlines()
    assert [line.split(": ")[:2] for line in errors if line.startswith("REFUSED")] == [
        [f"REFUSED {tmp_path / 'rows.json'}", false.id]
    ]


def test_a_changed_surface_is_told_in_its_own_words_and_refused_with_its_digest_kept(
    surface: dict[str, Any], tmp_path: Path, capsys: Any
) -> None:
    path = tmp_path / "surface.json"

    def widen(document: dict[str, Any]) -> None:
        theorem = document["conclusion"]["statement"].replace("smooth", "analytic")
        document["statement"]["theorem"] = document["statement"]["in_full"] = theorem
        document["conclusion"]["statement"] = theorem

    path.write_text(json.dumps(forged_elsewhere(surface, widen)))
    assert main(words(path, "-o", tmp_path / "report.md", "--quiet", "--no-pictures")) == 0
    assert "analytic" not in (tmp_path / "report.md").read_text()
    kept = copy.deepcopy(surface)
    widen(kept)
    path.write_text(json.dumps(kept))
    assert main(words(path, "-o", tmp_path / "report.md", "--quiet")) == 1
    assert f"REFUSED {path}: {surface['id']}: " in capsys.readouterr().err


@pytest.mark.slow
def test_a_complete_list_of_resonances_is_told_as_it_is_certified(tmp_path: Path, capsys: Any) -> None:
    certificate = tmp_path / "curve.json"
    source = str(DATA / "atlas-falkner-skan.json")
    assert verify_atlas([source, "-o", str(certificate), "--quiet", "--complete", "12"], atlas_work.stored) == 0
    target = tmp_path / "report.html"
    assert main(words(certificate, "-o", target, "--quiet")) == 0
    page = Page(target.read_text("utf-8"))
    assert "1:11, a stability parameter is cos(" in page.text
    assert "in [347.21119931, 347.21120012], half period in [0.2279189146, 0.2279189149], in piece p014" in page.text
    assert page.pictures == 2
    document = json.loads(certificate.read_text())
    theorem = document["statement"]["theorem"].replace("beta in [347.21", "beta in [347.22")
    assert theorem != document["statement"]["theorem"]
    foreign = forged_elsewhere(document, lambda entry: entry["statement"].update(theorem=theorem, in_full=theorem))
    certificate.write_text(json.dumps(foreign))
    assert main(words(certificate, "-o", tmp_path / "false.html", "--quiet", "--no-pictures")) == 0
    assert "347.22" not in Page((tmp_path / "false.html").read_text("utf-8")).text
    false = forged(document, lambda entry: entry["conclusion"]["complete"]["points"].pop())
    certificate.write_text(json.dumps(false))
    assert main(words(certificate, "-o", tmp_path / "false.html", "--quiet")) == 1
    assert "REFUSED" in capsys.readouterr().err


def test_a_system_that_is_not_known_here_is_told_from_its_program_with_a_note(
    rows: list[Certificate], tmp_path: Path
) -> None:
    def renamed(entry: dict[str, Any]) -> None:
        entry["statement"]["candidate"]["system"] = "somebody-elses"

    write_certificates(tmp_path / "rows.json", [Certificate.from_json(forged_elsewhere(rows[0].to_json(), renamed))])
    target = tmp_path / "report.html"
    assert main(words(tmp_path / "rows.json", "-o", target, "--quiet")) == 0
    page = Page(target.read_text("utf-8"))
    assert "its name is a name only" in page.text
    assert page.pictures == 1


def test_the_check_of_one_certificate_does_not_count_for_another_that_copies_its_digest(
    rows: list[Certificate], tmp_path: Path
) -> None:
    entry = rows[0].to_json()
    entry["id"] = entry["statement"]["candidate"]["id"] = "copy"
    assert entry["digest"] != digest(entry)
    write_certificates(tmp_path / "rows.json", [rows[0], Certificate.from_json(entry)])
    with pytest.raises(Refused, match=r"^copy$"):
        check_files([tmp_path / "rows.json"])


def test_what_is_not_proved_is_told_as_such(rows: list[Certificate], tmp_path: Path) -> None:
    wrong = certify(moved(known("fs2"), 0, 10), LIMITS)
    assert not wrong.proved
    assert wrong.reason is not None
    write_certificates(tmp_path / "rows.json", [rows[0], wrong])
    target = tmp_path / "report.html"
    assert main(words(tmp_path / "rows.json", "-o", target, "--quiet", "--no-pictures")) == 1
    text = Page(target.read_text("utf-8")).text
    assert f"Theorem 1: {rows[0].id}" in text
    assert "Theorem 2" not in text
    assert f"{wrong.id}: {wrong.reason.condition}" in text


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["{rows}", "-o", "report.pdf"], "the suffix says which format"),
        (["{rows}", "{rows}", "-o", "report.md"], "given twice"),
        (["{rows}", "-o", "report.md", "--only", "nothing*"], "no such certificate"),
        (["missing.json", "-o", "report.md"], "cannot be read"),
        (["{atlas}", "-o", "report.md"], "atlas"),
    ],
)
def test_bad_input_is_one_line_and_code_2(
    arguments: list[str], message: str, files: list[Path], tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    places = {"rows": str(files[0]), "atlas": str(DATA / "surface.json")}
    assert main([*(word.format(**places) for word in arguments), "--quiet"]) == 2
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 1
    assert message in errors[0]


def test_several_files_are_written_from_one_check(files: list[Path], tmp_path: Path, capsys: Any) -> None:
    targets = [tmp_path / "report.html", tmp_path / "report.md"]
    options = [word for target in targets for word in ("-o", str(target))]
    assert main([str(files[0]), *options, "--no-pictures"]) == 0
    output, errors = capsys.readouterr()
    assert output.splitlines() == [str(target) for target in targets]
    assert errors.count("[1/2]") == 1
    for target in targets:
        alone = tmp_path / f"alone{target.suffix}"
        assert main([str(files[0]), "-o", str(alone), "--no-pictures", "--quiet"]) == 0
        assert alone.read_text() == target.read_text()


def test_only_chooses_what_is_checked_and_told(files: list[Path], rows: list[Certificate]) -> None:
    (entry,) = check_files(files, ["*k1-1"])
    assert entry.part == "vertex"
    assert entry.certificate == rows[1]
    kinds = [entry.part for entry in check_files(files)]
    assert kinds == ["vertex", "vertex", "arc"]


# Formulas: what is printed is what the program computes


def value_of(latex: str, names: dict[str, float]) -> float:
    """A formula of `to_latex`, evaluated."""
    text = re.sub(r"\^\{([^{}]*)\}", r"**(\1)", latex.replace(r"\,", "*"))
    for name in sorted(names, key=len, reverse=True):
        text = text.replace(name, f"({names[name]!r})")
    assert "\\" not in text, text
    return float(eval(text, {"__builtins__": {}}))


@pytest.mark.parametrize("name", BRANCH_SYSTEMS)
def test_a_formula_as_it_is_set_is_what_the_program_computes(name: str) -> None:
    system = BRANCH_SYSTEMS[name]
    random.seed(1)
    for program in filter(None, (system.program, system.first_integral_program)):
        arguments = [random.uniform(0.2, 0.4) for _ in program.inputs]
        values = dict(zip((to_latex(each).strip() for each in program.inputs), arguments, strict=True))
        lefts = [f"out_{index}" for index in range(len(program.outputs))]
        lines = [line.split(" = ") for line in equations(program, lefts)]
        # What the names stand for comes last, each from those before it.
        for left, right in [*lines[len(lefts) :], *lines[: len(lefts)]]:
            values[to_latex(left).strip()] = value_of(to_latex(right), values)
        found = [values[to_latex(left).strip()] for left in lefts]
        assert found == pytest.approx(program.evaluate(arguments), rel=1e-12)


@pytest.mark.parametrize(
    ("text", "formula"),
    [
        ("so P^2(x) = x here", "P^{2}(x) = x"),
        ("P^(2i)(x) = x for", "P^{2i}(x) = x"),
        ("of {vy = 0}", r"\{ v_{y} = 0\}"),
        ("|z| <= 0.003 mu^(1/3), and", r"|z| \le  0.003 \mu ^{1/3}"),
    ],
)
def test_formulas_in_words_are_set_and_the_words_stay(text: str, formula: str) -> None:
    runs = typeset(text)
    assert [run.latex for run in runs if isinstance(run, Math)] == [formula]
    assert all(run in text for run in runs if isinstance(run, str))


# Margins are never larger than the truth


def test_a_margin_in_the_box_is_rounded_up_and_one_from_zero_down() -> None:
    candidate = replace(known("fs3"), radii=(Fraction(1), Fraction(6)))
    claim = replace(candidate, radii=(Fraction(1), Fraction(3)))

    def margin(hypothesis: str, name: str, ball: arb) -> str:
        return margin_of(claim, candidate, hypothesis, name, ball)

    ball = arb(0, 1)
    high = bounds(ball)[1]
    assert Fraction(margin("C3", "p_1", ball).split()[2]) >= high / 3
    assert margin("C3", "p_1", ball) == "at most 0.34 R_1"
    assert margin("candidate-box", "p_1", ball) == "at most 0.17 R_1"
    away = margin("G_01", "G_01", arb(7, 2))
    low, high = bounds(arb(7, 2))
    assert Fraction(away.split()[2]) <= low / (high - low)
    assert margin("G_01", "G_01", ball) == ""
    assert margin("twist", "tau", arb(7, 2)) == away
    zero = "Re(conj(lambda) c_1)"
    assert margin("twist", zero, arb(0.5, 1)) == "0 is in it, at most 0.50 of the way out"
    assert margin("twist", zero, ball) == "0 is its middle"
    assert margin("twist", zero, arb(2, 1)) == ""
    assert margin("family", "d q_1(P) / d p_1", arb(7)) == ""


def test_only_what_a_hypothesis_asks_for_has_a_margin() -> None:
    claim = known("em1")
    slope = f"d q_2(P^{claim.k}) / d p_2"
    assert margin_of(claim, claim, "HC2", slope, arb(7)) == "exact, not 0"
    for hypothesis, name in (("regular-1", slope), ("HC2", "d q_2(P^9) / d p_2"), ("HC3", "h_anything"),
                             ("HC3", "p_1(P_7)"), ("HC3", "p_1^Hx"), ("HC3", "p_7"), ("HC3", "G_01 + x")):  # fmt: skip
        assert margin_of(claim, claim, hypothesis, name, arb(7)) == ""


def test_a_table_leaves_out_columns_in_which_nothing_stands() -> None:
    table = Table(("name", "kind", "margin"), ((("a",), ("",), ("2 %",)), (("b",), (), ())), "Rows", (0.2, 0.3, 0.4))
    short = table.without_empty_columns()
    assert short.header == ("name", "margin")
    assert short.rows == ((("a",), ("2 %",)), (("b",), ()))
    assert short.widths == pytest.approx((0.3, 0.6))
    assert short.without_empty_columns() == short
