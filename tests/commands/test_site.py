"""The site: everything is on it, made from the code; a broken link fails."""

from __future__ import annotations

import importlib
import json
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest
from support.chapters import mathematics

from orbitproof.figures.report.formulas import to_latex, to_mathml

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "docs" / "site"


@pytest.fixture(scope="module")
def site() -> Iterator[dict[str, ModuleType]]:
    """The modules that make the pages."""
    names = ("reference", "build")
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(SITE))
        yield {name: importlib.import_module(name) for name in names}
    for name in names:
        sys.modules.pop(name, None)


def test_in_print_nothing_is_clipped() -> None:
    style = (SITE / "site.css").read_text("utf-8")
    _, _, printed = style.partition("@media print {")
    assert ".table-wrapper, .output.text_html { overflow: visible; }" in printed
    assert re.search(r"\bpre \{[^}]*white-space: pre-wrap; overflow-wrap: anywhere", printed)
    assert re.search(r"h1, h2, h3, h4 \{ break-after: avoid", printed)
    # The rule about one line to a row goes by the heading of the page.
    assert (ROOT / "docs" / "tables.md").read_text("utf-8").startswith("# The tables, certified\n")
    assert "#the-tables-certified td { white-space: nowrap; }" in style


@pytest.mark.parametrize(
    ("line", "latex"),
    [
        ("P^(2i)(x) = x.", "P^{2i}(x) = x."),
        ("g_0 in G_01 + G_11 p_1'/2", r"g_{0} \in  G_{01} + G_{11} p_{1}'/2"),
        ("S_(N-j) t^j/j  <=  mu r_1^-3", r"S_{N-j} t^{j}/j\quad \le \quad \mu  r_{1}^{-3}"),
        ("u1' = 2 (u2 w1)", "u_{1}' = 2 (u_{2} w_{1})"),
        ("b_(alpha,m) inside X", r"b_{\alpha ,m} \text{ inside } X"),
    ],
)
def test_a_formula_in_plain_text_is_set_sign_for_sign(line: str, latex: str) -> None:
    assert to_latex(line) == latex


@pytest.mark.parametrize(
    ("latex", "shown"),
    [
        ("x''' = c^2", "x\u2034=c2"),
        ("c'_j", "cj\u2032"),
        ("{x'}^2", "x\u20322"),
        (r"\bar {C'}", "C\u2032\u00af"),
        ("p_1'''", "p1\u2032\u2033"),
    ],
)
def test_primes_stand_beside_their_letter(latex: str, shown: str) -> None:
    formula = to_mathml(latex)
    assert re.sub("<[^>]*>", "", formula) == shown
    assert not re.search("<m[in]>[\u2032-\u2034]", formula)


def test_a_formula_whose_index_is_not_closed_is_refused() -> None:
    for line in ("x_(i+1", "x^"):
        with pytest.raises(ValueError):
            to_latex(line)


def test_all_mathematics_of_the_documents_can_be_set(site: dict[str, ModuleType]) -> None:
    found = {"inline": 0, "fenced": 0}
    for path in site["build"].documents():
        if path.suffix == ".md":
            inline, fenced = mathematics(path.read_text("utf-8"))
            found["inline"] += len(inline)
            found["fenced"] += len(fenced)
            for formula in (*inline, *fenced):
                # What the converter does not know it shows as it is written.
                assert not re.search(r"<m[ion]>(&<|\\)", to_mathml(formula)), f"{path}: {formula}"
    assert found["inline"] > 5000
    assert found["fenced"] > 100


def test_the_reference_has_every_command_with_its_options(site: dict[str, ModuleType]) -> None:
    page = site["reference"].commands_page()
    parsers = list(site["reference"].parsers())
    names = {parser.prog for parser in parsers}
    assert {"orbitproof explore candidates", "orbitproof verify", "orbitproof verify atlas", "orbitproof figures all",
            "orbitproof verify --second-proof", "orbitproof report"} <= names  # fmt: skip
    for parser in parsers:
        assert f"## {parser.prog}\n" in page
        for action in parser._actions:
            assert all(option in page for option in action.option_strings)


