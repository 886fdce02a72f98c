"""Bad certificates, bad published files and bad options for tables: one line, exit code 2, nothing written."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.refusals import refused
from support.table_rows import CANDIDATES, CERTIFICATES, certificates

from orbitproof.figures.__main__ import main
from orbitproof.figures.tables import default_published, read_rows
from orbitproof.shared import InputError


def change_ball(key: str, value: Callable[[str], str]) -> Callable[[list[Any]], None]:
    """Change mid or rad of the parameter of the third Earth-Moon row, whose radius is visible in its decimal."""

    def change(entries: list[Any]) -> None:
        entry = next(entry for entry in entries if entry["id"] == "earth-moon-L1-halo-k3-2")
        ball = entry["results"]["parameter"]
        ball[key] = value(ball[key])

    return change


def in_first(*path: str, value: Any) -> Callable[[list[Any]], None]:
    def change(entries: list[Any]) -> None:
        target = entries[0]
        for key in path[:-1]:
            target = target[key]
        target[path[-1]] = value

    return change


BAD_CERTIFICATES: dict[str, tuple[Callable[[list[Any]], list[Any] | None], str]] = {
    "midpoint moved": (change_ball("mid", lambda text: text.replace("p", "1p", 1)), "do not agree"),
    "another sign": (change_ball("mid", lambda text: f"-{text}"), "do not agree"),
    "radius made zero": (change_ball("rad", lambda text: "0x0"), "do not agree"),
    "radius made larger": (change_ball("rad", lambda text: text.replace("p-1", "p-", 1)), "do not agree"),
    "absurd size": (change_ball("rad", lambda text: "0x1p999999"), "size"),
    "negative radius": (change_ball("rad", lambda text: f"-{text}"), "radius"),
    "NaN midpoint": (change_ball("mid", lambda text: "nan"), "mid"),
    "NaN radius": (change_ball("rad", lambda text: float("nan")), "NaN"),  # type: ignore[arg-type, return-value]
    "infinite radius": (change_ball("rad", lambda text: "inf"), "rad"),
    "decimal that is no interval": (change_ball("decimal", lambda text: "[nan, nan]"), "do not agree"),
    "decimal of another number": (change_ball("decimal", lambda text: "[3.0216, 3.0217]"), "do not agree"),
    "id that the statement does not have": (in_first("id", value="other"), "id"),
    "statement of nothing": (in_first("statement", "candidate", value={}), "statement.candidate"),
    "unknown system": (in_first("statement", "candidate", "system", value="pendulum"), "pendulum"),
    "parameter of another system": (in_first("results", "parameter_name", value="energy"), "results"),
    "coordinate missing": (in_first("results", "point", value={}), "results"),
    "infinite time": (in_first("computation", "seconds", value=-1), "seconds"),
    "same certificate twice": (lambda entries: [entries[0], entries[0]], "twice"),
    "no certificate": (lambda entries: [], "certificates"),
}


@pytest.mark.parametrize("case", BAD_CERTIFICATES)
def test_certificates_that_were_changed_are_refused(case: str, tmp_path: Path, capsys: Any) -> None:
    change, word = BAD_CERTIFICATES[case]
    path = certificates(tmp_path / "certificates.json", change)
    message = refused(main, ["tables", str(path), "-o", str(tmp_path / "out")], capsys)
    assert word in message
    assert str(path) in message
    assert len(message) < 500
    assert not (tmp_path / "out").exists()


def published_with(**entries: Any) -> str:
    document = json.loads(default_published().read_text())
    document["lists"][0].update(entries)
    return json.dumps(document)


BAD_PUBLISHED = {
    "not JSON": ("published: none", "not valid JSON"),
    "other format": (json.dumps({**json.loads(default_published().read_text()), "format": "x"}), "format"),
    "unknown key": (published_with(comment="x"), "comment"),
    "unknown system": (published_with(system="pendulum"), "pendulum"),
    "no mass": (published_with(parameters={}), "mu"),
    "mass as a float": (published_with(parameters={"mu": 0.01}), "mu"),
    "other parameter": (published_with(parameter_name="energy"), "Jacobi constant"),
    "NaN": (published_with(rows=[{"j": 0, "k": 1, "parameter": "nan"}]), "rows[0].parameter"),
    "NaN as a number": (published_with(rows=[{"j": 0, "k": 1, "parameter": float("nan")}]), "NaN"),
    "ends exchanged": (published_with(rows=[{"j": 0, "k": 1, "parameter": "[3, 2]"}]), "rows[0].parameter"),
    "unknown coordinate": (
        published_with(rows=[{"j": 0, "k": 1, "parameter": "[2, 3]", "point": {"w": "[1, 2]"}}]),
        "'w'",
    ),
    "k = 0": (published_with(rows=[{"j": 0, "k": 0, "parameter": "[2, 3]"}]), "rows[0].k"),
}


@pytest.mark.parametrize("case", BAD_PUBLISHED)
def test_bad_published_files_are_refused(case: str, tmp_path: Path, capsys: Any) -> None:
    text, word = BAD_PUBLISHED[case]
    path = tmp_path / "published.json"
    path.write_text(text)
    message = refused(main, ["tables", str(CERTIFICATES), "--published", str(path)], capsys)
    assert word in message
    assert str(path) in message


def test_a_certificate_in_two_files_and_a_candidate_of_another_claim_are_refused(tmp_path: Path, capsys: Any) -> None:
    again = certificates(tmp_path / "again.json", lambda entries: entries[:1])
    assert "as well" in refused(main, ["tables", str(CERTIFICATES), str(again)], capsys)
    document = json.loads(CANDIDATES.read_text())
    document["candidates"][0]["radii"][0] = "1"
    path = tmp_path / "candidates.json"
    path.write_text(json.dumps(document))
    assert "differs from" in refused(main, ["tables", str(CERTIFICATES), "--candidates", str(path)], capsys)


@pytest.mark.parametrize(
    "options", [["--digits", "0"], ["--digits", "nan"], ["--digits", "9" * 6000], ["--sources", "x"]]
)
def test_bad_options_are_refused(options: list[str], capsys: Any) -> None:
    assert "--help" in refused(main, ["tables", str(CERTIFICATES), *options], capsys)


def test_a_folder_that_cannot_be_made_is_refused_before_anything_is_written(tmp_path: Path, capsys: Any) -> None:
    (tmp_path / "file").write_text("")
    for folder in (tmp_path / "file", tmp_path / "file" / "below"):
        assert str(folder) in refused(main, ["tables", str(CERTIFICATES), "-o", str(folder)], capsys)
    with pytest.raises(InputError, match="cannot be read"):
        read_rows([tmp_path / "absent.json"])
