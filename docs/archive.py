"""An archive of certificates with a guide for readers: ``python docs/archive.py FOLDER .. -o OUT`` (``make archive``).

Every certificates file of the folders is checked again up to its conclusion and copied; the theorems are told anew, as
one document for each folder. The guide lists each certificate with its file, its digest and how to check it again. A
certificate that does not stand is refused, and then there is no archive. What one rests on, the arcs of a web,
the curve of a catalogue's rows or of an index, has to be in the same folder.
"""

from __future__ import annotations

import argparse
import contextlib
import gzip
import hashlib
import io
import json
import os
import shlex
import shutil
import sys
import tarfile
import tempfile
from collections.abc import Mapping, Sequence
from importlib import metadata
from pathlib import Path

from orbitproof.figures.commands.report import main as report
from orbitproof.figures.report import (
    CERTIFICATE_FORMATS,
    Checked,
    Refused,
    check_again,
    check_files,
    curve_of,
    kind_of,
)
from orbitproof.figures.report import second_proofs as again_by_other_code
from orbitproof.shared import InputError
from orbitproof.shared.formats import stated_format

FOLDER, SUMS, GUIDE, THEOREMS = "certificates", "SHA256SUMS", "README.md", "theorems"
VERSION = metadata.version("orbitproof")

_GUIDE = """\
# Certificates of orbitproof {version}

{count} certificates in {files} files. Each was checked again when this archive was made: from the enclosures
that it carries, every hypothesis was evaluated, the conclusion was drawn and its words were compared. The
theorems in full, with their hypotheses and margins, stand in {theorems}.

## How to check them again

With the sources of version {version} in a folder SOURCES, in the folder of this file:

    sha256sum -c {sums}
    pip install SOURCES

The first line compares the files with their digests, the second installs the verifier. What follows checks every
certificate again, from what it carries and from the certificates that it rests on; that takes seconds to minutes:

{lines}

With `--integrate` after `--recheck` the same lines enclose again all that the certificates carry, which takes as
long as the proofs did. These lines prove rows once more, of the kinds that are known there, by code that shares
nothing with the first:

{second}

What has to be trusted: docs/method.md and docs/security.md of the sources.

A certificate is about the system with exactly the parameter values that it states, and about its box or its
pieces. *Not proved* means that something could not be shown, never that a claim is false.

## What is in it

| file | certificate | about | verdict | checked again | digest of the certificate |
| --- | --- | --- | --- | --- | --- |
{rows}

| file | bytes | SHA-256 of the file |
| --- | --- | --- |
{sizes}
"""


def certificates_in(folders: Sequence[Path]) -> dict[Path, list[Path]]:
    """The files of certificates in order of name, by folder. Raises `InputError`."""
    found = {}
    for folder in dict.fromkeys(folder.resolve() for folder in folders):
        paths = [
            path
            for path in sorted(folder.glob("*.json"))
            if stated_format(path, "give certificates") in CERTIFICATE_FORMATS
        ]
        if not paths:
            raise InputError(f"{folder}: holds no certificates; make some with: make report, make web")
        found[folder] = paths
    return found


def places_of(folders: Sequence[Path]) -> dict[Path, Path]:
    """Where the files of each folder lie in the archive: with several folders, in one of its name."""
    common = Path(os.path.commonpath([str(folder) for folder in folders]))
    return {folder: FOLDER / folder.relative_to(common) for folder in folders}


def guide(checked: Mapping[Path, Sequence[Checked]], places: Mapping[Path, Path], theorems: Sequence[str]) -> str:
    """The text of the guide. Raises `InputError` if a curve on which an orbit has a place is not there."""
    lines, second, rows, sizes = [], [], [], []

    def named(path: Path) -> str:
        return shlex.quote((places[path.parent] / path.name).as_posix())

    for entries in checked.values():
        for entry in entries:
            place = entry.document.get("place")
            if place is not None and curve_of(place, entries) is None:
                raise InputError(f"{entry.path}: {entry.name}: lies on a curve that is not in its folder; put it there")
            cells = ((places[entry.path.parent] / entry.path.name).as_posix(), f"`{entry.name}`", kind_of(entry))
            verdicts = (entry.check.verdict, entry.check.word, f"`{entry.document['digest']}`")
            rows.append(f"| {' | '.join((*cells, *verdicts))} |")
        for path in dict.fromkeys(entry.path for entry in entries):
            lines.append(check_again(entries, path, named))
            place = (places[path.parent] / path.name).as_posix()
            sizes.append(f"| {place} | {path.stat().st_size} | `{digest(path)}` |")
        second += again_by_other_code(entries, named)
    count = sum(map(len, checked.values()))
    return _GUIDE.format(
        version=VERSION, count=count, files=len(lines), sums=SUMS, theorems=", ".join(f"`{name}`" for name in theorems),
        lines="\n".join(f"    {line}" for line in lines), second="\n".join(f"    {line}" for line in second),
        rows="\n".join(rows), sizes="\n".join(sizes),
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
    places = places_of(list(files))
    checked = {folder: check_files(paths, quiet=False) for folder, paths in files.items()}
    with tempfile.TemporaryDirectory() as name:
        draft = Path(name) / "draft"
        told = []
        for folder, paths in files.items():
            (draft / places[folder]).mkdir(parents=True, exist_ok=True)
            for path in paths:
                shutil.copy(path, draft / places[folder])
            stem = "-".join((THEOREMS, *places[folder].parts[1:]))
            told += [f"{stem}.html", f"{stem}.md"]
            outputs = [word for made in told[-2:] for word in ("-o", str(draft / made))]
            words = [*map(str, paths), *([] if pictures else ["--no-pictures"]), *outputs, "--quiet"]
            with contextlib.redirect_stdout(io.StringIO()):
                code = report(words)
            if code == 2:
                raise InputError("the theorems cannot be told; see above")
        (draft / GUIDE).write_text(guide(checked, places, told), "utf-8")
        inside = sorted(path for path in draft.rglob("*") if path.is_file())
        sums = [f"{digest(path)}  {path.relative_to(draft).as_posix()}\n" for path in inside]
        (draft / SUMS).write_text("".join(sums), "utf-8")
        target.mkdir(parents=True, exist_ok=True)
        packed = target / f"orbitproof-{VERSION}-certificates.tar.gz"
        pack(draft, packed)
        shutil.rmtree(target / "content", ignore_errors=True)
        shutil.copytree(draft, target / "content")
    everything = [path for paths in files.values() for path in paths]
    total, entries = (
        sum(path.stat().st_size for path in everything),
        [each for found in checked.values() for each in found],
    )
    print(f"{len(entries)} certificates in {len(everything)} files, {total} bytes: {target / 'content' / GUIDE}")
    print(f"{packed}: {packed.stat().st_size} bytes, SHA-256 {digest(packed)}")
    return entries


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
