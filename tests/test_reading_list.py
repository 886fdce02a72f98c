"""What has to be read to believe a theorem (docs/reading_list.py)."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "docs"))

import reading_list  # noqa: E402


@pytest.mark.parametrize("modules", reading_list.CHAPTERS.values())
def test_each_module_comes_after_all_that_it_uses(modules: tuple[str, ...]) -> None:
    listed = reading_list.reading_list(modules)
    assert listed[-1] == modules[-1]
    assert set(modules) <= set(listed)
    assert len(set(listed)) == len(listed) > 5
    for number, name in enumerate(listed):
        path = reading_list.path_of(name)
        assert path is not None
        used = {reading_list.definer(*each) for each in reading_list.imports(path)}
        assert used <= set(listed[:number]), name
        assert name.split(".")[0] in ("shared", "verify")


def test_names_count_for_the_module_that_defines_them() -> None:
    assert reading_list.definer("verify.evidence", "Proved") == "verify.evidence.outcome"
    assert reading_list.definer("verify.evidence", "outcome") == "verify.evidence.outcome"


def test_what_a_theorem_rests_on_is_listed() -> None:
    row, curve, whole = (
        reading_list.reading_list(reading_list.CHAPTERS[name]) for name in ("bifurcation", "curve", "list")
    )
    assert {"verify.flow.step", "verify.newton.interval_newton", "shared.systems.program"} <= set(row)
    assert not any(name.startswith(("verify.curve", "verify.stability")) for name in row)
    assert "verify.curve.piece" in curve
    assert "verify.bifurcation.fold" in set(reading_list.reading_list(reading_list.CHAPTERS["fold"])) - set(row)
    assert set(curve) - {"verify.curve.proved_curve"} < set(whole)
    assert not any(name.startswith(("verify.oracle", "verify.certificate", "verify.words")) for name in (*row, *whole))


def test_relative_imports_are_followed() -> None:
    second = reading_list.reading_list(("verify.second_proof.proof",))
    assert {name.split(".")[1] for name in second} == {"second_proof"}
    assert "verify.second_proof.flow" in second


def test_the_command_says_how_long_the_lists_are(capsys: pytest.CaptureFixture[str]) -> None:
    assert reading_list.main([]) == 0
    *lines, empty, last = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(reading_list.CHAPTERS)
    assert empty == ""
    assert max(int(line.split()[1]) for line in lines) < int(last.split()[2]) < sum(int(s.split()[1]) for s in lines)
    assert reading_list.main(["bifurcation"]) == 0
    *entries, empty, last = capsys.readouterr().out.splitlines()
    assert empty == ""
    total = sum(int(entry.split()[1]) for entry in entries)
    assert last == f"in all {total} lines in {len(entries)} modules"
    assert lines[0].split()[1] == str(total)


@pytest.mark.parametrize(
    ("words", "meant"),
    [("row", "bifurcation"), ("rows", "bifurcation"), ("touch_and_go", "bifurcation"), ("Branches", "curve"),
     ("masses", "surface"), ("stability", "list"), ("second proof", "second-proof"), ("curve", "curve"),
     ("orbits", "orbit"), ("newton", "verify.newton"), ("verify.curve.tube", "verify.curve.tube"), ("no", "no")],
)  # fmt: skip
def test_a_chapter_has_the_names_that_the_project_uses(words: str, meant: str) -> None:
    assert reading_list.chapter_of(words) == meant


def test_every_other_word_is_that_of_one_chapter() -> None:
    assert list(reading_list.OTHER_WORDS) == list(reading_list.CHAPTERS)
    words = [word for others in reading_list.OTHER_WORDS.values() for word in others]
    assert len(set(words)) == len(words)
    assert not set(words) & set(reading_list.CHAPTERS)


def test_an_unknown_chapter_is_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    assert reading_list.main(["nothing"]) == 2
    assert "'nothing'" in capsys.readouterr().err
