"""From a file of one's own to certificates and back, with the commands alone, and without the file again."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from support.refusals import refused

from orbitproof import explore, shared, verify
from orbitproof.explore.__main__ import main as explore_main
from orbitproof.explore.records import read_families
from orbitproof.verify.__main__ import main as verify_main
from orbitproof.verify.certificate import read_certificates

EXAMPLES = Path(__file__).resolve().parents[2] / "docs" / "examples"
SMALL = ["--parameter-min", "c", "0.1", "--parameter-max", "c", "0.3", "--quiet"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the candidates and certificates of a short part of Michelson's family, the file removed."""
    place = tmp_path_factory.mktemp("own")
    file = place / "michelson.py"
    shutil.copy(EXAMPLES / "michelson.py", file)
    start = ["--system", str(file), "--start", "c=0.1", "y=0.2"]
    output = ["-o", str(place / "candidates.json"), "--family-output", str(place / "family.json")]
    assert explore_main(["candidates", *start, *SMALL, "-k", "3", "4", "--digits", "30", "--jobs", "1", *output]) == 0
    file.unlink()
    certificates = ["-o", str(place / "certificates.json"), "--jobs", "1", "--quiet"]
    assert verify_main([str(place / "candidates.json"), *certificates]) == 0
    return place


def test_all_is_proved_and_the_points_are_the_known_ones(folder: Path) -> None:
    found = read_certificates(folder / "certificates.json")
    values = {entry.k: float(entry.parameter.mid()) for entry in found.values() if entry.parameter is not None}
    assert all(entry.proved for entry in found.values())
    assert values == pytest.approx({4: 0.22544048261393621, 3: 0.27634323081200158}, abs=1e-15)


