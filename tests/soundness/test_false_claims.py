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


def test_a_point_on_the_edge_of_the_box_is_refused_in_one_attempt() -> None:
    claim = known("em1")
    certificate = certify(moved(claim, 0, 1))
    assert verdict_of(certificate) == "candidate-box"
    assert certificate.computation.attempts == certify(claim).computation.attempts == 1


@pytest.mark.parametrize(
    "name, k, radii, condition",
    [
        ("fs4", 2, "fs2", "C3"),
        ("fs2", 4, "fs4", "regular-2"),
        ("fs3", 4, "fs4", "regular-3"),
        ("fs4", 5, "fs5", "regular-4"),
    ],
)
def test_wrong_multiplicity_is_not_proved(name: str, k: int, radii: str, condition: str) -> None:
    assert refused_with(condition, claimed(name, k, radii=radii), 192)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, k, radii, condition",
    [
        ("fs5", 2, "fs2", "C3"),
        ("fs3", 2, "fs2", "C3"),
        ("fs3", 6, "fs4", "regular-3"),
        ("fs3", 5, "fs5", "regular-3"),
        ("fs5", 4, "fs4", "C3"),
        ("fs2", 6, "fs4", "regular-2"),
        ("fs2", 5, "fs5", "regular-2"),
        ("fs2", 8, "fs4", "regular-2"),
        ("fs4", 8, "fs4", "regular-4"),
    ],
)
def test_further_wrong_multiplicities_are_not_proved(name: str, k: int, radii: str, condition: str) -> None:
    assert refused_with(condition, claimed(name, k, radii=radii))


@pytest.mark.parametrize(
    "name, condition", [("fs2", "regular-2"), ("fs4", "C3"), ("fs5", "C3")]
)  # fmt: skip
def test_touch_and_go_of_order_three_elsewhere_is_not_proved(name: str, condition: str) -> None:
    assert refused_with(condition, claimed(name, 3, "touch_and_go", "fs3"))


@pytest.mark.parametrize("name", ["fs2", "fs4", "fs5", "em2", "em4"])
def test_touch_and_go_claimed_for_another_multiplicity_has_no_theorem(name: str) -> None:
    assert refusal(replace(known(name), kind="touch_and_go")) == "theorem"


@pytest.mark.parametrize("name", ["fs3", "em3"])
def test_period_tupling_claimed_for_three_is_not_proved_without_a_symmetry_that_fixes_the_orbit(name: str) -> None:
    claim = replace(known(name), kind="period_tupling")
    assert refusal(claim) == "adapted-frames"
    for symmetry in claim.system.symmetries:
        assert refusal(replace(claim, symmetry=symmetry)) == "adapted-frames"


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, k, kind, condition",
    [
        ("em4", 2, "period_tupling", "HC2"),
        ("em2", 4, "period_tupling", "regular-2"),
        ("em2", 3, "touch_and_go", "regular-2"),
        ("em3", 2, "period_tupling", "HC2"),
        ("em1", 2, "period_tupling", "family"),
    ],
)
def test_wrong_multiplicity_in_the_three_body_problem_is_not_proved(
    name: str, k: int, kind: str, condition: str
) -> None:
    radii = {"em3": "em2", "em1": "em2"}.get(name, name) if kind == "period_tupling" else "em3"
    assert refused_with(condition, claimed(name, k, kind, radii), 192)


@pytest.mark.parametrize(("name", "shift"), [("fs2", Fraction(11, 10)), ("fs3", -5)])
def test_a_box_off_the_point_is_not_proved(name: str, shift: Fraction | int) -> None:
    for direction, condition in enumerate(("C3", "family")):
        assert refused_with(condition, moved(known(name), direction, shift))


@pytest.mark.slow
@pytest.mark.parametrize("shift", [-5, -2, Fraction(-11, 10), Fraction(11, 10), 2, 5])
@pytest.mark.parametrize("name", ["fs2", "fs3", "fs4", "fs5"])
def test_a_box_off_the_point_on_either_side_is_not_proved(name: str, shift: Fraction | int) -> None:
    test_a_box_off_the_point_is_not_proved(name, shift)


@pytest.mark.parametrize("shift", [pytest.param(-3, marks=pytest.mark.slow), 2])
def test_a_box_off_the_symmetry_breaking_is_not_proved(shift: int) -> None:
    for direction, condition in enumerate(("HC3", "adapted-frames", "HC2")):
        claim = moved(known("em1"), direction, shift)
        assert refusal(claim) == condition
        assert refusal(claim, level="integral") in ("adapted-frames", "candidate-box", "C2", "C3")


