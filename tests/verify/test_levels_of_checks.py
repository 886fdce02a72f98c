"""The levels of a check, how stored and new values are compared, and what of a claim is compared at all."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import product
from typing import Any

import pytest
from flint import acb, arb, ctx, fmpq
from hypothesis import given
from hypothesis import strategies as st
from support.claims import known, to_the_end
from support.forgeries import forged
from support.springs import springs

from orbitproof.shared import parse_exact
from orbitproof.shared.errors import InputError
from orbitproof.shared.numbers import format_dyadic
from orbitproof.verify.attempt import more_precision
from orbitproof.verify.bifurcation import BifurcationResults
from orbitproof.verify.certificate import (
    CannotBeCheckedError,
    Certificate,
    Computation,
    Finding,
    Level,
    Limits,
    NothingToCheckError,
    certify,
    climb,
    confirmed,
    contradictions,
    decimals,
    differences,
    make_certificate,
    overlap,
    recheck,
    systems_with,
    tables_from_json,
    tables_to_json,
)
from orbitproof.verify.certificate import rechecking as chapter
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.certificate.stored_balls import to_json as results_to_json
from orbitproof.verify.evidence import (
    DerivativeTable,
    IntegrationFailure,
    NotProved,
    Proved,
    Reason,
    as_found,
    ball_to_json,
    bounds,
    spared,
)
from orbitproof.verify.poincare import Enclosures

# The levels


def _passes(examination: Any) -> Iterator[Finding]:
    examination.hypotheses += 1
    yield from ()


def _finds(examination: Any) -> Iterator[Finding]:
    yield Finding("here", "something")


def _raising(error: Exception) -> Callable[[Any], Iterator[Finding]]:
    def step(examination: Any) -> Iterator[Finding]:
        yield from ()
        raise error

    return step


STEPS = {
    "passes": (_passes, None),
    "finds": (_finds, "here: something"),
    "cannot": (_raising(CannotBeCheckedError("no such system")), "no such system"),
    "memory": (_raising(MemoryError()), "there is not enough memory to check it; give `memory` more, or fewer `jobs`"),
    "value": (_raising(ValueError("no number")), "the certificate: no number"),
    "defect": (_raising(RuntimeError("a defect")), "the check: the check broke off: RuntimeError: 'a defect'"),
    "silent": (_raising(AssertionError()), "the check: the check broke off: AssertionError"),
}


DOCUMENT = {"id": "c", "verdict": "proved"}


@pytest.mark.parametrize("name", STEPS)
def test_a_level_that_is_not_passed_is_the_last_and_nothing_stands(name: str) -> None:
    step, why = STEPS[name]
    for before in range(3):
        found = climb(DOCUMENT, [*[_passes] * before, step, *[_passes] * (2 - before)])
        assert found.level == (before if why else 3)
        assert found.hypotheses == (before if why else 3)
        assert found.stands == found.stands_without_place == (why is None)
        assert found.why == (why or "")
        assert found.word != "stands" or why is None


def test_a_level_with_nothing_to_look_at_is_not_passed() -> None:
    found = climb(DOCUMENT, [_passes, _raising(NothingToCheckError("nothing is stored")), _passes])
    assert (found.level, found.notes, found.stands) == (Level.FORM, ("nothing is stored",), True)


# Values


def test_values_are_the_same_only_if_all_of_them_and_their_types_are() -> None:
    leaves: list[Any] = [None, False, True, 0, 1, 0.0, 1.0, "", "0", "a", [], {}]
    values = [
        *leaves, *([leaf] for leaf in leaves), *({"x": leaf} for leaf in leaves), *({"y": leaf} for leaf in leaves[:3]),
        *([0, leaf] for leaf in leaves), *([{"x": leaf}] for leaf in leaves),
        *({"x": 0, "y": [leaf]} for leaf in leaves),
    ]  # fmt: skip
    for left, right in product(values, repeat=2):
        texts = [json.dumps(value, sort_keys=True) for value in (left, right)]
        assert bool(list(differences(left, copy.deepcopy(right), "place"))) == (texts[0] != texts[1])


def test_a_ball_is_one_value() -> None:
    ball = {"mid": "0x1", "rad": "0x0", "decimal": "[1, 1]"}
    (finding,) = differences({"a": [ball]}, {"a": [{**ball, "decimal": "[1, 2]"}]}, "")
    assert finding.place == "a[0]"


def test_decimals_are_looked_at_wherever_a_ball_stands() -> None:
    ball = ball_to_json(arb(1, 0.25))
    value = {"a": [ball, {"b": ball}], "c": "text", "d": 1}
    assert not list(decimals(value, "here"))
    for place, wrong in (
        ("here, a[0]", {"a": [{**ball, "decimal": "[0.8, 1.2]"}]}),
        ("here, a[0], b", {"a": [{"b": {**ball, "decimal": "[0.70, 1.3]"}}]}),
    ):
        assert [finding.place for finding in decimals(wrong, "here")] == [place]


def test_what_was_changed_without_its_digest_is_found(point: Certificate) -> None:
    entry = point.to_json()
    assert not list(chapter.digest_findings(entry))
    for changed in ({**entry, "id": "x"}, {**entry, "digest": "sha256:" + 64 * "0"}, {**entry, "more": 1}):
        assert [finding.place for finding in chapter.digest_findings(changed)] == ["digest"]


def ball(low: Fraction, high: Fraction) -> arb:
    low, high = sorted((low, high))
    (middle, radius) = ((low + high) / 2, (high - low) / 2)
    return arb(fmpq(middle.numerator, middle.denominator), arb(fmpq(radius.numerator, radius.denominator)))


dyadic = st.integers(-(2**30), 2**30).map(lambda n: Fraction(n, 2**20))


@given(dyadic, dyadic, dyadic, dyadic)
def test_enclosures_confirm_and_contradict_each_other_as_intervals_do(a: Any, b: Any, c: Any, d: Any) -> None:
    stored, fresh = ball(a, b), ball(c, d)
    (low, high), (new_low, new_high) = bounds(stored), bounds(fresh)
    apart = new_high < low or high < new_low
    assert bool(list(overlap(stored, fresh, "here"))) == apart
    assert bool(list(confirmed(stored, fresh, "here"))) == (new_low < low or high < new_high)
    # What is exact is confirmed by itself alone.
    assert bool(list(confirmed(ball(a, a), fresh, "here"))) == ((new_low, new_high) != (a, a))


radii = st.integers(0, 2**30 - 1).map(lambda n: Fraction(n, 2**40))


@given(dyadic, radii, st.integers(-900, 20), st.sampled_from([20, 53, 300]))
def test_what_is_stored_is_wider_than_what_was_found_and_is_known_from_it(m: Any, r: Any, e: int, bits: int) -> None:
    one = arb(fmpq(m.numerator, m.denominator), arb(fmpq(r.numerator, r.denominator)) * arb(2) ** e)
    with ctx.workprec(bits):
        wider = spared((one, {"x": DerivativeTable({(0,): one}, {(0,): acb(one, 1)})}, "word", Fraction(1, 3)))
        again = as_found(wider)
        many = spared(one, Fraction(1, 4))
    exact, (ball, tables, *others) = one.rad() == 0, wider
    assert others == ["word", Fraction(1, 3)]
    assert tables["x"].box[0,].real == tables["x"].centre[0,].real == again[1]["x"].box[0,] == ball or not exact
    for stored in (ball, tables["x"].box[0,], tables["x"].centre[0,].real):
        (low, high), (stored_low, stored_high), (found_low, found_high) = map(bounds, (one, stored, as_found(stored)))
        assert (low + high, stored_low + stored_high) == (2 * m, 2 * m)
        assert exact or stored_low < found_low
        assert stored_low <= found_low <= low <= high <= found_high <= stored_high
        assert stored_high - stored_low <= (high - low) * (1 + Fraction(5, 2**20))
        assert found_high - found_low <= (high - low) * (1 + Fraction(1, 2**26))
    assert tables["x"].centre[0,].imag == 1
    assert many.rad() == 0 if exact else Fraction(5, 4) <= ratio(many, one) < Fraction(13, 10)


def ratio(one: arb, other: arb) -> Fraction:
    """Of their widths."""
    (low, high), (other_low, other_high) = bounds(one), bounds(other)
    return (high - low) / (other_high - other_low)


def test_only_what_is_negligible_becomes_several_times_as_wide() -> None:
    """A ball about zero: bounds by floats that underflow are as large with more bits."""
    tiny = Fraction(1, 2**128)
    for ball, many in (
        (arb(0, 2.0**-900), True),
        (arb(2.0**-902, 2.0**-900), True),
        (arb(2.0**-898, 2.0**-900), False),
        (arb(0, 2.0**-128), False),
        (arb(0, 1), False),
    ):
        assert (ratio(spared(ball, negligible=tiny), ball) > 7) is many
    for ball in (arb("nan"), arb("inf"), arb(0, "inf")):
        assert not spared(ball).is_finite()


@pytest.mark.parametrize("value", ["nan", "inf", "[0 +/- inf]"])
def test_what_is_not_finite_confirms_nothing(value: str) -> None:
    for stored, fresh in ((arb(value), arb(1)), (arb(1), arb(value)), (arb(value), arb(value))):
        assert list(confirmed(stored, fresh, "here"))
    assert list(overlap(arb(0, 1), arb(value), "here"))


# What is compared


def moved(value: Any) -> Any:
    """Stored tables with each ball moved by more than its radius."""
    if isinstance(value, str) and " +- " in value:
        middle, radius = (parse_exact(part) for part in value.split(" +- "))
        return " +- ".join(format_dyadic(part) for part in (middle + 3 * radius + 1, radius))
    if isinstance(value, dict):
        return {key: moved(inner) for key, inner in value.items()}
    return list(map(moved, value)) if isinstance(value, list) else value


def test_other_extrema_are_other_tables() -> None:
    _, enclosures = springs("once")
    assert enclosures.distance is not None
    between = tuple(replace(each, kind=-each.kind) for each in enclosures.distance.between)
    for distance in (
        None, replace(enclosures.distance, between=between), replace(enclosures.distance, between=between[1:]),
        replace(enclosures.distance, start_kind=-enclosures.distance.start_kind),
    ):  # fmt: skip
        with pytest.raises(ValueError, match="do not belong to each other"):
            list(contradictions(enclosures, replace(enclosures, distance=distance), "again"))


# Integrations


def test_an_integration_that_breaks_off_is_found(point: Certificate, monkeypatch: pytest.MonkeyPatch) -> None:
    for error in (IntegrationFailure("size", "it is too large", "none"), ValueError("no number")):

        def fails(*_: Any, error: Exception = error) -> Any:
            raise error

        monkeypatch.setattr(chapter, "enclose", fails)
        found = recheck(point, True)
        assert found.level is Level.CONCLUSION
        assert ("it is too large" if isinstance(error, IntegrationFailure) else "no number") in found.why


def test_an_integration_that_does_not_prove_the_claim_again_is_found(
    point: Certificate, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its enclosures contain the stored ones, and are too wide."""
    stated = chapter._read(point.to_json())
    assert isinstance(stated.enclosures, Enclosures)

    def wider(table: Any) -> Any:
        wide = arb(0, 2.0**-20)
        parts = ({index: ball + wide for index, ball in part.items()} for part in (table.box, table.centre))
        return type(table)(*parts)

    iterates = tuple(tuple(map(wider, components)) for components in stated.enclosures.iterates)
    monkeypatch.setattr(chapter, "enclose", lambda *_: replace(stated.enclosures, iterates=iterates))
    found = recheck(point, True)
    assert found.level is Level.CONCLUSION
    assert "the claim is not proved again" in found.why


