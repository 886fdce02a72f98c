"""The method and the code are one argument: what is cited is there, once, and every module stands in its chapter."""

import shutil
from pathlib import Path

import pytest
from support import chapters

ROOT = Path(__file__).resolve().parents[2]
CHECKS = {check.__name__: check for check in chapters.CHECKS}
SEEDS = {
    "a docstring cites a section that is not there": (
        "wrong_citations",
        "verify/flow/gronwall.py",
        "(section 4)",
        "(section 4.9)",
    ),
    "a hypothesis cites a section that is not there": (
        "wrong_citations",
        "verify/bifurcation/conditions.py",
        '"8.5"',
        '"8.9"',
    ),
    "a comment cites a lemma that is not there": (
        "wrong_citations",
        "verify/curve/gluing.py",
        "\n\nfrom __future__",
        "\n\n# By Lemma 15.9.\nfrom __future__",
    ),
    "a chapter cites a section that is not there": (
        "wrong_citations",
        "verify/newton/README.md",
        "## 7. Tools\n",
        "## 7. Tools\n\nBy sections 2 and 4.8.\n",
    ),
    "a formula is cited that is not there": (
        "wrong_citations",
        "verify/newton/README.md",
        "## 7. Tools\n",
        "## 7. Tools\n\nBy (8.9).\n",
    ),
    "a section is lost": ("wrong_citations", "verify/flow/README.md", "### 4.2 Bounds", "### Bounds"),
    "a lemma is lost": ("wrong_citations", "verify/newton/README.md", "**Lemma 5.**", "**Lemma.**"),
    "a section stands in two chapters": ("repeated_numbers", "verify/newton/README.md", "### 7.2 ", "### 8.2 "),
    "two lemmas have one number": ("repeated_numbers", "verify/flow/README.md", "**Lemma 2.**", "**Lemma 1.**"),
    "a module is not in its chapter": ("unnamed_modules", "verify/flow/README.md", "| `step` |", "| `steps` |"),
    "a heading names an old module": ("wrong_module_names", "verify/newton/README.md", "(`jets`)", "(`expansion`)"),
    "a chapter names a function that is not there": (
        "unknown_names",
        "verify/newton/README.md",
        "`is_regular`",
        "`is_invertible`",
    ),
    "a citation goes by way of the cover": (
        "roundabout_citations",
        "verify/flow/gronwall.py",
        "(section 4)",
        "(docs/method.md, section 4)",
    ),
    "the cover lists a section elsewhere": ("wrong_cover", "docs/method.md", "7, 7.2 to 7.5", "7, 7.1 to 7.5"),
    "a chapter has no row on the cover": ("wrong_cover", "docs/method.md", "../verify/flow/README.md", "flow"),
    "the cover lists a chapter before what it uses": (
        "wrong_order",
        "docs/method.md",
        "[verify/newton](../verify/newton",
        "[verify/flow](../verify/flow",
    ),
    "a link leads nowhere": ("broken_links", "docs/method.md", "../shared/README.md", "../shared/statement.md"),
    "a document names a file that is not there": (
        "lost_paths",
        "docs/completeness.md",
        "`explore/orbits/stability.py`",
        "`explore/stability.py`",
    ),
    "a proof does not end": ("ill_formed", "verify/newton/README.md", "theorem. QED", "theorem."),
    "a lemma has no proof": ("ill_formed", "verify/newton/README.md", "*Proof.* For $y", "For $y"),
    "a paragraph turns into a list": (
        "ill_formed",
        "verify/newton/README.md",
        "## 7. Tools\n",
        "## 7. Tools\n\nx\n- y\n",
    ),
    "a heading skips a level": ("ill_formed", "verify/newton/README.md", "\n## 7. Tools", "\n#### 7. Tools"),
    "Markdown eats an underscore": (
        "garbled_mathematics",
        "verify/flow/README.md",
        "$E \\le T$",
        "$|e|_g \\le e_{a}$",
    ),
    "Markdown eats a star": ("garbled_mathematics", "verify/flow/README.md", "$E \\le T$", "$(a *b) *c* d$"),
    "a formula is not marked": ("garbled_mathematics", "verify/flow/README.md", "$J_{ij}$", "J_ij"),
    "a letter stands beside a formula": ("garbled_mathematics", "verify/flow/README.md", "$J_{ij}$", "$J_{ij}$s"),
    "a formula does not end": ("garbled_mathematics", "verify/flow/README.md", "$E \\le T$", "$E \\le T"),
    "a table has a row too short": ("ill_formed", "verify/flow/README.md", "| module | what it does |", "| module |"),
}


@pytest.mark.parametrize("check", CHECKS)
def test_chapters_and_code_fit_together(check: str) -> None:
    assert CHECKS[check](ROOT) == []


@pytest.fixture(scope="module")
def copied(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of all that the checks read."""
    place = tmp_path_factory.mktemp("project")
    kept = shutil.ignore_patterns("__pycache__", "images", "*.npz", "*.mplstyle")
    for folder in ("docs", "shared", "verify", "explore", "figures"):
        shutil.copytree(ROOT / folder, place / folder, ignore=kept)
    for folder in ("docs/images", "tests/benchmarks"):
        shutil.copytree(ROOT / folder, place / folder)
    for file_kept in ("README.md", "pyproject.toml"):
        shutil.copy(ROOT / file_kept, place)
    return place


@pytest.mark.parametrize("seed", SEEDS)
def test_a_mistake_is_found(seed: str, copied: Path) -> None:
    check, file, before, after = SEEDS[seed]
    path = copied / file
    text = path.read_text("utf-8")
    assert before in text
    path.write_text(text.replace(before, after, 1), "utf-8")
    try:
        assert CHECKS[check](copied) != []
    finally:
        path.write_text(text, "utf-8")


def test_every_hypothesis_of_the_code_is_seen() -> None:
    cited = {(c.path.parent.name, c.number) for c in chapters.citations(ROOT) if c.kind == "section"}
    assert {("bifurcation", f"8.{i}") for i in (1, 2, 3, 4, 5, 7)} <= cited
    assert {("curve", "15.5"), ("claim", "7.1"), ("claim", "1.3"), ("data", "8.4")} <= cited