@pytest.mark.slow
@pytest.mark.parametrize("shift", [-2, 2])
@pytest.mark.parametrize("name, conditions", [(name, ("HC3", "family", "family")) for name in ("em2", "em3", "em4")])
def test_a_box_off_the_point_in_the_three_body_problem_is_not_proved(
    name: str, conditions: Sequence[str], shift: int
) -> None:
    for direction, condition in enumerate(conditions):
        assert refused_with(condition, moved(known(name), direction, shift))


def test_symmetry_breaking_without_a_symmetry_is_not_proved() -> None:
    assert refusal(replace(known("em1"), symmetry=None)) == "adapted-frames"
    assert refusal(replace(known("fs2"), k=1, kind="symmetry_breaking")) == "adapted-frames"


@pytest.mark.parametrize("name", ["em2", "em3", "em4"])
def test_symmetry_breaking_at_a_point_without_the_symmetry_is_not_proved(name: str) -> None:
    assert refusal(replace(known(name), k=1, kind="symmetry_breaking", symmetry="S")) == "adapted-frames"


def with_entry(matrix: Sequence[Sequence[Fraction]], i: int, j: int, value: Fraction) -> Any:
    """The matrix with one entry replaced."""
    rows = [list(row) for row in matrix]
    rows[i][j] = value
    return tuple(tuple(row) for row in rows)


@pytest.mark.parametrize("i, j", [(0, 1), (2, 1), (1, 0), (1, 2)])
def test_symmetry_breaking_with_frames_that_are_almost_adapted_is_not_proved(i: int, j: int) -> None:
    claim = known("em1")
    frame = with_entry(claim.frame, i, j, Fraction(1, 10**300))
    assert refusal(replace(claim, frame=frame)) == "adapted-frames"


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


def test_a_frame_off_by_more_than_the_adapted_box_can_hold_is_not_proved() -> None:
    claim = known("em1")
    claim = replace(claim, frame=with_entry(claim.frame, 2, 1, Fraction(1, 10**12)))
    for level in ("coordinates", "auto", "integral"):
        assert refusal(claim, level=level) == "adapted-frames"


@pytest.mark.parametrize("i, j", [(0, 0), (1, 1)])
def test_symmetry_breaking_with_a_kernel_frame_that_is_almost_adapted_is_not_proved(i: int, j: int) -> None:
    claim = known("em1")
    assert claim.kernel_frame[i][j] == 0
    frame = with_entry(claim.kernel_frame, i, j, Fraction(1, 10**300))
    assert refusal(replace(claim, kernel_frame=frame)) == "adapted-frames"


def test_symmetry_breaking_off_the_symmetric_plane_by_very_little_is_not_proved() -> None:
    assert refusal(moved(known("em1"), 1, Fraction(1, 10**300))) == "adapted-frames"


def test_the_other_mass_parameter_is_not_proved() -> None:
    assert refusal(replace(known("em1"), parameters=SUN_JUPITER)) == "HC2"
    assert refusal(replace(known("em1"), parameters=SUN_JUPITER), level="integral") == "C2"


def last_bit(sign: int) -> dict[str, Fraction]:
    """The double next to the mass parameter of the Earth-Moon system."""
    return {"mu": EARTH_MOON["mu"] + sign * Fraction(1, 2**59)}


@pytest.mark.parametrize("sign", [pytest.param(-1, marks=pytest.mark.slow), 1])
def test_a_mass_parameter_off_by_its_last_bit_is_not_proved(sign: int) -> None:
    assert float(last_bit(sign)["mu"]) != float(EARTH_MOON["mu"])
    assert refusal(replace(known("em1"), parameters=last_bit(sign))) == "HC2"
    assert refusal(replace(known("em1"), parameters=last_bit(sign)), level="integral") == "C2"


@pytest.mark.slow
@pytest.mark.parametrize("name, condition", [("em2", "family"), ("em3", "family"), ("em4", "family")])
def test_a_mass_parameter_off_by_its_last_bit_is_not_proved_for_longer_orbits(name: str, condition: str) -> None:
    assert refusal(replace(known(name), parameters=last_bit(1))) == condition


def test_a_mass_parameter_off_by_much_less_than_the_box_leaves_the_claim_true() -> None:
    """The point moves by about ten times the change (by 1e-17 for the last bit), which leaves it in the box."""
    claim = known("em1")
    change = min(claim.radii) / 2**8
    certificate = certify(replace(claim, parameters={"mu": EARTH_MOON["mu"] + change}), Limits(max_precision=BITS))
    assert verdict_of(certificate) == "proved"
    assert max(distances(certificate, claim.centre)) < 20 * change < min(claim.radii)


def altered(system: ReversibleSystem, **changes: Any) -> ReversibleSystem:
    """A system with some of its description replaced."""
    return replace(system, **changes)