def test_a_hypothesis_less_of_what_is_not_proved_is_found() -> None:
    claim = replace(known("fs3"), centre=(known("fs3").centre[0] + Fraction(1, 10**8), known("fs3").centre[1]))
    refuted = certify(claim, Limits(max_precision=256), integrate=to_the_end)
    assert not refuted.proved
    assert recheck(refuted).stands
    shorter = Certificate.from_json(forged(refuted.to_json(), lambda d: d["hypotheses"].pop()))
    assert recheck(shorter).level is Level.FORM
    assert any(finding.place == "hypotheses" for finding in recheck(shorter).findings)


# What is read


def test_tables_of_another_kind_or_of_other_sizes_are_not_read(point: Certificate) -> None:
    candidate, enclosures = springs("once")
    computation = Computation(128, 20, 0, 1, 0.0)
    entry, own = tables_to_json(enclosures), point.to_json()["enclosures"]
    assert entry is not None
    for claim, tables in ((candidate, own), (point.candidate, entry)):
        with pytest.raises(ValueError, match="another kind of claim"):
            tables_from_json(tables, claim, computation)
    for number in (1, 4, 9, 11, 20):
        texts = (entry["half_period"]["box"] * 2)[:number]
        changed = {**entry, "half_period": {**entry["half_period"], "box": texts}}
        with pytest.raises(ValueError, match=r"half_period.* derivative"):
            tables_from_json(changed, candidate, computation)
    half_period = {**entry["half_period"], "more": "it is proved"}
    for changed in ({**entry, "more": "it is proved"}, {**entry, "half_period": half_period}):
        with pytest.raises(ValueError, match="enclosures"):
            tables_from_json(changed, candidate, computation)


