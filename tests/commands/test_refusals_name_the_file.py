"""What `verify web`, `index`, `catalogue` and `--second-proof` say of a file that is wrong names that file."""

from __future__ import annotations

import json
import random
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest
from support import periodic_curves
from support.forgeries import atlas_certificate, of_parabola
from support.joined import DATA, retrograde_curve, write_catalogue, write_indexed_web, write_web

from orbitproof.shared.claims.web import PASSES
from orbitproof.shared.processes import Failure
from orbitproof.verify.__main__ import main
from orbitproof.verify.branches import conclusion_of, make_atlas_certificate
from orbitproof.verify.certificate import digest
from orbitproof.verify.run import branch_checks, checking_again, proof_command, second_proofs, web_command

Place = tuple[str | int, ...]
Change = Callable[[Any], object]
COMMANDS: dict[str, tuple[str, ...]] = {
    "web": ("web", "claim.json", "--certificates", "dro.json", "dro-index.json", "rows.json"),
    "web --recheck": ("web", "--recheck", "web.json", "--certificates", "dro.json", "dro-index.json"),
    "index": ("index", "--curve", "dro.json"),
    "index --recheck": ("index", "--recheck", "dro-index.json", "--curve", "dro.json"),
    "catalogue": ("catalogue", "halo.json", "--curve", "halo-curve.json"),
    "catalogue --rows": ("catalogue", "--rows", "3", "--curve", "halo-curve.json"),
    "catalogue --recheck": ("catalogue", "--recheck", "halo-rows.json", "--curve", "halo-curve.json"),
    "--second-proof": ("--second-proof", "certificates.json"),
}
CLAIM = {
    "format": "orbitproof-web", "version": 1, "id": "w", "title": "a web",
    "arcs": [{"id": "dro", "index": True, "meets": [{"vertex": "near", "how": PASSES}]}],
}  # fmt: skip


