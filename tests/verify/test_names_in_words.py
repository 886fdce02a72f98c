"""A file may call its coordinates and parameters as it likes: a theorem has its own symbols for itself."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support import breaking_cases, krein_cases, stability_cases
from support.claims import known
from support.conclusions import with_complete_list
from support.stored import values
from support.told import in_full, theorem_in_words

from orbitproof.shared.formats import Atlas, Candidate, Equation
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, DescriptionError, ReversibleSystem, described
from orbitproof.verify.bifurcation import level_form
from orbitproof.verify.certificate.kinds import theorem_of
from orbitproof.verify.claim import names_in_words
from orbitproof.verify.curve import conclude
from orbitproof.verify.evidence import Reason
from orbitproof.verify.krein import KreinTheorem
from orbitproof.verify.words.breaking import breaking_found
from orbitproof.verify.words.formulas import setting
from orbitproof.verify.words.krein import krein_found, krein_in_words

HOSTILE = {
    "falkner-skan": {"x": "P", "y": "H", "z": "s", "beta": "pi"},
    "cr3bp": {"x": "H", "y": "Fix", "z": "T", "vx": "k", "vy": "i", "vz": "R", "mu": "s", "S": "X"},
}
"""Names that theorems use for something else."""


def renamed(system: ReversibleSystem, names: Mapping[str, str]) -> ReversibleSystem:
    return replace(
        system,
        name="somebody-elses",
        state=tuple(names[name] for name in system.state),
        parameters={names[name]: interval for name, interval in system.parameters.items()},
        section=names[system.section],
        symmetries={names[name]: signs for name, signs in system.symmetries.items()},
        family_parameter=system.family_parameter and names[system.family_parameter],
        level_coordinate=system.level_coordinate and names[system.level_coordinate],
    )


def claim_of(candidate: Candidate) -> Candidate:
    names = HOSTILE[candidate.system.name]
    equation = candidate.equation
    if equation is not None and equation.coordinate is not None:
        equation = replace(equation, coordinate=names[equation.coordinate])
    return replace(
        candidate,
        system=renamed(candidate.system, names),
        parameters={names[name]: value for name, value in candidate.parameters.items()},
        symmetry=candidate.symmetry and names[candidate.symmetry],
        equation=equation,
    )


def back(text: str, system: ReversibleSystem) -> str:
    """With the names that the system had before."""
    for old, name in HOSTILE[system.name].items():
        kind = "coordinate" if old in system.state else "parameter" if old in system.parameters else "symmetry"
        text = re.sub(rf"\b{name}_{kind}\b", old, text)
    return re.sub(r"In the description of the system .*\n", "", text)


def words_of(candidate: Candidate, integral: bool = False) -> str:
    form = level_form(candidate) if integral else None
    assert form is None or isinstance(form, Candidate)
    theorem = theorem_of(candidate, form)
    assert not isinstance(theorem, Reason)
    point = dict.fromkeys(candidate.system.centre_coordinates, arb(1, 0.25))
    found: Any = SimpleNamespace(point=point, parameter=arb(2, 0.25), side="above")
    return in_full(candidate, theorem, found)


@pytest.mark.parametrize(("name", "integral"), [("fs3", False), ("em1", True), ("em2", False)])
def test_a_theorem_about_a_box_says_of_each_such_name_what_it_is(name: str, integral: bool) -> None:
    claim = known(name)
    hostile = words_of(claim_of(claim), integral)
    assert back(hostile, claim.system) == words_of(claim, integral)
    called = re.findall(r"(\w+) is called (\w+)[,.]?", hostile)
    assert {old: new for new, old in called} == names_in_words(claim_of(claim).system)


def test_a_theorem_about_an_orbit_does_so_too() -> None:
    one = tuple(tuple(Fraction(i == j) for j in range(2)) for i in range(2))
    claim = replace(known("fs3"), kind="orbit", k=1, frame=one, equation=Equation("coordinate", Fraction(400), "beta"))
    theorem, hostile = theorem_of(claim), theorem_of(claim_of(claim))
    assert not isinstance(theorem, Reason)
    assert not isinstance(hostile, Reason)
    assert back(theorem_in_words(hostile), FALKNER_SKAN) == theorem_in_words(theorem)
    assert "pi_parameter = 400" in theorem_in_words(hostile)


def atlas_of(atlas: Atlas) -> Atlas:
    names = HOSTILE[atlas.system.name]
    claim, covers = atlas.claim, atlas.claim.covers
    claim = replace(
        claim,
        increasing=tuple(names[name] for name in claim.increasing),
        covers=covers and replace(covers, coordinate=names[covers.coordinate]),
    )
    return replace(atlas, system=renamed(atlas.system, names), claim=claim)


def test_a_theorem_about_a_curve_and_its_list_do_so_too() -> None:
    atlas, results = stability_cases.atlas(), stability_cases.results()
    assert atlas.claim.increasing
    texts = []
    for each in (atlas, atlas_of(atlas)):
        document = with_complete_list(each, results, conclude(each, values(results)), 4)
        assert document["verdict"] == "proved"
        texts.append([document["statement"], *(item["statement"] for item in document["hypotheses"])])
        texts[-1].append("\n".join(setting(each.system, each.parameters, None)))
    plain, hostile = texts
    assert [back(text, FALKNER_SKAN) for text in hostile] == plain
    assert any("pi_parameter increases strictly" in text for text in hostile)


def test_a_list_has_another_letter_for_points_where_a_coordinate_has_its_own() -> None:
    names = {"x": "w", "y": "u", "z": "v", "beta": "b"}
    atlas, results = stability_cases.atlas(), stability_cases.results()
    claim = replace(atlas.claim, increasing=("b",), covers=None)
    other = replace(atlas, system=renamed(FALKNER_SKAN, names), claim=claim)
    text = with_complete_list(other, results, conclude(other, values(results)), 3)["statement"]
    assert "Sigma(x) be the stability matrix of the orbit of x" in text


def test_the_box_has_other_letters_where_coordinates_have_its_own() -> None:
    text = words_of(replace(known("fs3"), system=renamed(FALKNER_SKAN, {"x": "x", "y": "c", "z": "p", "beta": "c0"})))
    assert "all points c1 + A p0 with |p0_i| <= R_i, where c1, A and R are" in text
    assert "  c: c1 is 0.93" in text
    assert "x is a point of the section where it is called one" in text
    assert "is called one" not in words_of(known("em2"))


LOSSES = ("x", "y", "w", "kappa"), ("mu",)
COLLISIONS = ("x", "y", "z", "mu", "K", "d"), ("a", "b", "s_1")
"""Coordinates and parameters that are called as numbers of these normal forms are."""


@pytest.mark.parametrize("kind", ["loss", "subcritical", "supercritical"])
def test_letters_of_normal_forms_are_no_names_of_the_system(kind: str) -> None:
    candidate, (state, parameters) = (
        (breaking_cases.modes(), LOSSES) if kind == "loss" else (krein_cases.clock(), COLLISIONS)
    )
    system = candidate.system
    names = dict(zip((*system.state, *system.parameters, *system.symmetries), (*state, *parameters, "S"), strict=False))
    hostile = replace(
        candidate,
        system=renamed(system, names),
        parameters={names[name]: value for name, value in candidate.parameters.items()},
    )
    ball, point = arb(2, 0.25), dict.fromkeys(hostile.system.centre_coordinates, arb(1, 0.25))
    found: Any = SimpleNamespace(
        point=point, other_point=point, parameter=ball, period=ball, side="above", direction=dict.fromkeys(state, ball),
        opening=ball, cosine=ball, rotation_number=ball, speed=ball, unfolding=ball, coefficient=ball, type=kind,
    )  # fmt: skip
    if kind == "loss":
        (form,) = (line for line in breaking_found(hostile, found) if line.startswith("They leave"))
        assert "along the vector w0" in form
        assert "by kappa0 y0^2 + O(y0^4), kappa0 in [" in form
        form = re.sub(r"with .*?\]: ", "", form)
    else:
        *_, form, last = krein_found(hostile, found)
        assert "z0 -> lambda (z0 + y0 + ..), y0 -> lambda (y0 + a0 mu0 z0 + b0 z0 |z0|^2 + ..)" in form
        form = f"{form} {last}".replace("within a constant", "").replace("There is a neighbourhood", "")
        form = form.replace("a constant", "")
        assert "The coefficient b0 of the normal form" in krein_in_words(KreinTheorem(hostile))
        assert names_in_words(hostile.system)["s_1"] == "s_1_parameter"
    assert not {*state, *parameters}.difference("x").intersection(re.findall(r"\w+", form))


def test_titles_are_no_symbols_either() -> None:
    system = replace(renamed(CR3BP, {name: name for name in (*CR3BP.state, "mu", "S")}), first_integral_name="P")
    assert "the parameter being the first integral" in words_of(replace(known("em2"), system=system))
    named = replace(system, first_integral_name="H")
    assert "the parameter being the first integral H" in words_of(replace(known("em2"), system=named))


@pytest.mark.parametrize("names", [("H", "H_coordinate"), ("P", "P_coordinate_coordinate"), ("p_1", "p_1_coordinate")])
def test_no_two_names_become_the_same(names: tuple[str, str]) -> None:
    system = renamed(FALKNER_SKAN, {"x": "x", "y": names[0], "z": names[1], "beta": "beta"})
    written = names_in_words(system)
    assert len({written.get(name, name) for name in system.state}) == 3


def test_systems_that_every_installation_knows_have_no_such_names() -> None:
    for system in (CR3BP, FALKNER_SKAN):
        assert names_in_words(system) == {}


def test_a_symmetry_is_called_as_nothing_else() -> None:
    entry = {
        "name": "two", "state": "x y vx vy", "field": {"x": "vx", "y": "vy", "vx": "-x", "vy": "-y"},
        "R": {"vx": -1, "vy": -1}, "section": "vx", "first_integral": "x**2 + y**2 + vx**2 + vy**2",
        "symmetries": {"y": {"y": -1, "vy": -1}},
    }  # fmt: skip
    with pytest.raises(DescriptionError, match="'y' appears twice"):
        described(entry)
    assert described({**entry, "symmetries": {"S": {"y": -1, "vy": -1}}}).symmetries