def test_results_of_another_kind_are_not_read(point: Certificate) -> None:
    candidate, enclosures = springs("once")
    other = chapter._conclude(candidate, 128, enclosures)
    assert isinstance(other, Proved)
    entry = point.to_json()
    with pytest.raises(InputError, match="results: "):
        Certificate.from_json({**entry, "results": results_to_json(other.results)})
    with pytest.raises(InputError, match="results"):
        Certificate.from_json({**entry, "results": {**entry["results"], "period": entry["results"]["parameter"]}})


def unknown(change: Callable[[dict[str, Any]], Any] = lambda statement: None) -> dict[str, Any]:
    """The statement of a claim about a system that is not known here."""
    candidate, _ = springs("once")
    claim = make_certificate(candidate, NotProved(Reason("time", "it is late", "give it more")), COMPUTATION).to_json()[
        "statement"
    ]
    claim["candidate"]["system"] = "somebody-elses"
    change(claim)
    return dict(claim)


COMPUTATION = Computation(64, 16, 1, 1, 0.0)


FUNCTIONS = {
    "fewer inputs": "v0 = x\nreturn v0",
    "another order": "v0 = y\nv1 = x\nv2 = vx\nv3 = vy\nv4 = w\nreturn v0",
    "two values": "v0 = x\nv1 = y\nv2 = vx\nv3 = vy\nv4 = w\nreturn v0, v1",
}


