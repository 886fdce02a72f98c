"""Search and proof from a script, a notebook, a command and standard input; values that print in a line."""

from __future__ import annotations

import doctest
import json
import os
import pickle
import re
import subprocess
import sys
from dataclasses import FrozenInstanceError, replace
from fractions import Fraction
from importlib import import_module
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from support.claims import known
from support.notebooks import run_notebook

from orbitproof import explore, figures, shared, verify
from orbitproof.shared import CR3BP, EARTH_MOON, FALKNER_SKAN, InputError
from orbitproof.shared.systems import CR3BP_AXIAL
from orbitproof.verify.evidence import software

ROOT = Path(__file__).resolve().parents[2]
GUIDE = (ROOT / "docs" / "python.md").read_text("utf-8")
OLD = ROOT / "tests" / "data" / "figures-certificates.json"
BEFORE = ROOT / "tests" / "data" / "earlier-certificates.json"
FACES = {"explore": explore, "figures": figures, "verify": verify, "shared": shared}


def scripts_of_the_guide() -> list[str]:
    return re.findall(r"^```python\n(.*?)^```$", GUIDE, re.MULTILINE | re.DOTALL)


def run(arguments: list[str], folder: Path, text: str | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments],
        cwd=folder,
        input=text,
        env={**os.environ, "JAX_PLATFORMS": "cpu"},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


@pytest.fixture(scope="module")
def family() -> explore.OrbitFamily:
    return explore.trace(FALKNER_SKAN, "odd", beta=(300, 400), quiet=True)


@pytest.fixture(scope="module")
def proof() -> verify.Certificate:
    (certificate,) = verify.certify(known("fs2"), quiet=True)
    return certificate


@pytest.mark.parametrize(
    "module",
    [f"orbitproof.{name}" for name in ("shared", "shared.arguments", "verify.scripting", "explore.scripting")],
)
def test_examples_of_the_documentation_hold(module: str) -> None:
    result = doctest.testmod(import_module(module), optionflags=doctest.ELLIPSIS)
    assert result.failed == 0
    assert result.attempted > 0


@pytest.mark.parametrize("room", FACES)
def test_every_name_of_a_face_is_there_listed_and_documented(room: str) -> None:
    face = FACES[room]
    assert set(face.__all__) <= set(dir(face))
    assert len(face.__all__) <= 35
    for name in face.__all__:
        value = getattr(face, name)
        if callable(value):
            assert len((value.__doc__ or "").strip()) > 20, name


def test_a_name_that_is_not_there_says_what_there_is() -> None:
    with pytest.raises(AttributeError, match=r"'tracee'; it has .*trace"):
        explore.tracee  # noqa: B018


