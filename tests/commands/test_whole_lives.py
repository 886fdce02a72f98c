"""Whole lives from a command to theorems: those of the document on Hopf points, found, proved and drawn."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from orbitproof.explore.__main__ import main as explore
from orbitproof.figures.__main__ import main as figures
from orbitproof.verify.__main__ import main as verify

pytestmark = pytest.mark.slow

DOCUMENT = Path(__file__).resolve().parents[2] / "docs" / "how-to" / "where-orbits-are-born.md"
MAINS = {"explore": explore, "verify": verify, "figures": figures}
PROVED = {
    "reactor": {
        "hopf-1": "0.2231301601484298289332804707640",
        "hopf-2": "0.4104249931194939758476433723357",
        "fold-1": "0.220247466744080780",
    },
    "lure": {
        "hopf-1": "alpha = [0.9999999999999999999",
        "doubling-1": "0.630302006159624",
        "doubling-2": "0.579629840895586",
    },
    "lorenz": {"hopf-1": "24.7368421052631578947368421052631"},
}
"""exp(-3/2), 5 exp(-5/2), 470/19, and values that other programs find."""


def written_in_the_document() -> list[list[str]]:
    """Its commands, each with what follows it, when its files are written."""
    text = DOCUMENT.read_text("utf-8")
    for file, source in re.findall(r"^```(?:python|json) ([\w.-]+)\n(.*?)^```", text, re.MULTILINE | re.DOTALL):
        Path(file).write_text(source)
    return [line.split(maxsplit=2)[1:] for line in re.findall(r"^orbitproof .*$", text, re.MULTILINE)]


@pytest.mark.parametrize("name", PROVED)
def test_the_commands_of_the_document_find_and_prove_a_whole_life(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    commands = written_in_the_document()
    begin = next(i for i, (_, words) in enumerate(commands) if f"--system {name}.py" in words and "--cycles" in words)
    for command, words in commands[begin : begin + (3 if name == "reactor" else 2)]:
        capsys.readouterr()
        assert MAINS[command](shlex.split(words)) == 0
        said = capsys.readouterr().out
        if command == "verify":
            blocks = dict(re.findall(rf"^{name}-([\w-]+): (proved.*\n(?:  .*\n)*)", said, re.MULTILINE))
            assert set(blocks) == set(PROVED[name])
            for each, value in PROVED[name].items():
                assert value in " ".join(blocks[each].split()), each


@pytest.mark.parametrize(
    ("name", "wanted"),
    {
        "brusselator": ["It begins at A_parameter = [1.7320508075"],
        "neuron": ["[0.4797924167", "has at least one extremum: a minimum"],
    }.items(),
)
def test_the_commands_of_the_document_prove_a_birth(
    name: str, wanted: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the square root of 3, and with a fold."""
    monkeypatch.chdir(tmp_path)
    commands = written_in_the_document()
    begin = next(i for i, (_, words) in enumerate(commands) if f"--system {name}.py" in words and "--births" in words)
    for command, words in commands[begin : begin + 2]:
        assert MAINS[command](shlex.split(words)) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert "PROVED" in said
    assert all(each in said for each in wanted)
    assert "a speed that is not 0, as Hopf's theorem takes it" in said


@pytest.mark.parametrize(
    ("name", "wanted"),
    {
        "neuron": [
            "I in [0.47979241",
            "those on one side have 2 eigenvalues with negative",
            "a minimum between a point",
        ],
        "lure": ["alpha in [0.99999999", "those on one side have 3 eigenvalues with negative"],
        "brusselator": ["A_parameter in [1.73205080756", "those on one side have 2 eigenvalues with negative"],
    }.items(),
)
def test_the_commands_of_the_document_join_equilibria_and_orbits(
    name: str, wanted: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Curve of equilibria, curve of orbits, and both as one graph, which is checked again."""
    monkeypatch.chdir(tmp_path)
    for command, words in written_in_the_document():
        if name not in words or "--cycles" in words or "claims" in words or words.startswith("periodic"):
            continue
        capsys.readouterr()
        assert MAINS[command](shlex.split(words)) == 0, words
    said = " ".join(capsys.readouterr().out.split())
    assert f"- begins on {name}-equilibria, on piece" in said
    assert "are joined by a path of equilibria and periodic orbits of these arcs" in said
    assert all(each in said for each in wanted)
    given = [f"{name}-equilibria-certificate.json", f"{name}{'' if name == 'neuron' else '-births'}-certificate.json"]
    assert verify(["--recheck", f"{name}-life-certificate.json", "--certificates", *given, "--quiet"]) == 0
