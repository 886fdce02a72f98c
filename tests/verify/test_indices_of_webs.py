"""The index of the orbits of arcs as a part of webs, and webs with indices that are none of theirs."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from support.chain_cases import loop
from support.forgeries import checked_by, forged
from test_index import curve_certificate, examined
from test_index import document as of_index
from test_web import arc, halo, proof, refusal, theorem
from test_web import lyapunov as lyapunov_family

from orbitproof import verify
from orbitproof.figures.commands.report import main as report_of
from orbitproof.shared.claims.web import Web, WebArc
from orbitproof.shared.codec import to_json
from orbitproof.shared.formats import InputError
from orbitproof.verify.__main__ import main
from orbitproof.verify.branches import certified_web, claiming_indices, resting
from orbitproof.verify.branches import web as of_webs
from orbitproof.verify.certificate import Certificate, Given, Key, Level, Recheck, recheck, write_certificate
from orbitproof.verify.stability import IntervalEnd
from orbitproof.verify.web import Arc, IndexOnArc, Indices

NAME = "distant-retrograde"
CURVE: Key = ("arc", NAME)
INDEX: Key = ("index", NAME)
CLAIM = Web("a web", "a web", (WebArc(NAME, index=True),))
PLACES = (
    IntervalEnd(("the beginning of the curve",), "p000", (Fraction(-1), Fraction(-1))),
    IntervalEnd(("fold",), "p001", (Fraction(1, 4), Fraction(1, 2))),
)
KNOWN = Indices("d9", (IndexOnArc((4,), "p000", Fraction(1, 8), *PLACES),))


def claiming(*names: str, of: tuple[str, ...]) -> Web:
    return Web("a web", "a web", tuple(WebArc(name, index=name in of) for name in names), False)


@cache
def given() -> tuple[Certificate, ...]:
    return resting(CLAIM, [Certificate(of_index()), curve_certificate()])


@cache
def checks(level: Level = Level.CONCLUSION) -> dict[Key, Recheck]:
    curve = replace(examined(), level=level, precision=128)
    return {CURVE: curve, INDEX: checked_by(of_index(), curve_certificate(), curve)}


@cache
def document() -> dict[str, Any]:
    return certified_web(CLAIM, given(), checks())


def test_the_index_that_is_claimed_is_stored_and_told_as_its_certificate_has_it() -> None:
    assert document()["verdict"] == "proved"
    assert [(entry["kind"], entry["id"]) for entry in document()["rests_on"]] == [CURVE, INDEX]
    assert document()["rests_on"][1]["digest"] == of_index()["digest"]
    assert [each["name"] for each in document()["hypotheses"]][-1] == "indices"
    words = document()["statement"]["theorem"]
    assert f"The index of orbits of the arc {NAME} ({of_index()['digest']}), of others nothing is said:" in words
    assert "- all orbits from the beginning of the curve (piece p001, s in [-1, -1]) to birth out of the plane" in words
    assert "these places not included: 3, in the plane 1 and across it 2" in words


def test_an_index_is_stored_in_its_parts_and_with_the_interval_of_its_orbits() -> None:
    stored, counted = document()["arcs"][0]["index"], of_index()["orbits"]
    assert [sum(entry["index"]) for entry in stored] == [entry["index"] for entry in counted] == [2, 3]
    assert [tuple(entry["index"]) for entry in stored] == [(1, 1), (1, 2)]
    for key in ("piece", "s", "begin", "end"):
        assert [entry[key] for entry in stored] == [entry[key] for entry in counted]


def test_without_a_claim_nothing_is_said_of_an_index() -> None:
    silent = Web("a web", "a web", (WebArc(NAME),))
    certificates = resting(silent, [Certificate(of_index()), curve_certificate()])
    assert certificates == (curve_certificate(),)
    found = certified_web(silent, certificates, checks())
    assert "index" not in json.dumps({key: value for key, value in found.items() if key != "software"})
    # Nor of that of an arc that has one, beside an arc of which it is claimed.
    both = replace(halo(), indices=KNOWN), replace(arc(loop(), "loop"), indices=KNOWN)
    apart = tuple(replace(each, atlas=_elsewhere(each)) for each in both[1:])
    web = proof(claiming("halo", "loop", of=("loop",)), both[0], *apart)
    assert [known.indices for known in web.arcs] == [None, KNOWN]


def _elsewhere(one: Arc) -> Any:
    """The same curve in pieces that are written otherwise."""
    zero = (Fraction(0),)
    pieces = (
        replace(each, polynomial=tuple(row + zero for row in each.polynomial)) for each in one.atlas.curve_pieces()
    )
    return replace(one.atlas, pieces=tuple(pieces))


def not_proved(entry: Certificate, check: Recheck) -> str:
    """Why a web with this certificate of an index is not proved."""
    own = {**checks(), INDEX: replace(check, digest=entry.document["digest"])}
    found = certified_web(CLAIM, (curve_certificate(), entry), own)
    assert found["verdict"] == "not proved"
    assert found["reason"]["condition"] == "indices"
    assert found["arcs"] == []
    assert "theorem" not in found["statement"]
    return str(found["reason"]["message"])


def test_the_certificate_of_an_index_has_to_be_proved_to_stand_and_to_be_of_the_same_curve() -> None:
    check = checks()[INDEX]
    silent = Certificate(forged(of_index(), lambda d: d.update(verdict="not proved")))
    assert "says 'not proved'" in not_proved(silent, check)
    own = Certificate(of_index())
    assert "does not stand: it hangs" in not_proved(own, replace(check, obstacle="it hangs"))
    assert "not checked up to its conclusion" in not_proved(own, replace(check, level=Level.FORM))
    for other in ({"digest": "sha256:" + 64 * "0"}, {"id": "another"}):
        moved = Certificate(forged(of_index(), lambda d, other=other: d["rests_on"].update(other)))  # type: ignore[misc]
        assert "rests on another certificate of a curve" in not_proved(moved, check)
    with pytest.raises(ValueError, match="the check of another certificate"):
        certified_web(CLAIM, given(), {**checks(), INDEX: replace(check, digest="sha256:" + 64 * "0")})
    # One that was changed does not stand, whatever it says.
    wrong = Certificate(forged(of_index(), lambda d: d["orbits"][0].update(index=4)))
    assert "does not stand" in not_proved(wrong, checked_by(wrong.document, curve_certificate(), examined()))


def test_an_index_of_the_same_name_on_another_certificate_of_the_curve_does_not_count() -> None:
    entry = forged(curve_certificate().document, lambda d: d.update(software={**d["software"], "version": "9"}))
    curve = Certificate(entry)
    moved = {CURVE: replace(checks()[CURVE], digest=entry["digest"]), INDEX: checks()[INDEX]}
    found = certified_web(CLAIM, (curve, Certificate(of_index())), moved)
    assert found["reason"]["condition"] == "indices"
    assert not recheck(Certificate(document()), given=Given((curve, given()[1]), moved)).stands


def test_a_certificate_of_an_index_that_is_missing_or_given_twice_is_told() -> None:
    curve, index = given()
    with pytest.raises(InputError, match="the web claims the index of distant-retrograde, and no such"):
        resting(CLAIM, [curve])
    with pytest.raises(InputError, match="the certificate of the index of distant-retrograde: appears twice"):
        resting(CLAIM, [curve, index, index])
    with pytest.raises(InputError, match="names distant-retrograde, and no such"):
        resting(CLAIM, [index])
    other = Certificate(forged(of_index(), lambda d: d.update(id="other")))
    with pytest.raises(InputError, match="claims the index"):
        resting(CLAIM, [curve, other])
    assert resting(CLAIM, [other, index, curve]) == (curve, index)


def test_an_arc_whose_index_is_claimed_has_one() -> None:
    claim = claiming("halo", of=("halo",))
    said = refusal(claim, halo())
    assert said.startswith("indices: ")
    assert "halo: no certificate of its index is given" in said
    for none in (replace(KNOWN, orbits=()), replace(KNOWN, problem="it does not stand")):
        assert refusal(claim, replace(halo(), indices=none)).startswith("indices: ")


def test_words_tell_of_those_orbits_alone_whose_index_is_known() -> None:
    claim = claiming("halo", of=("halo",))
    words = theorem(claim, replace(halo(), indices=KNOWN))
    ends = "from the beginning of the curve (piece p000, s in [-1, -1]) to fold (piece p001, s in [0.25, 0.5])"
    assert f"- all orbits and their mirror images {ends}, these places not included: 4" in words
    assert "The index of orbits of the arc halo (d9)" in words
    assert "small positive rotations have the index 1" in words
    single = replace(KNOWN, orbits=(IndexOnArc((4,), "p000", Fraction(1, 8)),))
    words = theorem(claim, replace(halo(), indices=single))
    assert "- the orbit at s = 0.125 of piece p000: 4" in words
    assert "all orbits" not in words
    _, family = lyapunov_family()
    small = replace(KNOWN, small=(2, 1))
    words = theorem(claiming(family.id, of=(family.id,)), replace(family, indices=small))
    assert "- planar orbits around L1 that are small enough: 3, in the plane 2 and across it 1" in words
    assert "mirror images" not in words
    assert "index" not in theorem(claiming("halo", of=()), replace(halo(), indices=KNOWN))


def test_the_index_of_small_orbits_is_stored_of_an_arc_of_which_an_index_is_claimed() -> None:
    _, family = lyapunov_family()
    indexed = replace(family, indices=replace(KNOWN, small=(2, 1)))
    plain: Any = SimpleNamespace(document={"conclusion": None}, stable=())
    for of, small, index in (((family.id,), (2, 1), KNOWN.orbits), ((), (), ())):
        web = proof(claiming(family.id, of=of), indexed)
        stored = of_webs._stored_arc(web.arcs[0], web, plain)
        assert (stored.small, stored.index) == (small, index)
    read = Certificate({**of_index(), "small": [2, 1]})
    assert read.small == (2, 1)
    assert Certificate(of_index()).small == ()


def test_the_command_reads_certificates_of_indices(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    curve, index, claim, output = (tmp_path / f"{name}.json" for name in ("curve", "index", "claim", "web"))
    write_certificate(curve, curve_certificate().document)
    write_certificate(index, of_index())
    claim.write_text(json.dumps({"format": "orbitproof-web", "version": 1, **to_json(CLAIM)}))
    both = ["--certificates", str(curve), str(index), "--quiet"]
    assert main(["web", str(claim), *both, "-o", str(output)]) == 0
    assert "in the plane 1 and across it 2" in capsys.readouterr().out
    assert verify.read(output)[0].document == document()
    assert main(["web", "--recheck", str(output), *both]) == 0
    assert main(["web", str(claim), "--certificates", str(curve), "--quiet"]) == 2
    assert "claims the index of distant-retrograde" in capsys.readouterr().err
    # A certificate that says less than was proved follows from nothing.
    write_certificate(index, forged(of_index(), lambda d: d["orbits"].pop()))
    assert main(["web", str(claim), *both]) == 1
    assert "NOT PROVED: indices" in capsys.readouterr().out


def test_a_report_tells_the_index_with_the_web_that_rests_on_it_and_a_forged_one_is_not_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    curve, index, web, report = (tmp_path / f"{name}.{end}" for name, end in (
        ("curve", "json"), ("index", "json"), ("web", "json"), ("report", "md")
    ))  # fmt: skip
    write_certificate(curve, curve_certificate().document)
    write_certificate(index, of_index())
    write_certificate(web, document())
    told = ["-o", str(report), "--no-pictures", "--quiet"]
    assert report_of([str(web), str(index), str(curve), *told]) == 0
    text = report.read_text()
    for words in (
        "The index of orbits of a curve",
        "index of 2 orbits",
        f"It rests on {NAME} ([Theorem 1](",
        f"), {NAME}-index ([Theorem 2](",
        "verify index --recheck index.json --curve curve.json",
        "verify web --recheck web.json --certificates curve.json index.json",
    ):
        assert words in text, words
    report.unlink()
    # A web that is told alone needs its index, and that its curve.
    assert report_of([str(web), str(index), str(curve), "--only", "a web", *told]) == 0
    report.unlink()
    assert report_of([str(web), str(curve), *told]) == 2
    assert "claims the index of distant-retrograde" in capsys.readouterr().err
    assert report_of([str(index), *told]) == 2
    assert "rests on the curve" in capsys.readouterr().err
    write_certificate(index, forged(of_index(), lambda d: d["orbits"].pop()))
    assert report_of([str(index), str(curve), *told]) == 1
    assert f"REFUSED {index}" in capsys.readouterr().err
    assert not report.exists()


def test_the_index_is_claimed_of_all_arcs_whose_certificates_are_given(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    silent, index = Web("a web", "a web", (WebArc(NAME),)), Certificate(of_index())
    assert claiming_indices(silent, [curve_certificate(), index]) == CLAIM
    assert claiming_indices(silent, [curve_certificate()]) == silent
    assert claiming_indices(CLAIM, [curve_certificate()]) == CLAIM
    files = [tmp_path / name for name in ("curve.json", "index.json", "claim.json", "web.json")]
    write_certificate(files[0], curve_certificate().document)
    write_certificate(files[1], index.document)
    files[2].write_text(json.dumps({"format": "orbitproof-web", "version": 1, **to_json(silent)}))
    given_files = ["--certificates", *map(str, files[:2]), "--quiet"]
    assert main(["web", str(files[2]), *given_files, "--indices", "-o", str(files[3])]) == 0
    assert verify.read(files[3])[0].document == document()
    assert main(["web", "--recheck", str(files[3]), *given_files, "--indices"]) == 2
    assert "--indices" in capsys.readouterr().err