@pytest.fixture(scope="module")
def stored(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The files that the commands take, as JSON, by their names."""
    found = {}
    for write, names in (
        (write_web, ("rows.json", None, None)),
        (write_indexed_web, ("dro.json", "dro-index.json", "web.json")),
        (write_catalogue, ("halo-curve.json", "halo-rows.json")),
    ):
        paths = write(tmp_path_factory.mktemp("stored"))
        found |= {name: json.loads(path.read_text()) for name, path in zip(names, paths, strict=True) if name}
    found["claim.json"] = json.loads(json.dumps(CLAIM))
    found["halo.json"] = json.loads((DATA / "catalogue-halo.json").read_text())
    found["certificates.json"] = json.loads((DATA / "figures-certificates.json").read_text())
    return found


def written(stored: Mapping[str, Any], folder: Path) -> None:
    for name, document in stored.items():
        (folder / name).write_text(json.dumps(document))


def done(command: str, folder: Path) -> int:
    words = [str(folder / word) if word.endswith(".json") else word for word in COMMANDS[command]]
    try:
        return main([*words, "--quiet"])
    except SystemExit as end:
        return int(end.code or 0)


def is_one_line_about(errors: str, path: Path) -> bool:
    return str(path) in errors and errors.startswith("error: ") and errors.count("\n") == 1


@pytest.fixture(autouse=True)
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """What has a process of its own is done in this one."""

    def apart(work: Callable[..., Any], name: str, arguments: tuple[Any, ...], limits: object) -> Any:
        try:
            return work(*arguments)
        except Exception as error:
            return Failure("process", repr(error), error)

    for module in (branch_checks, proof_command, second_proofs, web_command):
        monkeypatch.setattr(module, "apart", apart)


def at(*place: str | int) -> Callable[[Any, Any], None]:
    """Puts a value at a place of a document."""

    def put(document: Any, value: Any) -> None:
        for key in place[:-1]:
            document = document[key]
        document[place[-1]] = value

    return put


def named(document: Any, name: str) -> Any:
    """The certificate of a curve, of that name."""
    at("id")(document, name)
    at("statement", "atlas", "id")(document, name)
    return document


def unfinished(document: Any) -> Any:
    curve = retrograde_curve()
    return json.loads(json.dumps(make_atlas_certificate(curve.atlas, curve.results, None)))


def planar(document: Any) -> Any:
    return json.loads(json.dumps(retrograde_curve().document))


def periodic(document: Any) -> Any:
    """Of a curve of periodic orbits without symmetry, by the name of the arc."""
    atlas, results = periodic_curves.closed_atlas()
    conclusion = conclusion_of(atlas, results, [], lambda entries: [], None)
    return named(json.loads(json.dumps(make_atlas_certificate(atlas, results, conclusion))), "dro")


def foreign(document: Any) -> Any:
    """Of a curve of another system."""
    return json.loads(json.dumps(atlas_certificate(*of_parabola())))


def put(*place: str | int, value: Any) -> Change:
    return lambda document: at(*place)(document, value)


def twice(*place: str | int) -> Change:
    def change(document: Any) -> None:
        for key in place:
            document = document[key]
        document.append(document[0])

    return change


def point_called(name: str) -> Change:
    def change(document: Any) -> None:
        at("certificates", 0, "id")(document, name)
        at("certificates", 0, "statement", "candidate", "id")(document, name)

    return change


REFUSED: list[tuple[str, str, Change, str]] = [
    ("web", "claim.json", put("arcs", value=[]), "needs at least 1"),
    ("web", "claim.json", twice("arcs"), "each arc once"),
    ("web", "claim.json", twice("arcs", 0, "meets"), "once how they meet"),
    ("web", "claim.json", put("arcs", 0, "id", value="L1"), "is a libration point"),
    ("web", "claim.json", put("arcs", 0, "id", value="near"), "is a vertex too"),
    ("web", "claim.json", put("arcs", 0, "id", value="absent"), "no such certificate is given"),
    ("web", "dro.json", lambda document: named(document, "L1"), "the name of a libration point"),
    ("web", "dro.json", lambda document: named(document, "near"), "is about a curve"),
    ("web", "dro.json", periodic, "is about no curve of symmetric orbits"),
    ("web", "rows.json", point_called("dro"), "is about one orbit"),
    ("index", "dro.json", periodic, "no index is counted of"),
    ("index", "dro.json", unfinished, "proves no curve"),
    ("index", "dro.json", put("statement", "atlas", "parameters", "mu", value="1/4"), "does not stand"),
    ("catalogue", "halo.json", put("family", value="halo; proved."), "is no title"),
    ("catalogue", "halo.json", put("data", 1, 2, value=None), "is no number"),
    ("catalogue", "halo-curve.json", put("statement", "atlas", "parameters", "mu", value="1/4"), "does not stand"),
    ("catalogue", "halo-curve.json", planar, "another mass"),
    ("catalogue --rows", "halo-curve.json", foreign, "is of no curve in"),
    ("catalogue --rows", "halo-curve.json", unfinished, "proves no curve"),
    (
        "--second-proof", "certificates.json",
        put("certificates", 0, "statement", "candidate", "centre", 0, value="x"), "not an exact number",
    ),
]  # fmt: skip


@pytest.mark.parametrize(("command", "name", "change", "words"), REFUSED, ids=[words for *_, words in REFUSED])
def test_a_file_that_says_what_cannot_be_is_named(
    command: str, name: str, change: Change, words: str, stored: Mapping[str, Any], tmp_path: Path, capsys: Any
) -> None:
    document = deepcopy(stored[name])
    changed = change(document) or document
    if "digest" in changed:
        changed["digest"] = digest(changed)
    written({**stored, name: changed}, tmp_path)
    assert done(command, tmp_path) == 2
    errors = capsys.readouterr().err
    assert words in errors
    assert is_one_line_about(errors, tmp_path / name)


class ReadError(Exception):
    """All files were taken."""


def mutations(document: Any, source: random.Random, number: int) -> Iterator[tuple[Place, Any]]:
    """Copies with one place left out, or with a value of another kind there; each place is as likely."""
    places = sorted(set(_places(document)), key=str)
    for place in source.sample(places, min(number, len(places))):
        copy = deepcopy(document)
        entry = copy
        for key in place[:-1]:
            entry = entry[key]
        value = source.choice(["leave out", None, "x", -1, [], {}])
        if value == "leave out":
            del entry[place[-1]]
        else:
            entry[place[-1]] = value
        yield place, copy


def _places(value: Any, place: Place = ()) -> Iterator[Place]:
    if place:
        yield place
    # Entries of a list are alike.
    entries = value.items() if isinstance(value, dict) else enumerate(value[:1]) if isinstance(value, list) else ()
    for key, entry in entries:
        yield from _places(entry, (*place, key))


@pytest.mark.parametrize(
    ("command", "name"),
    [(command, word) for command, words in COMMANDS.items() for word in words if word.endswith(".json")],
)
def test_a_file_that_is_not_well_formed_is_named(
    command: str, name: str, stored: Mapping[str, Any], tmp_path: Path, capsys: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each file with other changes; those that are no fault of its form are not looked at further."""

    def taken(*arguments: object, **more: object) -> Any:
        raise ReadError

    for module, step in (
        (checking_again, "rechecks"), (proof_command, "examined"), (branch_checks, "check_apart"),
        (second_proofs.Processes, "run"),
    ):  # fmt: skip
        monkeypatch.setattr(module, step, taken)
    written(stored, tmp_path)
    wrong, refused = [], 0
    for place, copy in mutations(stored[name], random.Random(f"{command} {name}"), 24):
        for is_sealed in (False, True) if "digest" in copy else (False,):
            if is_sealed:
                copy["digest"] = digest(copy)
            (tmp_path / name).write_text(json.dumps(copy))
            try:
                code = done(command, tmp_path)
            except ReadError:
                continue
            errors = capsys.readouterr().err
            refused += code == 2
            # A curve of another name is none that the web names.
            is_named = is_one_line_about(errors, tmp_path / name) or "no such certificate is given" in errors
            if code == 2 and not is_named:
                wrong.append(f"{place}: {errors}")
    assert not wrong
    assert refused > 5