SCRIPT = """\
from pathlib import Path
from orbitproof import verify
from orbitproof.shared import read_candidates
for proof in verify.certify(read_candidates(Path("claims.json")), jobs=2, quiet=True):
    print(proof)
"""
PROVED = "period doubling (k = 2), proved, below, beta = 340.18"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with claims, and with modules of the user's whose names are generic."""
    shared.write_candidates(tmp_path / "claims.json", [known("fs2"), replace(known("fs2"), id="again")])
    for name in ("shared", "verify", "explore", "figures"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('the module of the user was imported')\n")
    return tmp_path


# A main module with a file and one without; the others are of the second kind.
@pytest.mark.parametrize(
    "how", ["script", "standard input", *(pytest.param(way, marks=pytest.mark.slow) for way in ("-c", "notebook"))]
)
def test_workers_start_without_a_guard_of_the_main_module(how: str, folder: Path) -> None:
    (folder / "script.py").write_text(SCRIPT)
    notebook = f"import sys, types; sys.modules['__main__'] = types.ModuleType('__main__')\nexec({SCRIPT!r})"
    result = {
        "script": lambda: run(["script.py"], folder),
        "-c": lambda: run(["-c", SCRIPT], folder),
        "standard input": lambda: run(["-"], folder, SCRIPT),
        "notebook": lambda: run(["-c", notebook], folder),
    }[how]()
    assert result.returncode == 0, result.stderr
    assert [line[: len(PROVED)] for line in result.stdout.splitlines()] == [PROVED, PROVED]
    assert result.stderr == ""


@pytest.mark.slow
def test_the_scripts_of_the_guide_run_and_the_first_finds_proves_and_writes(tmp_path: Path) -> None:
    (tmp_path / "script.py").write_text("\n".join(scripts_of_the_guide()))
    result = run(["script.py"], tmp_path)
    assert result.returncode == 0, result.stderr
    lines = result.stdout.splitlines()[:11]
    assert result.stdout.endswith("True\n")
    assert all(", proved, " in line for line in lines)
    assert any(line.startswith("period doubling (k = 2), proved, below, C = 3.02161924792642") for line in lines)
    assert len(verify.read(tmp_path / "certificates.json")) == 11


def test_the_scripts_of_the_guide_can_be_read() -> None:
    script = "\n".join(scripts_of_the_guide())
    compile(script, "python.md", "exec")
    for name in ("explore.trace", "explore.refine", "explore.resonances", "verify.certify", "verify.write"):
        assert name in script


def test_a_resonance_is_found_refined_and_proved(family: explore.OrbitFamily) -> None:
    (resonance,) = explore.resonances(family, k=2, quiet=True)
    assert (resonance.kind, resonance.k) == ("period_tupling", 2)
    claim = explore.refine(resonance, digits=50, quiet=True)
    assert claim.id == resonance.id == "falkner-skan-odd-k2-1"
    assert abs(float(claim.centre[0]) - resonance.point[0]) < 1e-6
    (certificate,) = verify.certify([claim], quiet=True)
    assert str(certificate).startswith(PROVED)
    assert certificate.candidate.centre == claim.centre


def test_the_notebook_runs_and_ends_in_a_certificate_that_stands(capsys: pytest.CaptureFixture[str]) -> None:
    """Cell by cell, as a notebook does: the last expression of a cell is shown."""
    shown = run_notebook(ROOT / "docs" / "first-proof.ipynb")
    plt.close("all")
    printed = capsys.readouterr().out
    assert PROVED in printed
    assert "the certificate stands\n" in printed
    assert all("<table>" in value._repr_html_() for value in shown if hasattr(value, "_repr_html_"))


def test_a_family_is_a_sequence_of_orbits(family: explore.OrbitFamily) -> None:
    assert len(family) == len(list(family)) == len(family[:])
    assert family[-1].parameters["beta"] >= 400
    assert "orbits, ends: limit beta" in repr(family)
    assert "<table>" in family._repr_html_()


def test_states_of_an_orbit_solve_its_equations_and_close_up(family: explore.OrbitFamily) -> None:
    orbit = family[3]
    times = np.linspace(-1.0, 2.0, 31) * orbit.period
    states = orbit.states(times)
    assert states.shape == (31, 3)
    assert np.allclose(orbit.states([0.0])[0], orbit.point)
    assert np.allclose(orbit.states(times + orbit.period), states, atol=1e-7)
    step = 1e-5 * orbit.period
    slope = (orbit.states(times + step) - orbit.states(times - step)) / (2 * step)
    field = np.array([FALKNER_SKAN.vector_field(state, [orbit.parameters["beta"]]) for state in states])
    assert np.allclose(slope, field, atol=1e-5 * np.abs(field).max())
    instants, path = orbit.trajectory(50)
    assert instants.shape == (50,)
    assert path.shape == (50, 3)
    with pytest.raises(ValueError, match="times"):
        orbit.states([float("nan")])


def test_axial_families_are_traced_by_name() -> None:
    axial = explore.trace(CR3BP, "L1-axial", mu="jpl-earth-moon", max_orbits=4, quiet=True)
    assert axial.system is CR3BP_AXIAL
    row = axial.to_dataframe().iloc[0]
    assert row["period (days)"] == axial[0].period_days
    assert row["stability index"] == axial[0].stability_index


def test_a_family_is_a_table_where_pandas_is(family: explore.OrbitFamily, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ModuleNotFoundError, match=r"^to_dataframe needs pandas: pip install pandas$"):
        family.to_dataframe()
    monkeypatch.undo()
    import pandas

    frame = family.to_dataframe()
    assert isinstance(frame, pandas.DataFrame)
    assert len(frame) == len(family)
    assert list(frame.columns) == ["x", "y", "z", "period", "beta", "stability index", "s1", "arclength"]


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("L9-halo", {"mu": EARTH_MOON}, "'L9-halo' is no family of cr3bp; there are L1-halo"),
        ("L1-halo", {}, "mu: missing; give the mass parameter"),
        ("L1-halo", {"mu": 1.5}, "outside"),
        ("L1-halo", {"mu": "moon"}, "names are earth-moon, sun-jupiter,"),
        ("L1-halo", {"mu": float("nan")}, "no number"),
        ("L1-halo", {"mu": EARTH_MOON, "beta": (2, 3)}, "beta: cr3bp has no such parameter"),
    ],
)
def test_bad_arguments_of_the_search_say_which_and_what_there_is(name: str, options: dict, message: str) -> None:
    with pytest.raises(ValueError, match=re.escape(message)):
        explore.trace(CR3BP, name, quiet=True, **options)