def falkner_skan_with(factor: Fraction) -> Any:
    """The Falkner-Skan equation with a factor at x''."""

    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        x, y, z = state
        (beta,) = parameters
        return (y, z, beta * (y * y - 1) - factor * (x * z))

    return field


@pytest.mark.parametrize(
    "name, difference, condition",
    [("fs2", Fraction(1), "family"), ("fs3", Fraction(1, 10**6), "family"), ("fs2", Fraction(-1, 10**15), "C3")],
)
def test_another_vector_field_is_not_proved(name: str, difference: Fraction, condition: str) -> None:
    """The last one is so close that the family stays in the box, and only the bifurcation leaves it."""
    system = altered(FALKNER_SKAN, vector_field=falkner_skan_with(1 + difference))
    assert refusal(replace(known(name), system=system)) == condition


def test_a_field_without_the_reversing_symmetry_is_not_proved() -> None:
    def field(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        slope = FALKNER_SKAN.vector_field(state, parameters)
        return (*slope[:2], slope[2] + Fraction(1, 10**300) * state[0])

    assert refusal(replace(known("fs2"), system=altered(FALKNER_SKAN, vector_field=field))) == "symmetries"


def test_a_symmetry_that_the_system_does_not_have_is_not_proved() -> None:
    system = altered(CR3BP, symmetries={"S": (1, 1, -1, 1, 1, 1)})
    assert refusal(replace(known("em1"), system=system)) == "symmetries"


def test_a_first_integral_without_the_symmetry_is_not_proved() -> None:
    integral = CR3BP.first_integral
    assert integral is not None

    def uneven(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
        return (integral(state, parameters)[0] + state[2],)

    assert refusal(replace(known("em1"), system=altered(CR3BP, first_integral=uneven))) == "symmetries"


def test_numbers_of_one_system_given_for_another_are_bad_input() -> None:
    entry = candidate_to_json(known("fs2"))
    entry.update(system="cr3bp", parameters=candidate_to_json(known("em1"))["parameters"])
    with pytest.raises(InputError, match="centre"):
        candidate_from_json(entry, "candidates.json")


@pytest.mark.parametrize("name", ["fs2", "fs3", "em1", "em2"])
def test_singular_frames_are_not_proved(name: str) -> None:
    claim = known(name)
    size = len(claim.radii)
    frame = tuple(tuple(row[min(j, size - 2)] for j in range(size)) for row in claim.frame)
    for level in ("coordinates", "auto"):
        assert refusal(replace(claim, frame=frame), level=level) == "frames"
    kernel = tuple(tuple(Fraction(0) for _ in row) for row in claim.kernel_frame)
    assert refusal(replace(claim, kernel_frame=kernel)) == "frames"


@pytest.mark.parametrize("row", [(Fraction(2), Fraction(0)), (Fraction(1), Fraction(1, 10**300))])
def test_a_frame_in_which_p_0_is_not_the_parameter_is_not_proved(row: tuple[Fraction, ...]) -> None:
    claim = known("fs2")
    assert refusal(replace(claim, frame=(row, claim.frame[1]))) == "frames"


@pytest.mark.slow
def test_frames_with_directions_exchanged_are_not_proved() -> None:
    claim = known("em2")
    assert refusal(replace(claim, kernel_frame=claim.kernel_frame[::-1]), 192) == "HC2"
    assert refusal(replace(claim, frame=tuple((a, c, b) for a, b, c in claim.frame)), 192) == "HC2"
    assert refusal(replace(claim, frame=tuple((b, a, c) for a, b, c in claim.frame)), 192) == "family"


@pytest.mark.parametrize("name, condition", [("fs2", "C3"), ("fs3", "C3"), ("fs4", "C3"), ("em1", "HC2")])
def test_a_box_far_too_large_is_not_proved(name: str, condition: str) -> None:
    assert refusal(with_radii(known(name), 2**40)) == condition


@pytest.mark.parametrize("name", ["fs2", "fs3", "fs4"])
def test_a_box_of_the_size_of_the_system_is_not_proved(name: str) -> None:
    assert refusal(replace(known(name), radii=(Fraction(1), Fraction(1)))) in ("tube", "crossing count")


@pytest.mark.parametrize("name", ["fs2", "fs3", "fs4"])
def test_a_box_smaller_than_the_error_of_its_centre_is_not_proved(name: str) -> None:
    """However small the box, a centre rounded to 24 digits is off the family by 1e-25 or so."""
    claim = known(name)
    rounded = tuple(Fraction(round(value * 10**24), 10**24) for value in claim.centre)
    tiny = replace(claim, centre=rounded, radii=(Fraction(1, 10**40), Fraction(1, 10**30)))
    assert refusal(tiny) == "family"


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
