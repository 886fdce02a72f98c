"""False claims about real systems: each differs from a true one in one respect, and that one is refused by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

import pytest
from support.claims import (
    ACCURACY,
    EARTH_MOON,
    NAMES,
    SUN_JUPITER,
    distances,
    known,
    moved,
    to_the_end,
    verdict_of,
    with_radii,
)

import orbitproof.verify.flow.step
import orbitproof.verify.theorems.bifurcation
from orbitproof.shared import InputError
from orbitproof.shared.claims import Candidate
from orbitproof.shared.formats import candidate_from_json, candidate_to_json
from orbitproof.shared.systems import CR3BP, FALKNER_SKAN, ReversibleSystem
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Integrator, certify, recheck
from orbitproof.verify.certificate.kinds import enclose

BITS = 256
"""Enough for every true claim here, as the first test shows, so that precision is not what the false ones lack."""


def refusal(claim: Candidate, bits: int = BITS, level: str = "coordinates", integrate: Integrator = enclose) -> str:
    """The condition that is not shown; fails if the claim is proved. `level` is that of `Limits`."""
    certificate = certify(claim, Limits(max_precision=bits, level=level), integrate=integrate)
    assert certificate.verdict == "not proved"
    assert certificate.parameter is None
    return verdict_of(certificate)


def refused_with(condition: str, claim: Candidate, bits: int = BITS) -> bool:
    """Whether this condition refuses a claim that is followed to the end, and it or two half returns do otherwise."""
    return (
        refusal(claim, bits) in (condition, "multiplicity") and refusal(claim, bits, integrate=to_the_end) == condition
    )


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=pytest.mark.slow if name in ("em2", "em3", "em4") else ()) for name in NAMES],
)
def test_the_true_claim_is_proved_and_encloses_the_known_point(name: str) -> None:
    claim = known(name)
    certificate = certify(claim, Limits(max_precision=BITS))
    assert verdict_of(certificate) == "proved"
    assert max(distances(certificate, claim.centre)) <= ACCURACY


def claimed(name: str, k: int, kind: str = "period_tupling", radii: str | None = None) -> Candidate:
    """A known point under a wrong label, with the radii that a true claim of that kind has elsewhere."""
    claim = replace(known(name), k=k, kind=kind, symmetry=None)
    return claim if radii is None else replace(claim, radii=known(radii).radii)


def with_entry(matrix: Sequence[Sequence[Fraction]], i: int, j: int, value: Fraction) -> Any:
    """The matrix with one entry replaced."""
    rows = [list(row) for row in matrix]
    rows[i][j] = value
    return tuple(tuple(row) for row in rows)


def about(name: str, system: ReversibleSystem, **changes: Any) -> Candidate:
    """A claim about a system with some of its description replaced."""
    return replace(known(name), system=replace(system, **changes))


def last_bit(sign: int) -> dict[str, Fraction]:
    """The double next to the mass parameter of the Earth-Moon system."""
    assert float(EARTH_MOON["mu"] + sign * Fraction(1, 2**59)) != float(EARTH_MOON["mu"])
    return {"mu": EARTH_MOON["mu"] + sign * Fraction(1, 2**59)}


def falkner_skan_with(factor: Fraction) -> Any:
    """The Falkner-Skan equation with a factor at x''."""

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        x, y, z = state
        (beta,) = parameters
        return (y, z, beta * (y * y - 1) - factor * (x * z))

    return field


def without_symmetry(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    slope = FALKNER_SKAN.vector_field(state, parameters)
    return (*slope[:2], slope[2] + Fraction(1, 10**300) * state[0])


def uneven(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    assert CR3BP.first_integral is not None
    return (CR3BP.first_integral(state, parameters)[0] + state[2],)


def rounded(claim: Candidate) -> Candidate:
    """However small the box, a centre rounded to 24 digits is off the family by 1e-25 or so."""
    centre = tuple(Fraction(round(value * 10**24), 10**24) for value in claim.centre)
    return replace(claim, centre=centre, radii=(Fraction(1, 10**40), Fraction(1, 10**30)))


FS, EM = ("fs2", "fs3", "fs4", "fs5"), ("em1", "em2", "em3", "em4")
LITTLE = Fraction(1, 10**300)
FOLLOWED: list[tuple[Candidate, str, bool]] = [
    # Another multiplicity, and touch-and-go bifurcations elsewhere.
    *((claimed(name, k, radii=radii), condition, False) for name, k, radii, condition in (
        ("fs4", 2, "fs2", "C3"), ("fs2", 4, "fs4", "regular-2"), ("fs3", 4, "fs4", "regular-3"),
        ("fs4", 5, "fs5", "regular-4"),
    )),
    *((claimed(name, k, radii=radii), condition, True) for name, k, radii, condition in (
        ("fs5", 2, "fs2", "C3"), ("fs3", 2, "fs2", "C3"), ("fs3", 6, "fs4", "regular-3"),
        ("fs3", 5, "fs5", "regular-3"), ("fs5", 4, "fs4", "C3"), ("fs2", 6, "fs4", "regular-2"),
        ("fs2", 5, "fs5", "regular-2"), ("fs2", 8, "fs4", "regular-2"), ("fs4", 8, "fs4", "regular-4"),
        ("em4", 2, "em4", "HC2"), ("em2", 4, "em2", "regular-2"), ("em3", 2, "em2", "HC2"), ("em1", 2, "em2", "family"),
    )),
    *((claimed(name, 3, "touch_and_go", f"{name[:2]}3"), condition, name == "em2") for name, condition in (
        ("fs2", "regular-2"), ("fs4", "C3"), ("fs5", "C3"), ("em2", "regular-2")
    )),
    # A box off the point, in each of its directions.
    *((moved(known(name), direction, shift), condition, (name, shift) != ("fs2", Fraction(11, 10)))
      for name in FS for shift in (-5, -2, Fraction(-11, 10), Fraction(11, 10), 2, 5)
      for direction, condition in enumerate(("C3", "family"))),
    *((moved(known(name), direction, shift), condition, True)
      for name in EM[1:] for shift in (-2, 2) for direction, condition in enumerate(("HC3", "family", "family"))),
]  # fmt: skip
"""Claims, what is not shown of them, and whether that takes long."""


def labelled(cases: Sequence[tuple[Candidate, str, bool]]) -> list[Any]:
    return [
        pytest.param(claim, said, id=f"{claim.id} {number} {said}", marks=pytest.mark.slow if is_long else ())
        for number, (claim, said, is_long) in enumerate(cases)
    ]


@pytest.mark.parametrize(("claim", "condition"), labelled(FOLLOWED))
def test_another_multiplicity_and_a_box_off_the_point_are_not_proved(claim: Candidate, condition: str) -> None:
    """Nor if they are followed to the end."""
    assert refused_with(condition, claim)


E1 = known("em1")
FALSE: list[tuple[Candidate, str, bool]] = [
    *((replace(known(name), kind="touch_and_go"), "theorem", False) for name in ("fs2", "fs4", "fs5", "em2", "em4")),
    # A tupling of order 3 without a symmetry that fixes the orbit, and symmetries that are none or not named.
    *((replace(known(name), kind="period_tupling", symmetry=symmetry), "adapted-frames", False)
      for name in ("fs3", "em3") for symmetry in (None, *known(name).system.symmetries)),
    (replace(E1, symmetry=None), "adapted-frames", False),
    (replace(known("fs2"), k=1, kind="symmetry_breaking"), "adapted-frames", False),
    *((replace(known(name), k=1, kind="symmetry_breaking", symmetry="S"), "adapted-frames", False) for name in EM[1:]),
    (about("em1", CR3BP, symmetries={"S": (1, 1, -1, 1, 1, 1)}), "symmetries", False),
    (about("em1", CR3BP, first_integral=uneven), "symmetries", False),
    (about("fs2", FALKNER_SKAN, vector_field=without_symmetry), "symmetries", False),
    # Another vector field, the last so close that the family stays in the box, and only the bifurcation leaves it.
    *((about(name, FALKNER_SKAN, vector_field=falkner_skan_with(1 + difference)), condition, False)
      for name, difference, condition in (
          ("fs2", Fraction(1), "family"), ("fs3", Fraction(1, 10**6), "family"), ("fs2", Fraction(-1, 10**15), "C3"))),
    *((replace(known(name), parameters=last_bit(1)), "family", True) for name in EM[1:]),
    # Frames that are almost adapted, singular, or not those of the parameter.
    *((replace(E1, frame=with_entry(E1.frame, i, j, LITTLE)), "adapted-frames", False)
      for i, j in ((0, 1), (2, 1), (1, 0), (1, 2))),
    *((replace(E1, kernel_frame=with_entry(E1.kernel_frame, i, i, LITTLE)), "adapted-frames", False) for i in (0, 1)),
    (moved(E1, 1, LITTLE), "adapted-frames", False),
    *((replace(known(name), kernel_frame=tuple((0 * row[0],) * len(row) for row in known(name).kernel_frame)), "frames",
       False) for name in ("fs2", "fs3", "em1", "em2")),
    *((replace(known("fs2"), frame=(row, known("fs2").frame[1])), "frames", False)
      for row in ((Fraction(2), Fraction(0)), (Fraction(1), LITTLE))),
    (replace(known("em2"), kernel_frame=known("em2").kernel_frame[::-1]), "HC2", True),
    (replace(known("em2"), frame=tuple((a, c, b) for a, b, c in known("em2").frame)), "HC2", True),
    (replace(known("em2"), frame=tuple((b, a, c) for a, b, c in known("em2").frame)), "family", True),
    # Boxes far too large, and smaller than the error of their centre.
    *((with_radii(known(name), 2**40), "HC2" if name == "em1" else "C3", False) for name in (*FS[:3], "em1")),
    *((replace(known(name), radii=(Fraction(1), Fraction(1))), "tube crossing count", False) for name in FS[:3]),
    *((rounded(known(name)), "family", False) for name in FS[:3]),
]  # fmt: skip


@pytest.mark.parametrize(("claim", "condition"), labelled(FALSE))
def test_a_claim_that_is_false_in_one_respect_is_not_proved(claim: Candidate, condition: str) -> None:
    assert refusal(claim) in condition


def singular(name: str) -> Candidate:
    claim = known(name)
    size = len(claim.radii)
    return replace(claim, frame=tuple(tuple(row[min(j, size - 2)] for j in range(size)) for row in claim.frame))


BY_LEVEL: list[tuple[Candidate, str, bool]] = [
    *((moved(E1, direction, shift), f"{condition}; adapted-frames candidate-box C2 C3", (shift, direction) != (2, 0))
      for shift in (-3, 2) for direction, condition in enumerate(("HC3", "adapted-frames", "HC2"))),
    (replace(E1, frame=with_entry(E1.frame, 2, 1, Fraction(1, 10**12))), "adapted-frames; adapted-frames", False),
    *((singular(name), "frames; frames", False) for name in ("fs2", "fs3", "em1", "em2")),
    *((replace(E1, parameters=mass), "HC2; C2", mass != last_bit(1))
      for mass in (SUN_JUPITER, last_bit(-1), last_bit(1))),
]  # fmt: skip


@pytest.mark.parametrize(("claim", "conditions"), labelled(BY_LEVEL))
def test_nor_is_it_proved_with_the_first_integral_as_a_coordinate(claim: Candidate, conditions: str) -> None:
    first, second = conditions.split("; ")
    assert refusal(claim) == first
    assert refusal(claim, level="integral" if claim.system is CR3BP else "auto") in second


def test_a_point_on_the_edge_of_the_box_is_refused_in_one_attempt() -> None:
    claim = known("em1")
    certificate = certify(moved(claim, 0, 1))
    assert verdict_of(certificate) == "candidate-box"
    assert certificate.computation.attempts == certify(claim).computation.attempts == 1


@pytest.mark.parametrize("i, j, size", [(0, 1, Fraction(1, 10**300)), (2, 1, Fraction(1, 10**30)), (1, 2, Fraction(1))])
def test_almost_adapted_frames_are_proved_only_by_the_adapted_ones_of_the_level_form(
    i: int, j: int, size: Fraction
) -> None:
    """The verifier's own box contains the candidate's, and its frame is adapted exactly; the point lies in both."""
    claim = known("em1")
    claim = replace(claim, frame=with_entry(claim.frame, i, j, size))
    certificate = certify(claim, Limits(max_precision=BITS))
    assert verdict_of(certificate) == "proved"
    assert recheck(certificate).stands
    form = candidate_from_json(certificate.statement["level_form"], "level form")
    odd = [form.coordinates.index("z")]
    assert all((value != 0) == ((i in odd) == (j == 1)) or value == 0 for i, row in enumerate(form.frame)
               for j, value in enumerate(row))  # fmt: skip
    assert max(distances(certificate, claim.centre)) <= ACCURACY


def test_a_mass_parameter_off_by_much_less_than_the_box_leaves_the_claim_true() -> None:
    """The point moves by about ten times the change (by 1e-17 for the last bit), which leaves it in the box."""
    claim = known("em1")
    change = min(claim.radii) / 2**8
    certificate = certify(replace(claim, parameters={"mu": EARTH_MOON["mu"] + change}), Limits(max_precision=BITS))
    assert verdict_of(certificate) == "proved"
    assert max(distances(certificate, claim.centre)) < 20 * change < min(claim.radii)


def test_numbers_of_one_system_given_for_another_are_bad_input() -> None:
    entry = candidate_to_json(known("fs2"))
    entry.update(system="cr3bp", parameters=candidate_to_json(known("em1"))["parameters"])
    with pytest.raises(InputError, match="centre"):
        candidate_from_json(entry, "candidates.json")


# How often a claim is tried.


@pytest.mark.parametrize(
    "claim, said",
    [
        (claimed("fs2", 4, radii="fs4"), "owes nothing to rounding"),
        (moved(known("fs3"), 0, 1 + Fraction(1, 10**5)), "owes nothing to rounding"),
        (with_radii(known("fs2"), 2**40), "owes nothing to rounding"),
        (moved(known("em1"), 0, 1 + Fraction(1, 10**5)), "no other in the larger box"),
        (replace(known("em1"), parameters=SUN_JUPITER), "there is no such point in the box"),
    ],
    ids=["k", "sliver", "wide box", "sliver beside the larger box", "mass"],
)
def test_what_more_precision_cannot_change_is_refused_at_once(claim: Candidate, said: str) -> None:
    certificate = certify(claim)
    assert certificate.verdict == "not proved"
    assert said in certificate.reason.message
    assert certificate.computation.attempts == 1


QUICKLY_RAISED = {("fs2", 64), ("fs4", 120), ("em1", 96)}
"""One beginning for each; all others in the slow tests."""


@pytest.mark.parametrize(
    ("name", "bits"),
    [
        pytest.param(name, bits, marks=() if (name, bits) in QUICKLY_RAISED else pytest.mark.slow)
        for name in ("fs2", "fs3", "fs4", "em1")
        for bits in (64, 96, 120)
    ],
)
def test_what_fails_for_want_of_precision_is_tried_again_until_it_is_proved(
    name: str, bits: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(orbitproof.verify.theorems.bifurcation, "first_precision", lambda *args: bits)
    certificate = certify(known(name), Limits(max_precision=512))
    assert verdict_of(certificate) == "proved"
    assert certificate.computation.attempts > 1


def test_an_integration_that_comes_no_farther_with_more_precision_is_given_up() -> None:
    wide = replace(known("fs2"), radii=(Fraction(1), Fraction(1)))
    certificate = certify(wide, Limits(max_precision=4096))
    assert certificate.verdict == "not proved"
    assert certificate.computation.attempts == 2