def test_help_fits_a_terminal(site: dict[str, ModuleType], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")
    for parser in site["reference"].parsers():
        usage, _, text = parser.format_help().partition("\n\n")
        assert usage.startswith("usage: ")
        assert [line for line in text.splitlines() if len(line) > 80] == [], parser.prog


def test_the_reference_has_every_field_of_every_format(site: dict[str, ModuleType]) -> None:
    page = site["reference"].formats_page()
    for path in (ROOT / "shared" / "schemas").glob("*.json"):
        assert f"## {path.name.removesuffix('.schema.json')}\n" in page
        for name in json.loads(path.read_text("utf-8"))["properties"]:
            assert f"| `{name}` |" in page


def test_pages_of_graphs_that_were_made_are_linked(
    site: dict[str, ModuleType], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    webs = tmp_path / "web-out"
    webs.mkdir()
    (webs / "earth-moon.html").write_text("a graph")
    monkeypatch.setattr(site["build"], "WEBS", webs)
    site["build"].stage(tmp_path / "source")
    assert 'href="webs/earth-moon.html"' in (tmp_path / "source" / "docs" / "gallery.md").read_text("utf-8")
    assert (tmp_path / "source" / "pages" / "docs" / "webs" / "earth-moon.html").read_text() == "a graph"


def test_every_document_is_on_a_page_of_the_contents(site: dict[str, ModuleType]) -> None:
    contents = {line for page in SITE.glob("*.md") for line in re.findall(r"[\w./-]+", page.read_text("utf-8"))}
    for path in site["build"].documents():
        name = path.relative_to(ROOT).with_suffix("").as_posix()
        if path.suffix in {".md", ".ipynb"} and SITE not in path.parents:
            assert name in contents, name


def test_the_sidebar_is_short_and_in_five_parts() -> None:
    contents = (SITE / "index.md").read_text("utf-8")
    captions = re.findall(r"^:caption: (.*)$", contents, re.MULTILINE)
    assert captions == ["Tutorials", "How to", "Reference", "Explanation", "Proofs"]
    entries = "".join(re.findall(r"^```\{toctree\}\n(.*?)^```$", contents, re.MULTILINE | re.DOTALL))
    assert len(re.findall(r"^(?!:).+$", entries, re.MULTILINE)) <= 60


def test_the_reference_has_a_page_for_every_module_of_the_face(site: dict[str, ModuleType]) -> None:
    pages = site["reference"].PAGES
    contents = pages["python.md"]()
    for page, (module, _, _) in site["reference"].MODULES.items():
        assert importlib.import_module(module).__all__
        assert f"({f'python-{page}.md'})" in contents
        assert f".. automodule:: {module}\n" in pages[f"python-{page}.md"]()


@pytest.mark.slow
def test_the_site_builds_and_a_broken_link_fails(site: dict[str, ModuleType], tmp_path: Path) -> None:
    command = [sys.executable, str(SITE / "build.py"), str(tmp_path / "site")]
    built = subprocess.run(command, capture_output=True, text=True, check=False)
    assert built.returncode == 0, built.stderr[-2000:]
    notebook = (tmp_path / "site" / "docs" / "certificates.html").read_text("utf-8")
    assert "stands INTEGRATION" in notebook
    assert "evaluated again it is" in notebook
    shared = (tmp_path / "site" / "reference" / "python-shared.html").read_text("utf-8")
    assert "Candidate" in shared
    assert "Annotated" not in shared
    assert "http" not in "".join(
        line for line in (tmp_path / "site" / "index.html").read_text("utf-8").splitlines() if "<script src" in line
    )
    source = tmp_path / "source"
    source.mkdir()
    site["build"].stage(source)
    page = source / "docs" / "glossary.md"
    page.write_text(page.read_text("utf-8") + "\nSee [there](nowhere.md).\n", "utf-8")
    assert site["build"].build(source, tmp_path / "broken") != 0
