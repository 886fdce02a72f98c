"""Build the site: ``python docs/site/build.py FOLDER``.

The documents are copied as they lie in the tree, so that their links to each other hold; the reference is made from the
code. Whatever Sphinx warns of, a broken link first, fails the build.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

from reference import PAGES  # noqa: E402

WEBS = ROOT / "web-out"
"""Where `make web` writes pages of graphs."""
PAGES_AS_THEY_ARE = "pages"
"""The folder of `html_extra_path` (conf.py)."""


def documents() -> Iterator[Path]:
    """Everything that is shown or linked to, below the root."""
    for name in ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "CODE_OF_CONDUCT.md", "CITATION.cff", "LICENSE"):
        yield ROOT / name
    for folder in ("docs", "verify", "shared", "explore", "figures", "formal"):
        yield from (path for path in (ROOT / folder).rglob("*.md") if "templates" not in path.parts)
    yield from (ROOT / "docs").rglob("*.ipynb")
    yield from (path for path in (ROOT / "docs" / "images").iterdir())
    yield from (ROOT / "docs" / "examples").glob("*.py")


def stage(folder: Path) -> None:
    """Copy all documents, and write the pages that come from the code."""
    for path in documents():
        if HERE in path.parents:
            continue
        target = folder / path.relative_to(ROOT)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(path, target)
    for path in (HERE / "conf.py", *HERE.glob("*.md")):
        shutil.copy(path, folder)
    # Pages that a browser shows as they are, if they were made: beside the documents, which then link to them.
    pages = folder / PAGES_AS_THEY_ARE / "docs" / "webs"
    pages.mkdir(parents=True)
    for path in WEBS.glob("*.html"):
        shutil.copy(path, pages)
        for page in (folder / "docs").glob("*.md"):
            link = f'<a href="webs/{path.name}">{path.name}</a>'
            page.write_text(page.read_text("utf-8").replace(f"`{WEBS.name}/{path.name}`", link), "utf-8")
    (folder / "_static").mkdir()
    shutil.copy(HERE / "site.css", folder / "_static")
    (folder / "reference").mkdir()
    for name, make in PAGES.items():
        (folder / "reference" / name).write_text(make(), "utf-8")


def build(source: Path, target: Path) -> int:
    """Run Sphinx, strictly; returns its exit code."""
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q"]
    return subprocess.run([*command, str(source), str(target)], check=False).returncode


def main() -> int:
    """Run the command line; returns the exit code."""
    parser = argparse.ArgumentParser(description="Build the site.")
    parser.add_argument("folder", type=Path, help="where the pages go")
    options = parser.parse_args()
    with TemporaryDirectory() as name:
        stage(Path(name))
        code = build(Path(name), options.folder.resolve())
    if code == 0:
        print(f"the site: {options.folder / 'index.html'}")
    return 1 if code else 0


if __name__ == "__main__":
    sys.exit(main())