def test_a_process_that_never_saw_the_file_checks_the_certificates(folder: Path) -> None:
    for words in (["--recheck"], ["--recheck", "--integrate"]):
        command = [sys.executable, "-m", "orbitproof", "verify", *words, "certificates.json"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
        assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("integrate", [False, True])
def test_a_certificate_is_checked_again_without_the_file(folder: Path, integrate: bool) -> None:
    for check in verify.recheck(verify.read(folder / "certificates.json"), integrate=integrate, quiet=True):
        assert check.stands, check.findings


def test_another_program_than_the_described_one_does_not_stand(folder: Path) -> None:
    document = json.loads((folder / "certificates.json").read_text("utf-8"))
    for entry in document["certificates"]:
        system = entry["statement"]["candidate"]["system"]
        assert system["name"] == "michelson"
        system["field"] = system["field"].replace("v7 = 2", "v7 = 3")
        entry.pop("digest")
    changed = folder / "changed.json"
    changed.write_text(json.dumps(document), "utf-8")
    for check in verify.recheck(verify.read(changed), quiet=True):
        assert not check.stands


def test_a_changed_file_is_a_changed_claim(folder: Path, tmp_path: Path) -> None:
    document = json.loads((folder / "candidates.json").read_text("utf-8"))
    for entry in document["candidates"]:
        entry["system"]["field"] = entry["system"]["field"].replace("v7 = 2", "v7 = 3")
    other = tmp_path / "other.json"
    other.write_text(json.dumps(document), "utf-8")
    certificates = tmp_path / "certificates.json"
    shutil.copy(folder / "certificates.json", certificates)
    # What was proved of the old system is not taken for a proof of the new one.
    assert verify_main([str(other), "-o", str(certificates), "--jobs", "1", "--quiet"]) == 1
    assert not any(entry.proved for entry in read_certificates(certificates).values())


def test_a_family_file_goes_on_without_the_file_of_the_system(folder: Path) -> None:
    (family,) = read_families(folder / "family.json")
    assert family.system.name == "michelson"
    longer = folder / "longer.json"
    more = ["--parameter-max", "c", "0.4", "--quiet", "-o", str(longer)]
    assert explore_main(["family", "--from-family", str(folder / "family.json"), *more]) == 0
    (again,) = read_families(longer)
    assert again.system is family.system
    assert len(again.orbits) > len(family.orbits)


def test_a_family_that_goes_back_over_its_own_orbits_ends_there(tmp_path: Path) -> None:
    file, output = EXAMPLES / "michelson.py", tmp_path / "family.json"
    command = ["family", "--system", str(file), "--start", "c=0.1", "y=0.2", "--parameter-min", "c", "0.01", "--quiet"]
    assert explore_main([*command, "-o", str(output)]) == 0
    (family,) = read_families(output)
    assert "goes back over its own orbits" in family.reason
    assert max(orbit.point[0] for orbit in family.orbits) == pytest.approx(1.2662, abs=2e-3)
    assert explore_main(["family", "--from-family", str(output), "--quiet", "-o", str(tmp_path / "more.json")]) == 0
    (more,) = read_families(tmp_path / "more.json")
    assert len(more.orbits) == len(family.orbits)


def test_one_orbit_and_one_point_have_a_door_each(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    system = ["--system", str(EXAMPLES / "michelson.py")]
    orbit, point = tmp_path / "orbit.json", tmp_path / "point.json"
    assert explore_main(["orbit", *system, "--start", "c=0.1", "y=0.2", "-o", str(orbit)]) == 0
    assert "half period" in capsys.readouterr().out
    assert len(read_families(orbit)[0].orbits) == 1
    refine = ["refine", *system, "-k", "3", "--digits", "30", "--quiet", "-o", str(point)]
    assert explore_main([*refine, "--point", "c=0.27634", "y=0.52554"]) == 0
    (candidate,) = shared.read_candidates(point)
    assert float(candidate.centre[0]) == pytest.approx(0.27634323081200158, abs=1e-15)
    assert explore_main([*refine, "--point", "c=0.25", "y=0.5"]) == 1


@pytest.mark.parametrize(
    ("system", "words", "k", "point", "value"),
    [
        ("michelson", [], 4, ["c=0.22544", "y=0.43305"], 0.22544048261393621),
        ("henon-heiles", [], 2, ["y=0.3251931", "vx=0.4631161"], 0.14865042342370901),
        ("hill", [], 1, ["x=0.58126467", "z=0", "vy=0.67012429"], 4.0053126531390990),
        ("beam", ["--parameter", "P=7/3"], 4, ["u=-0.223976", "u2=1.600686"], -1.2522701331698336),
    ],
)
def test_a_point_of_each_example_is_refined_and_proved(
    system: str, words: list[str], k: int, point: list[str], value: float, tmp_path: Path
) -> None:
    candidate, certificate = tmp_path / "candidate.json", tmp_path / "certificate.json"
    command = ["refine", "--system", str(EXAMPLES / f"{system}.py"), *words, "-k", str(k), "--point", *point]
    assert explore_main([*command, "--digits", "30", "--quiet", "-o", str(candidate)]) == 0
    assert verify_main([str(candidate), "-o", str(certificate), "--jobs", "1", "--quiet"]) == 0
    (proof,) = read_certificates(certificate).values()
    assert proof.parameter is not None
    assert float(proof.parameter.mid()) == pytest.approx(value, rel=1e-14)
    (check,) = verify.recheck(proof, quiet=True)
    assert check.stands, check.findings


def test_the_families_of_an_equilibrium_are_found_by_their_frequencies(tmp_path: Path) -> None:
    output = tmp_path / "family.json"
    start = ["--system", "cr3bp", "--mass", "earth-moon", "--start", "equilibrium", "x=0.8"]
    assert explore_main(["family", *start, "--max-orbits", "4", "--quiet", "--jobs", "1", "-o", str(output)]) == 0
    planar, vertical = read_families(output)
    assert planar.symmetry == "S"
    assert vertical.symmetry is None
    known = explore.trace(shared.CR3BP, "L1-lyapunov", mu=shared.EARTH_MOON, max_orbits=2, quiet=True)
    assert planar.orbits[0].half_period == pytest.approx(known[0].period / 2, rel=1e-5)
    assert vertical.orbits[0].crossings == 2


@pytest.mark.parametrize(
    ("right", "wrong", "line"),
    [
        ("- x**2/2", "- x/2", "field.z: is not reversible under R"),
        ("- x**2/2", "- abs(x)", "field.z: 'abs(x)' is not allowed"),
        ("- x**2/2", "- q**2/2", "field.z: the name 'q'"),
        ('"y": 1,', '"y": -1,', "Fix(R) has the wrong dimension"),
        ('section = "x"', 'section = "y"', "section: R must negate the section coordinate"),
        ('section = "x"', "section = ", "cannot be run: SyntaxError"),
        ('family_parameter = "c"', 'family_parameter = "d"', "unknown family parameter 'd'"),
        ('family_parameter = "c"', "", "give one of family_parameter and first_integral"),
        ("title =", 'symmetries = {"S": {"y": -1}}\ntitle =', "field.x: does not commute with S"),
        ('family_parameter = "c"', 'first_integral = "y"', "Fix(R) has the wrong dimension"),
    ],
)
def test_an_error_in_a_clause_of_the_file_is_one_line_of_every_command(
    right: str, wrong: str, line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (EXAMPLES / "michelson.py").read_text("utf-8")
    assert right in text
    file = tmp_path / "michelson.py"
    file.write_text(text.replace(right, wrong), "utf-8")
    output = ["-o", str(tmp_path / "never.json")]
    start = ["--system", str(file), "--start", "c=0.1", "y=0.2"]
    for words in (["orbit", *start], ["family", *start, *output], ["candidates", *start, *output]):
        assert explore_main(words) == 2
        error = capsys.readouterr().err
        assert "michelson.py" in error
        assert line in error
        assert error.count("\n") == 1
    assert not (tmp_path / "never.json").exists()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--start", "c=0.1"], "--start: y is missing"),
        (["--start", "c=0.1", "y"], "no assignment"),
        (["--start", "c=0.1", "y=two"], "no number"),
        (["--start", "c=0.1", "w=2"], "no coordinate of michelson"),
        (["--start", "c=0.1", "y=0.2", "c=0.3"], "c is given twice"),
        (["--start", "equilibrium", "c=0.1"], "no first integral"),
        ([], "--start: missing"),
        (["--start", "c=0.1", "y=0.2", "--parameter", "a=1"], "no such fixed parameter"),
        (["--start", "c=0.1", "y=0.2", "--parameter-min", "a", "1"], "--parameter-min a: unknown"),
        (["--start", "c=0.1", "y=0.2", "--z-max", "1"], "no such coordinate"),
        (["--start", "c=0.1", "y=0.2", "--mass", "0.1"], "no mass parameter"),
        (["--start", "c=0.1", "y=0.2", "-k", "1"], "no symmetry"),
    ],
)
def test_a_wrong_start_is_one_line(
    words: list[str], line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    command = ["family", "--system", str(EXAMPLES / "michelson.py"), *words, "-o", str(tmp_path / "never.json")]
    assert line in refused(explore_main, command, capsys)


@pytest.mark.parametrize(
    ("state", "field", "remedy"),
    [
        ('"x"', "def field(x, a): return -x", "give two coordinates or more"),
        ('"x y"', "def field(x, y, a): return y, -x + a*cos(x)", "for formulas as text (docs/how-to/sin-and-exp.md)"),
        ('"x y"', "def field(x, y, a): return y, -x + a*t", "docs/how-to/forced-systems.md"),
        ('"x y"', 'field = {"x": "y", "y": "-x + a*cos(t) + t"}', "of r*t + c, where r is made of parameters"),
        ('"x t"', 'field = {"x": "cos(t) - x", "t": "2 + a"}', "t has the rate 2 everywhere, so that no orbit"),
        ('"x y"', 'field = {"x": "y", "y": "-x^2"}', "a power is written **"),
        ('"x y"', 'field = {"x": "y", "y": "-sqrt(x - 2) + a"}', "no value at x = 1, y = 0, a = 0; give another start"),
        ('"x y"', 'field = {"x": "y/0", "y": "-x"}', "mine.py: field.x: 'y/0' divides by zero; correct it"),
        ('"x y"', 'where = {"c": "0"}; field = {"x": "y", "y": "cos(t)/c"}', "mine.py: field.y: 'force_cos/c' divides"),
        ('"x y"', "def field(x, y, a): return y/0, -x", "mine.py: field: ZeroDivisionError: a quotient by 0"),
        ('"x y"', 'field = {"x": "y", "y": "-pi*x"}', "make pi, or what it is multiplied by, a parameter"),
        ('"v1 v2"', "def field(v1, v2, a): return v2, -v1", "choose another one, such as u1"),
        ('"x y"', "def field(x, y, a): return y, -(x**a)", "write a whole number or a half-integer"),
        ('"x y"', "def field(x, y, a): return y, -x/a", "a = 0 is divided by; give a another value"),
    ],
)
def test_what_a_newcomer_writes_is_answered_with_what_to_write(
    state: str, field: str, remedy: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.py"
    path.write_text(f'name = "mine"\nstate = {state}\nparameters = "a"\n{field}\n')
    start = [f"{name}={1 - place}" for place, name in enumerate(state.strip('"').split())]
    words = ["--system", str(path), "--parameter", "a=0", "--start", *start, "-o", str(tmp_path / "out.json")]
    assert explore_main(["periodic", *words, "--quiet"]) in (1, 2)
    said = capsys.readouterr()
    assert remedy in said.err + said.out


def test_equilibria_with_a_force_are_refused_with_what_to_look_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "forced.py"
    path.write_text('name = "forced"\nstate = "x"\nparameters = "a"\nfield = {"x": "a*cos(t) - x"}\n')
    assert explore_main(["equilibria", "--system", str(path), "--parameter", "a=1", "--start", "x=1", "--quiet"]) == 1
    assert "look for periodic orbits: explore periodic" in capsys.readouterr().err


def test_an_error_reply_saved_as_a_catalogue_is_told_as_one(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "reply.json"
    path.write_text('{"code": "400", "message": "unknown parameter", "moreInfo": "see there"}')
    assert explore_main(["catalogue", str(path), "-o", str(tmp_path / "out.csv")]) == 2
    assert "an error reply of the catalogue, no orbits" in capsys.readouterr().err


def test_an_orbit_without_symmetry_takes_its_mass_by_name(tmp_path: Path) -> None:
    words = ["--mass", "JPL-Earth-Moon", "--triangular", "L4-short", "-o", str(tmp_path / "l4.json"), "--quiet"]
    assert explore_main(["periodic", *words]) == 0
    assert explore_main(["periodic", "--system", "falkner-skan", "--mass", "0.1", "--start", "x=0", "--quiet"]) == 2
