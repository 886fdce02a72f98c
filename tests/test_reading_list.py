"""What has to be read to believe a theorem (docs/reading_list.py)."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import FrameType

import pytest
from support.claims import known

from orbitproof.shared.formats import Candidate
from orbitproof.verify.bifurcation.proved_bifurcation import check_exactly, prove
from orbitproof.verify.evidence import Checklist, Proved, guarded
from orbitproof.verify.oracle import ORACLE
from orbitproof.verify.poincare import PHYSICAL, IntegratorSettings, enclose_iterates

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
    assert "shared.systems.regularised" not in row
    assert "verify.curve.piece" in curve
    assert "verify.bifurcation.fold" in set(reading_list.reading_list(reading_list.CHAPTERS["fold"])) - set(row)
    assert set(curve) - {"verify.curve.proved_curve"} < set(whole)
    assert not any(name.startswith(("verify.oracle", "verify.certificate", "verify.words")) for name in (*row, *whole))


LONGEST = {"bifurcation": 5500, "curve": 7514, "list": 10668}


@pytest.mark.parametrize(("chapter", "longest"), LONGEST.items())
def test_what_has_to_be_read_for_all_claims_of_a_kind_stays_short(chapter: str, longest: int) -> None:
    listed = reading_list.reading_list(reading_list.CHAPTERS[chapter])
    assert 1000 < sum(map(reading_list.length, listed)) <= longest


BEHIND_A_CHECK = {"verify.certificate.rechecking": 9000, "verify.branches.recheck": 11000}


@pytest.mark.parametrize(("module", "longest"), BEHIND_A_CHECK.items())
def test_what_checks_certificates_again_knows_no_kind_of_theorem(module: str, longest: int) -> None:
    listed = reading_list.reading_list((module,))
    assert 5000 < sum(map(reading_list.length, listed)) <= longest
    rooms = {name.split(".")[1] for name in listed if name.startswith("verify.")}
    assert rooms <= {"evidence", "claim", "poincare", "curve", "certificate", "branches"}
    # Of curves it is what an interval is.
    assert {name for name in listed if name.startswith("verify.curve")} <= {"verify.curve.piece_result"}


def entered(work: Callable[[], object]) -> set[str]:
    """The modules of the proof side and of the shared statement of which a function is called."""
    files: set[str] = set()

    def note(frame: FrameType, event: str, _argument: object) -> None:
        if event == "call" and frame.f_code.co_name != "<module>":
            files.add(frame.f_code.co_filename)

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    inside = {path.relative_to(ROOT) for path in map(Path.resolve, map(Path, files)) if path.is_relative_to(ROOT)}
    return {".".join(path.with_suffix("").parts) for path in inside if path.parts[0] in ("shared", "verify")}


def proved_by_the_chapters(candidate: Candidate) -> None:
    checklist, settings = Checklist(), IntegratorSettings(200, coordinates=PHYSICAL)
    check_exactly(checklist, candidate)
    found = enclose_iterates(candidate, settings, ORACLE)
    with guarded(settings.precision):
        outcome = prove(candidate, checklist, found.iterates, found.first_integral, found.return_times)
    assert isinstance(outcome, Proved)


@pytest.mark.parametrize("name", ["fs3", "em1"])
def test_a_row_is_proved_by_the_modules_on_its_list_from_its_system_and_guesses(name: str) -> None:
    listed = set(reading_list.reading_list(reading_list.CHAPTERS["bifurcation"]))
    candidate = known(name)
    used = entered(lambda: proved_by_the_chapters(candidate))
    assert {"verify.flow.step", "verify.bifurcation.conditions", "verify.claim.symmetry"} < used
    system = {"shared.systems.known", "shared.systems.three_body"}
    assert {each for each in used - listed if not each.startswith("verify.oracle.")} <= system


def test_every_door_is_known_and_leads_to_what_no_other_module_of_the_list_imports() -> None:
    doors = {
        reading_list.definer(*each)
        for room in ("shared", "verify")
        for path in (ROOT / room).rglob("*.py")
        if path.relative_to(ROOT).parts[:2] not in {("verify", "run"), ("verify", "__main__.py")}
        for each in reading_list.imports(path, in_functions=True)
    }
    entries = [entry for entries in reading_list.DOORS.values() for entry in entries]
    assert doors == set(entries)
    assert len(entries) == len(doors)
    for name in ("bifurcation", "curve", "list"):
        listed = reading_list.reading_list(reading_list.CHAPTERS[name])
        assert not doors & set(listed)
        behind = reading_list.behind_doors(reading_list.CHAPTERS[name])
        assert {"systems with sin, cos, exp or log", "systems on a fixed level of an integral"} <= set(behind)
        for more in behind.values():
            assert more
            assert not set(more) & set(listed)
            for number, each in enumerate(more):
                path = reading_list.path_of(each)
                assert path is not None
                used = {reading_list.definer(*imported) for imported in reading_list.imports(path)}
                assert used <= {*listed, *more[:number]}


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
    entries, *doors = capsys.readouterr().out.split("\n\n")
    numbers = [int(entry.split()[1]) for entry in entries.splitlines()]
    assert doors[0] == f"in all {sum(numbers)} lines in {len(numbers)} modules"
    assert lines[0].split()[1] == str(sum(numbers))
    assert len(doors[1::2]) == len(doors[2::2]) > 2
    for heading, more in zip(doors[1::2], doors[2::2], strict=True):
        numbers = [int(entry.split()[1]) for entry in more.splitlines()]
        assert heading.startswith("and for ")
        assert heading.endswith(f", {sum(numbers)} lines in {len(numbers)} modules more")


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
