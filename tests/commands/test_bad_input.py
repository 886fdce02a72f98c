"""Bad input to each command line: exit code 2, one line on stderr that says where and what to do, nothing written."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from support.claims import PUBLISHED_POINTS
from support.refusals import refused

from orbitproof.shared.formats import InputError, check_writable

CANDIDATE: dict[str, Any] = {
    "id": "falkner-skan k=3",
    "system": "falkner-skan",
    "parameters": {},
    "kind": "touch_and_go",
    "k": 3,
    "symmetry": None,
    "centre": list(PUBLISHED_POINTS[3]),
    "frame": [["1", "0"], ["3.699900e-7", "1"]],
    "kernel_frame": [["1"]],
    "radii": ["1e-12", "1e-14"],
}
DOCUMENT: dict[str, Any] = {"format": "orbitproof-candidates", "version": 1, "candidates": [CANDIDATE]}

Main = Callable[[list[str]], int]


def changed(**entries: Any) -> str:
    """The document with keys of its candidate replaced."""
    document = copy.deepcopy(DOCUMENT)
    document["candidates"][0].update(entries)
    return json.dumps(document)


def document(**entries: Any) -> str:
    """The document with top-level keys replaced."""
    return json.dumps({**DOCUMENT, **entries})


CR3BP = {
    "system": "cr3bp",
    "centre": ["0.82", "0.1", "0.2"],
    "frame": [["1", "0", "0"], ["0", "1", "0"], ["0", "0", "1"]],
    "kernel_frame": [["1", "0"], ["0", "1"]],
    "radii": ["1e-12", "1e-12", "1e-12"],
}

# What is wrong, the text of the file, and a word that the message has to contain.
CANDIDATE_FILES: dict[str, tuple[str, str]] = {
    "empty file": ("", "not valid JSON"),
    "not JSON": ("candidates: none", "not valid JSON"),
    "truncated": (json.dumps(DOCUMENT)[:-30], "truncated"),
    "a list": ("[]", "the document"),
    "deeply nested": ("[" * 100_000, "candidates"),
    "unknown key": (document(comment="mine"), "comment"),
    "unknown key in a candidate": (changed(radius="1"), "radius"),
    "missing key": (json.dumps({"format": "orbitproof-candidates", "version": 1}), "candidates"),
    "key twice": ('{"format": "orbitproof-candidates", "format": "orbitproof-candidates"}', "format"),
    "wrong version": (document(version=2), "version"),
    "another format": (document(format="orbitproof-certificates"), "format"),
    "no candidates": (document(candidates=[]), "candidates"),
    "id twice": (document(candidates=[CANDIDATE, CANDIDATE]), "candidates[1].id"),
    "NaN": (changed(centre=[float("nan"), "0.9"]), "NaN"),
    "infinity": (changed(radii=[float("inf"), "1e-14"]), "Infinity"),
    "NaN as text": (changed(centre=["nan", "0.9"]), "centre[0]"),
    "a float where an exact number belongs": (changed(centre=[453.4, "0.9"]), "centre[0]"),
    "negative radius": (changed(radii=["1e-12", "-1e-14"]), "radii[1]"),
    "zero radius": (changed(radii=["0", "1e-14"]), "radii[0]"),
    "k = 0": (changed(k=0), ".k"),
    "k negative": (changed(k=-2), ".k"),
    "k = 1 with touch-and-go": (changed(k=1), ".k"),
    "k not an integer": (changed(k=2.5), ".k"),
    "unknown kind": (changed(kind="pitchfork"), "kind"),
    "unknown system": (changed(system="pendulum"), "pendulum"),
    "unknown symmetry": (changed(kind="symmetry_breaking", k=1, symmetry="T"), "symmetry"),
    "parameter that the system does not have": (changed(parameters={"mu": "0.01"}), "parameters"),
    "no mass": (changed(**CR3BP, parameters={}), "mu"),
    "mass 0": (changed(**CR3BP, parameters={"mu": "0"}), "parameters.mu"),
    "mass 1": (changed(**CR3BP, parameters={"mu": "1"}), "parameters.mu"),
    "mass negative": (changed(**CR3BP, parameters={"mu": "-0.1"}), "parameters.mu"),
    "mass above 1": (changed(**CR3BP, parameters={"mu": "0x3p-1"}), "parameters.mu"),
    "centre too short": (changed(centre=["453.4"]), "centre"),
    "frame not square": (changed(frame=[["1", "0"]]), "frame"),
    "kernel frame of wrong size": (changed(kernel_frame=[["1", "0"], ["0", "1"]]), "kernel_frame"),
}


def verify_main(arguments: list[str]) -> int:
    from orbitproof.verify.__main__ import main

    return main(arguments)


def figures_main(arguments: list[str]) -> int:
    from orbitproof.figures.__main__ import main

    return main(arguments)


def explore_main(arguments: list[str]) -> int:
    from orbitproof.explore.__main__ import main

    return main(arguments)


def verify_arguments(candidates: Path, output: Path) -> list[str]:
    return [str(candidates), "-o", str(output)]


def figures_arguments(candidates: Path, output: Path) -> list[str]:
    return ["family", str(candidates), "-o", str(output)]


READERS = pytest.mark.parametrize(
    ("main", "arguments"),
    [(verify_main, verify_arguments), (figures_main, figures_arguments)],
    ids=["verify", "figures"],
)


@READERS
@pytest.mark.parametrize("case", CANDIDATE_FILES)
def test_bad_candidates_file_is_refused_in_one_line_and_nothing_is_written(
    case: str, main: Main, arguments: Callable[[Path, Path], list[str]], tmp_path: Path, capsys: Any
) -> None:
    text, word = CANDIDATE_FILES[case]
    path = tmp_path / "candidates.json"
    path.write_text(text)
    message = refused(main, arguments(path, tmp_path / "result"), capsys)
    assert str(path) in message
    assert word in message
    assert list(tmp_path.iterdir()) == [path]


@READERS
def test_missing_candidates_file_is_refused(
    main: Main, arguments: Callable[[Path, Path], list[str]], tmp_path: Path, capsys: Any
) -> None:
    message = refused(main, arguments(tmp_path / "none.json", tmp_path / "result"), capsys)
    assert "none.json" in message
    assert "cannot be read" in message
    assert list(tmp_path.iterdir()) == []


@READERS
def test_folder_or_binary_in_place_of_a_candidates_file_is_refused(
    main: Main, arguments: Callable[[Path, Path], list[str]], tmp_path: Path, capsys: Any
) -> None:
    assert "cannot be read" in refused(main, arguments(tmp_path, tmp_path / "result"), capsys)
    binary = tmp_path / "candidates.json"
    binary.write_bytes(b"\xff\xfe\x00\x01")
    assert "not a text file" in refused(main, arguments(binary, tmp_path / "result"), capsys)


def unwritable_paths(tmp_path: Path) -> list[Path]:
    """Paths at which no file can be written, whoever runs the tests."""
    (tmp_path / "a file").write_text("kept")
    (tmp_path / "a folder").mkdir()
    return [tmp_path / "a file" / "result.json", tmp_path / "a folder", tmp_path / "absent" / "result.json"]


def test_verify_refuses_an_output_path_that_cannot_be_written_before_it_computes(tmp_path: Path, capsys: Any) -> None:
    candidates = tmp_path / "candidates.json"
    candidates.write_text(json.dumps(DOCUMENT))
    for path in unwritable_paths(tmp_path):
        assert str(path) in refused(verify_main, verify_arguments(candidates, path), capsys)
    assert (tmp_path / "a file").read_text() == "kept"


def test_figures_refuses_a_folder_that_cannot_be_created(tmp_path: Path, capsys: Any) -> None:
    candidates = tmp_path / "candidates.json"
    candidates.write_text(json.dumps(DOCUMENT))
    (tmp_path / "a file").write_text("kept")
    for path in (tmp_path / "a file", tmp_path / "a file" / "pictures"):
        assert str(path) in refused(figures_main, figures_arguments(candidates, path), capsys)
    assert (tmp_path / "a file").read_text() == "kept"


@pytest.mark.parametrize("text", ["", "{", "[]", document(), '{"format": "orbitproof-certificates", "version": 9}'])
def test_figures_refuses_bad_certificates_and_bad_family_files(text: str, tmp_path: Path, capsys: Any) -> None:
    candidates, bad = tmp_path / "candidates.json", tmp_path / "bad.json"
    candidates.write_text(json.dumps(DOCUMENT))
    bad.write_text(text)
    output = ["-o", str(tmp_path / "pictures")]
    assert str(bad) in refused(figures_main, ["family", str(candidates), str(bad), *output], capsys)
    assert str(bad) in refused(figures_main, ["family", str(candidates), "--family", str(bad), *output], capsys)
    assert not (tmp_path / "pictures").exists()


SEARCH = ["candidates", "--system", "cr3bp", "--family", "L1-halo", "-k", "2"]
EXPLORE_ARGUMENTS: dict[str, tuple[list[str], str]] = {
    "unknown system": (["candidates", "--system", "pendulum", "-k", "2"], "pendulum"),
    "unknown family": (["candidates", "--system", "cr3bp", "--mass", "earth-moon", "--family", "L9", "-k", "2"], "L9"),
    "family of another system": ([*SEARCH[:3], "--mass", "earth-moon", "--family", "L1-axial"], "--system cr3bp-axial"),
    "families of two systems": (["candidates", "--mass", "earth-moon", "--family", "L1-halo", "L1-axial"], "--system"),
    "unknown mass": ([*SEARCH, "--mass", "earth"], "earth"),
    "mass 0": ([*SEARCH, "--mass", "0"], "mass"),
    "mass 1": ([*SEARCH, "--mass", "1"], "mass"),
    "mass negative": ([*SEARCH, "--mass=-0.1"], "mass"),
    "mass above 1": ([*SEARCH, "--mass", "1.5"], "mass"),
    "mass NaN": ([*SEARCH, "--mass", "nan"], "mass"),
    "mass infinite": ([*SEARCH, "--mass", "inf"], "mass"),
    "k = 0": (["candidates", "--system", "falkner-skan", "-k", "0"], "-k"),
    "k negative": (["candidates", "--system", "falkner-skan", "-k", "-3"], "-k"),
    "k not a number": (["candidates", "--system", "falkner-skan", "-k", "two"], "two"),
    "digits not positive": (["candidates", "--system", "falkner-skan", "-k", "2", "--digits", "0"], "digits"),
    "unknown option": (["candidates", "--system", "falkner-skan", "--speed", "9"], "--speed"),
}


@pytest.mark.parametrize("case", EXPLORE_ARGUMENTS)
def test_explore_refuses_bad_arguments_in_one_line(case: str, tmp_path: Path, capsys: Any) -> None:
    arguments, word = EXPLORE_ARGUMENTS[case]
    message = refused(explore_main, [*arguments, "-o", str(tmp_path / "candidates.json")], capsys)
    assert word in message
    assert list(tmp_path.iterdir()) == []


def test_explore_refuses_an_output_path_that_cannot_be_written_before_it_computes(tmp_path: Path, capsys: Any) -> None:
    arguments = ["candidates", "--system", "falkner-skan", "-k", "2"]
    for path in unwritable_paths(tmp_path):
        assert str(path) in refused(explore_main, [*arguments, "-o", str(path)], capsys)
        family = [*arguments, "-o", str(tmp_path / "c.json"), "--family-output", str(path)]
        assert str(path) in refused(explore_main, family, capsys)
    assert not (tmp_path / "c.json").exists()


@pytest.mark.parametrize("text", ["", "{", "[]", document(), '{"format": "orbitproof-family", "version": 99}'])
def test_explore_refuses_a_bad_family_file(text: str, tmp_path: Path, capsys: Any) -> None:
    family = tmp_path / "family.json"
    family.write_text(text)
    arguments = ["candidates", "--system", "falkner-skan", "-k", "2", "--from-family", str(family)]
    assert str(family) in refused(explore_main, [*arguments, "-o", str(tmp_path / "c.json")], capsys)
    assert list(tmp_path.iterdir()) == [family]


@pytest.mark.parametrize("main", [explore_main, verify_main, figures_main])
def test_a_command_without_arguments_says_so_in_one_line(main: Main, capsys: Any) -> None:
    assert "--help" in refused(main, [], capsys)


def test_writable_path_is_not_refused(tmp_path: Path) -> None:
    check_writable(tmp_path / "new.json")
    with pytest.raises(InputError, match="is a folder"):
        check_writable(tmp_path)


HOPELESS: dict[str, dict[str, Any]] = {
    "box far too large": {"radii": ["1", "1"]},
    "box shifted off the family": {"centre": ["453.4", "0.93"]},
    "singular frame": {"frame": [["1", "0"], ["0", "0"]]},
    "starts in the primary": {**CR3BP, "parameters": {"mu": "0x1p-1"}, "centre": ["0x1p-1", "0", "0"]},
    "falls into the primary": {**CR3BP, "parameters": {"mu": "0x1p-1"}, "centre": ["0.7", "0", "0.001"]},
    "box reaches over the primary": {
        **CR3BP, "parameters": {"mu": "0x1p-1"}, "centre": ["0.51", "0", "1"], "radii": ["0.1", "0.1", "0.1"],
    },
}  # fmt: skip


@pytest.mark.parametrize("case", HOPELESS)
def test_well_formed_hopeless_claim_is_not_proved_with_a_reason(case: str, tmp_path: Path, capsys: Any) -> None:
    candidates, certificates = tmp_path / "candidates.json", tmp_path / "certificates.json"
    candidates.write_text(changed(**HOPELESS[case]))
    words = ["--quiet", "--row-timeout", "5", "--other-boxes", "0"]
    assert verify_main([str(candidates), "-o", str(certificates), *words]) == 1
    assert "Traceback" not in capsys.readouterr().err
    (certificate,) = json.loads(certificates.read_text())["certificates"]
    assert certificate["verdict"] == "not proved"
    assert all(certificate["reason"].values())


# Every command that reads a file: its words, with FILE in place of the file and OUT in place of what it would write.
READING: dict[str, tuple[Main, str, str]] = {
    "verify": (verify_main, "FILE -o OUT", "candidates"),
    "verify --recheck": (verify_main, "--recheck FILE", "certificates"),
    "verify --recheck --integrate": (verify_main, "--recheck --integrate FILE", "certificates"),
    "verify atlas": (verify_main, "atlas FILE -o OUT", "atlas"),
    "verify atlas --recheck": (verify_main, "atlas --recheck FILE", "atlas-certificate"),
    "explore candidates --from-family": (
        explore_main, "candidates --system falkner-skan -k 2 --from-family FILE -o OUT", "family",
    ),
    "explore candidates --from-catalogue": (
        explore_main, "candidates --from-catalogue FILE -k 2 -o OUT", "catalogue",
    ),
    "explore family --from-family": (explore_main, "family --from-family FILE -o OUT", "family"),
    "explore branches": (explore_main, "branches FILE -o OUT", "candidates"),
    "explore atlas --check": (explore_main, "atlas --check FILE", "atlas"),
    "figures family": (figures_main, "family FILE -o OUT", "candidates"),
    "figures resonances": (figures_main, "resonances FILE -o OUT", "family"),
    "figures tables": (figures_main, "tables FILE -o OUT", "certificates"),
    "figures atlas": (figures_main, "atlas FILE -o OUT", "atlas-certificate"),
}  # fmt: skip
SHAPES: dict[str, str | None] = {
    "missing": None,
    "empty": "",
    "not JSON": "some text",
    "another format": '{"format": "orbitproof-nothing", "version": 1}',
    "no object": "[1, 2]",
    "wrong version": '{"format": "orbitproof-FORMAT", "version": 99}',
}


@pytest.mark.parametrize("command", READING)
@pytest.mark.parametrize("shape", [*SHAPES, "folder"])
def test_no_command_takes_a_bad_file_for_its_own(command: str, shape: str, tmp_path: Path, capsys: Any) -> None:
    main, words, format = READING[command]
    path, output = tmp_path / "file.json", tmp_path / "out"
    if shape == "folder":
        path.mkdir()
    elif (text := SHAPES[shape]) is not None:
        path.write_text(text.replace("FORMAT", format))
    told = refused(main, words.replace("FILE", str(path)).replace("OUT", str(output)).split(), capsys)
    assert str(path) in told
    assert not output.exists()


DATA = Path(__file__).parents[1] / "data"
NAMED: dict[str, tuple[Main, str, str, str]] = {
    "certificates to verify": (verify_main, "FILE", "figures-certificates.json", "orbitproof verify --recheck FILE"),
    "candidates to recheck": (verify_main, "--recheck FILE", "figures-candidates.json", "orbitproof verify FILE"),
    "candidates to verify atlas": (verify_main, "atlas FILE", "figures-candidates.json", "orbitproof verify FILE"),
    "an atlas to recheck": (
        verify_main, "atlas --recheck FILE", "atlas-falkner-skan.json", "orbitproof verify atlas FILE",
    ),
    "a family to verify": (
        verify_main, "FILE", "figures-halo-family.json", "orbitproof explore candidates --from-family FILE",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", NAMED)
def test_a_file_of_another_format_is_named_with_the_command_for_it(case: str, capsys: Any) -> None:
    main, words, name, command = NAMED[case]
    told = refused(main, words.replace("FILE", str(DATA / name)).split(), capsys)
    assert told.endswith(f"with: {command.replace('FILE', str(DATA / name))}\n")


def test_the_name_of_a_mass_in_a_file_is_answered_with_its_value(tmp_path: Path, capsys: Any) -> None:
    path = tmp_path / "candidates.json"
    path.write_text(changed(**CR3BP, parameters={"mu": "earth-moon"}))
    told = refused(verify_main, [str(path)], capsys)
    assert "candidates[0].parameters.mu" in told
    assert '"earth-moon" is the name of a mass parameter; write its value, 0x18e267d713713fp-59' in told
