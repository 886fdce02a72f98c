"""Well-formed claims with unusual numbers: each is bad input or not proved, and none ends in a traceback."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from support.claims import known

from orbitproof.shared import InputError
from orbitproof.shared.formats import candidate_from_json, candidate_to_json, read_candidates, write_candidates
from orbitproof.verify.__main__ import main

MANY = "7" * 4000


def entry(name: str, **changes: Any) -> dict[str, Any]:
    return {**candidate_to_json(known(name)), **changes}


def run(tmp_path: Path, claim: dict[str, Any]) -> tuple[int, Path]:
    """Exit code of the verifier for one claim, and where its certificate is."""
    source, target = tmp_path / "candidates.json", tmp_path / "certificates.json"
    source.write_text(json.dumps({"format": "orbitproof-candidates", "version": 1, "candidates": [claim]}))
    return main(
        [
            str(source),
            "-o",
            str(target),
            "--quiet",
            "--max-precision",
            "192",
            "--row-timeout",
            "3",
            "--other-boxes",
            "0",
        ]
    ), target


UNUSUAL: dict[str, dict[str, Any]] = {
    "huge centre": entry("fs2", centre=["1e300", "1e300"]),
    "centre beyond floats": entry("fs2", centre=["1e400", "1"]),
    "centre at a rest point": entry("fs2", centre=["0", "0"]),
    "huge frame": entry("fs2", frame=[["1", "0"], ["0", f"{MANY}"]]),
    "tiny frame": entry("fs2", frame=[["1", "0"], ["0", "1e-3000"]]),
    "nearly singular frame": entry("fs2", frame=[["1", "0"], ["0", "1e-300"]], radii=["0x1p-91", "1e280"]),
    "huge kernel frame": entry("fs2", kernel_frame=[["1e3000"]]),
    "tiny kernel frame": entry("fs2", kernel_frame=[["1e-1000"]]),
    "huge radii": entry("fs2", radii=["1e300", "1e300"]),
    "one tiny radius": entry("fs2", radii=["1e-300", "1e-17"]),
    "other tiny radius": entry("fs2", radii=["1e-27", "1e-300"]),
    "most crossings": entry("fs2", k=1000),
    "three-body, huge radii": entry("em2", radii=["1e300", "1e300", "1e300"]),
    "at the smaller primary": entry(
        "em1", parameters={"mu": "0x1p-4"}, centre=["0.9375", "0", "0"],
        frame=[["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]],
    ),
    "at rest between the primaries": entry("em1", centre=["0", "0", "0"]),
    "a mass parameter next to nothing": entry("em1", parameters={"mu": "1e-300"}),
}  # fmt: skip


@pytest.mark.parametrize("name", UNUSUAL)
def test_unusual_numbers_are_not_proved(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, target = run(tmp_path, UNUSUAL[name])
    assert code == 1
    (certificate,) = json.loads(target.read_text())["certificates"]
    assert certificate["verdict"] == "not proved"
    assert certificate["reason"]["message"]
    assert "not proved" in capsys.readouterr().out


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "mass beyond floats": (entry("em1", parameters={"mu": "1e5000"}), "parameters.mu"),
    "negative mass beyond floats": (entry("em1", parameters={"mu": "-1e99999"}), "parameters.mu"),
    "number that grows too long": (entry("fs2", radii=["1e99999", "1"]), "radii"),
    "exponent that grows too long": (entry("fs2", radii=["1.5e-99999", "1"]), "radii"),
    "binary exponent that grows too long": (entry("fs2", centre=["0x10p999999", "1"]), "centre"),
    "too many digits": (entry("fs2", frame=[["1", "0"], [f"{MANY}.{MANY}", "1"]]), "frame"),
    "half of a character": (entry("fs2", id="\ud800"), "id"),
    "control sequence": (entry("fs2", id="a\x1b[31m"), "id"),
    "two lines": (entry("fs2", id="a\nb"), "id"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_could_not_be_written_again_is_bad_input(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    claim, field = REFUSED[name]
    code, target = run(tmp_path, claim)
    errors = capsys.readouterr().err
    assert code == 2
    assert not target.exists()
    assert len(errors.splitlines()) == 1
    assert f".{field}" in errors
    assert len(errors) < 400


@pytest.mark.parametrize("text", ["1e4000", "1e-99999", f"0.{MANY}", MANY, "0x1p-999999", f"-0x{'f' * 4000}p-999999"])
def test_a_number_that_is_accepted_is_written_and_read_again(text: str, tmp_path: Path) -> None:
    claim = candidate_from_json(entry("fs2", centre=[text, "0"]), "test")
    path = tmp_path / "candidates.json"
    write_candidates(path, [claim])
    assert read_candidates(path)[0].centre == claim.centre


def test_the_test_of_numbers_can_fail() -> None:
    with pytest.raises(InputError, match="too long"):
        candidate_from_json(entry("fs2", centre=["1e7000", "0"]), "test")