@pytest.mark.parametrize("key", ["first_integral", "squared_distance"])
@pytest.mark.parametrize("text", FUNCTIONS.values(), ids=FUNCTIONS.keys())
def test_functions_of_an_unknown_system_are_those_of_its_state_and_parameters(key: str, text: str) -> None:
    statement = unknown()
    assert systems_with({}, statement, statement["candidate"])["somebody-elses"].state == ("x", "y", "vx", "vy")
    statement = unknown(lambda entry: entry.update({key: text}))
    with pytest.raises(ValueError, match="not a function of state and parameters"):
        systems_with({}, statement, statement["candidate"])


def test_a_known_name_is_the_system_of_that_name() -> None:
    statement = unknown()
    known_systems = {"somebody-elses": springs("once")[0].system}
    assert systems_with(known_systems, statement, statement["candidate"]) is known_systems


def test_a_level_coordinate_that_does_not_follow_is_refused() -> None:
    certificate = certify(known("em1"), Limits(max_precision=256, level="integral"))
    statement = certificate.statement
    for entry in (statement["candidate"], statement["level_form"]):
        entry["system"] = "somebody-elses"
    own = systems_with({}, statement, statement["candidate"])["somebody-elses"]
    assert own.level_coordinate == "vy"
    statement["level_coordinate"] = statement["level_coordinate"].replace(" - ", " + ", 1)
    with pytest.raises(ValueError, match="does not follow"):
        systems_with({}, statement, statement["candidate"])


# How precisely


@pytest.mark.parametrize("digits", [1, 20, 60, 1000])
def test_no_attempt_has_more_bits_than_the_limit(digits: int, point: Certificate) -> None:
    found = BifurcationResults({}, "beta", arb("453.4425868", 2.0**-40), "above", {})
    outcome: Any = Proved.__new__(Proved)
    object.__setattr__(outcome, "results", found)
    missing = kind_of(point.candidate).missing
    for limit in (128, 192, 512, 4096):
        more = more_precision(point.candidate, 120, outcome, None, Limits(max_precision=limit, digits=digits), missing)
        assert more is None or 120 < more <= limit
    assert (
        digits == 1
        or more_precision(point.candidate, 120, outcome, None, Limits(4096, digits=digits), missing) is not None
    )