def test_a_certificate_is_a_value_that_prints_in_a_line(proof: verify.Certificate) -> None:
    assert re.fullmatch(r"period doubling \(k = 2\), proved, below, beta = 340\.18\d+\[\d+,\d+\]", str(proof))
    assert len(repr(proof)) < 80
    assert proof == verify.Certificate.from_json(proof.to_json())
    assert hash(proof) == hash(pickle.loads(pickle.dumps(proof)))
    with pytest.raises(FrozenInstanceError):
        proof.verdict = "not proved"  # type: ignore[misc]
    with pytest.raises(TypeError):
        proof.point["y"] = proof.parameter  # type: ignore[index]
    proof.to_json()["results"]["side"] = "above"
    proof.statement["candidate"]["k"] = 7
    assert proof.side == "below"
    assert proof.candidate.k == 2
    assert "<caption>" in proof._repr_html_()
    assert len(proof._repr_html_()) < 2000


def test_a_claim_that_is_wrong_or_breaks_the_verifier_is_not_proved_and_raises_nothing() -> None:
    claim = known("fs2")
    wrong = [
        replace(claim, id="k", k=4),
        replace(claim, id="kind", kind="symmetry_breaking"),
        replace(claim, id="frame", kernel_frame=((Fraction(0),),)),
        replace(claim, id="far", centre=(claim.centre[0], Fraction(10**30))),
    ]
    proofs = verify.certify(wrong, quiet=True, max_precision=256)
    assert [proof.id for proof in proofs] == ["k", "kind", "frame", "far"]
    for entry in proofs:
        assert entry.verdict == "not proved"
        assert "not proved" in str(entry)
        assert entry.reason is not None
        assert "defect" not in entry.reason.remedy


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"centre": (Fraction(1, 3), Fraction(1))}, "centre: 1/3 is neither dyadic nor decimal; round it"),
        ({"centre": (340.2, Fraction(1))}, "centre: 340.2 is no exact number"),
        ({"centre": (Fraction(1),)}, "centre: 1 number"),
        ({"radii": (Fraction(1), Fraction(0))}, "radii[1]: not positive"),
        ({"frame": ((Fraction(1),),)}, "frame: wrong shape"),
        ({"kind": "pitchfork"}, "kind: 'pitchfork' is unknown; give one of"),
        ({"symmetry": "T"}, "symmetry: falkner-skan has no symmetry 'T'; known: none"),
        ({"k": 0}, "k: 0 is no multiplicity"),
        ({"id": "a\nb"}, "id: "),
    ],
)
def test_a_candidate_is_checked_when_it_is_made(change: dict, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        replace(known("fs2"), **change)


def test_bad_arguments_of_the_verifier_are_refused() -> None:
    claim = known("fs2")
    with pytest.raises(InputError, match="appears twice"):
        verify.certify([claim, claim])
    with pytest.raises(TypeError, match="no claim"):
        verify.certify(["earth-moon"])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="jobs"):
        verify.certify([claim], jobs=0, quiet=True)


def test_certificates_go_through_a_file_and_are_checked_again(proof: verify.Certificate, tmp_path: Path) -> None:
    path = tmp_path / "certificates.json"
    verify.write(path, [proof])
    assert verify.read(str(path)) == [proof]
    (check,) = verify.recheck(verify.read(path), quiet=True)
    assert check.stands
    with pytest.raises(InputError, match="no certificates"):
        verify.write(path, [])
    with pytest.raises(InputError, match="appears twice"):
        verify.write(path, [proof, proof])


def test_certificates_made_by_earlier_sources_stand_in_the_words_of_this_version() -> None:
    """That the first integral is one was not said by their hypothesis on symmetries; it is evaluated now, and holds."""
    entries = verify.read(BEFORE)
    assert all(entry.software["source"] != software()["source"] for entry in entries)
    for check in verify.recheck(entries, quiet=True):
        assert check.word == "stands, worded otherwise"
        assert check.rendered is not None
        assert "first integral" in check.rendered["hypotheses"][0]["statement"]


def test_certificates_of_earlier_versions_are_read_and_each_says_why_it_does_not_stand() -> None:
    """They carry no enclosures from which their hypotheses could be evaluated again."""
    entries = verify.read(OLD)
    assert len(entries) == len(json.loads(OLD.read_text())["certificates"])
    assert all(str(entry) for entry in entries)
    for check in verify.recheck(entries, quiet=True):
        assert check.stands or all(len(str(finding.message).splitlines()) == 1 for finding in check.findings)


def test_an_interrupt_ends_the_script_and_not_only_the_family(monkeypatch: pytest.MonkeyPatch) -> None:
    scripting = import_module("orbitproof.explore.scripting")
    whole = explore.trace(FALKNER_SKAN, "odd", beta=(390, 400), quiet=True)
    part = replace(whole._traced.family, outcome="interrupted")
    monkeypatch.setattr(scripting, "trace_family", lambda *_, **__: part)
    with pytest.raises(KeyboardInterrupt):
        explore.trace(FALKNER_SKAN, "odd", quiet=True)
