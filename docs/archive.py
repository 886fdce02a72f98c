"""An archive of certificates with a guide for readers: ``python docs/archive.py FOLDER .. -o OUT`` (``make archive``).

Every certificates file of the folders is checked again up to its conclusion and copied; the theorems are told anew, as
one document. The guide lists each certificate with its file, its digest and how to check it again. A certificate that
does not stand is refused, and then there is no archive.
"""

from __future__ import annotations

import argparse
import contextlib
import gzip
import hashlib
import io
import json
import shutil
import sys
import tarfile
import tempfile
from collections.abc import Sequence
from importlib import metadata
from pathlib import Path

from orbitproof.figures.commands.report import main as report
from orbitproof.figures.report import Checked, Refused, check_files
from orbitproof.shared import InputError
from orbitproof.shared.formats import stated_format

KINDS = ("certificates", "atlas-certificate")
FOLDER, SUMS, GUIDE = "certificates", "SHA256SUMS", "README.md"
VERSION = metadata.version("orbitproof")

_GUIDE = """\
# Certificates of orbitproof {version}

{count} certificates in {files} files. Each was checked again when this archive was made: from the enclosures
that it carries, every hypothesis was evaluated, the conclusion was drawn and its words were compared. The
theorems in full, with their hypotheses and margins, stand in `theorems.html`, and as text in `theorems.md`.

## How to check them again

    sha256sum -c {sums}
    pip install .
    orbitproof verify --recheck {folder}/FILE
    orbitproof verify atlas --recheck {folder}/FILE

The first line compares the files with their digests. The second, in the sources of version {version},
installs the verifier. Of the others the table says which is for which file; they take seconds to minutes.
With `--integrate` the same command encloses again all that a certificate carries, which takes as long as the
proof did, and `orbitproof verify --second-proof {folder}/FILE` proves a row again, if its kind is one that it
knows, by code that shares nothing with the first. What has to be trusted: docs/method.md and docs/security.md
of the sources.

A certificate is about the system with exactly the parameter values that it states, and about its box or its
pieces. *Not proved* means that something could not be shown, never that a claim is false.

## What is in it

| file | certificate | kind | verdict | checked again | digest of the certificate | command |
| --- | --- | --- | --- | --- | --- | --- |
{rows}

| file | bytes | SHA-256 of the file |
| --- | --- | --- |
{sizes}
"""


def certificates_in(folders: Sequence[Path]) -> list[Path]:
    """The files of certificates, in order of name. Raises `InputError`."""
    paths = [path for folder in folders for path in sorted(folder.glob("*.json"))]
    found = [path for path in paths if stated_format(path, "give a folder of certificates") in KINDS]
    if not found:
        raise InputError(f"{folders[0]}: holds no certificates; make some with: make report")
    names = [path.name for path in found]
    twice = next((name for name in names if names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{twice}: is in two folders; give other names")
    return found


def guide(checked: Sequence[Checked], files: Sequence[Path]) -> str:
    """The text of the guide."""
    rows, sizes = [], []
    for entry in checked:
        document = entry.document
        kind = document.get("kind") or document["statement"].get("candidate", {}).get("kind") or entry.chapter
        cells = (entry.path.name, f"`{entry.name}`", kind, document["verdict"], entry.check.word)
        rows.append(f"| {' | '.join(cells)} | `{document['digest']}` | `orbitproof {entry.command} --recheck` |")
    for path in files:
        sizes.append(f"| {path.name} | {path.stat().st_size} | `{digest(path)}` |")
    return _GUIDE.format(
        version=VERSION, count=len(checked), files=len(files), sums=SUMS, folder=FOLDER, rows="\n".join(rows),
        sizes="\n".join(sizes),
    )  # fmt: skip


def digest(path: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def pack(folder: Path, target: Path) -> None:
    """The folder as a compressed archive that depends on nothing but the files: no times, no owners."""
    stream = io.BytesIO()
    with tarfile.open(fileobj=stream, mode="w") as archive:
        for path in sorted(folder.rglob("*")):
            if path.is_file():
                entry = tarfile.TarInfo(f"{target.name.removesuffix('.tar.gz')}/{path.relative_to(folder).as_posix()}")
                entry.size, entry.mode = path.stat().st_size, 0o644
                with path.open("rb") as content:
                    archive.addfile(entry, content)
    target.write_bytes(gzip.compress(stream.getvalue(), mtime=0))


def make(folders: Sequence[Path], target: Path, pictures: bool) -> list[Checked]:
    """Make the archive in a folder, which is replaced. Raises `InputError` and `Refused`."""
    files = certificates_in(folders)
    checked = check_files(files, quiet=False)
    with tempfile.TemporaryDirectory() as name:
        draft = Path(name) / "draft"
        (draft / FOLDER).mkdir(parents=True)
        for path in files:
            shutil.copy(path, draft / FOLDER)
        words = [str(path) for path in files] + ([] if pictures else ["--no-pictures"])
        with contextlib.redirect_stdout(io.StringIO()):
            code = report([*words, "-o", str(draft / "theorems.html"), "-o", str(draft / "theorems.md"), "--quiet"])
        if code == 2:
            raise InputError("the theorems cannot be told; see above")
        (draft / GUIDE).write_text(guide(checked, files), "utf-8")
        inside = sorted(path for path in draft.rglob("*") if path.is_file())
        sums = [f"{digest(path)}  {path.relative_to(draft).as_posix()}\n" for path in inside]
        (draft / SUMS).write_text("".join(sums), "utf-8")
        target.mkdir(parents=True, exist_ok=True)
        packed = target / f"orbitproof-{VERSION}-certificates.tar.gz"
        pack(draft, packed)
        shutil.rmtree(target / "content", ignore_errors=True)
        shutil.copytree(draft, target / "content")
    total = sum(path.stat().st_size for path in files)
    print(f"{len(checked)} certificates in {len(files)} files, {total} bytes: {target / 'content' / GUIDE}")
    print(f"{packed}: {packed.stat().st_size} bytes, SHA-256 {digest(packed)}")
    return checked


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns 0, 1 where a certificate is refused or not proved, 2 for bad input."""
    parser = argparse.ArgumentParser(description="Make an archive of certificates with a guide.")
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="with certificates files")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="FOLDER", help="where the archive goes")
    parser.add_argument("--no-pictures", action="store_true", help="tell the theorems without pictures")
    options = parser.parse_args(arguments)
    try:
        checked = make(options.folders, options.output, not options.no_pictures)
    except InputError as error:
        print(f"archive: {error}", file=sys.stderr)
        return 2
    except Refused as refused:
        for path, check in refused.rechecks:
            print(f"{path}: {json.dumps(check.id)}: {check.word}; there is no archive", file=sys.stderr)
        return 1
    return 0 if all(entry.document["verdict"] == "proved" for entry in checked) else 1


if __name__ == "__main__":
    sys.exit(main())
