"""Whatever a proof is given, a derivative that is missing, not finite, or contradicts another one proves nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any

import pytest
from flint import arb
from support import krein_cases
from support.closed_form_maps import claim, description

from orbitproof.shared.formats import LEVEL, Equation
from orbitproof.verify.bifurcation.conditions import check_enclosures
from orbitproof.verify.double_resonance import ResonanceEnclosures
from orbitproof.verify.double_resonance import proved_double_resonance as double
from orbitproof.verify.evidence import Checklist, DerivativeTable, NotEstablishedError, indices_up_to
from orbitproof.verify.newton import Jet
from orbitproof.verify.orbit import OrbitEnclosures, proved_orbit
from orbitproof.verify.periodic_bifurcation.enclosures import is_complete
from orbitproof.verify.reversor_breaking import BreakingEnclosures, check_half_return
from orbitproof.verify.twist import proved_stable_orbit as room

Check = Callable[[Any], Any]
RADII = (Fraction(1, 8),) * 3


def table(size: int) -> DerivativeTable:
    indices = indices_up_to(size, 3)
    return DerivativeTable({index: arb(1, 0.5) for index in indices}, {index: arb(1, 0.25) for index in indices})


def of_breaking(m: int) -> tuple[Any, Check]:
    candidate = krein_cases.of_family(crossings=m)
    found = BreakingEnclosures(tuple((table(5), table(5)) for _ in range(m)), (table(5), table(5)), table(5), ())
    return found, lambda given: check_half_return(Checklist(), candidate, given)


def of_resonance(m: int) -> tuple[Any, Check]:
    candidate: Any = SimpleNamespace(radii=RADII, kernel_frame=((Fraction(1),),), crossings=m)
    found = ResonanceEnclosures(tuple((table(3),) for _ in range(m)), (table(3), table(3)), table(3), table(3))
    return found, lambda given: double._check_return_map(Checklist(), candidate, given)


def of_orbit(m: int) -> tuple[Any, Check]:
    system = SimpleNamespace(first_integral=1, squared_distance=None)
    candidate: Any = SimpleNamespace(radii=RADII[:2], crossings=m, system=system)
    back = ((arb(1), arb(2)), (arb(3), arb(4)))
    iterates = tuple((table(2),) for _ in range(m))
    found = OrbitEnclosures(iterates, (table(2), table(2)), table(2), table(2), back, None)
    return found, lambda given: proved_orbit._checked(Checklist(), candidate, given)


def of_bifurcation(k: int) -> tuple[Any, Check]:
    candidate = claim(description(2, True), "period_tupling", k + 1, RADII)
    iterates = tuple((table(3), table(3)) for _ in range(k + 1))
    found = SimpleNamespace(iterates=iterates, first_integral=table(3))
    return found, lambda given: check_enclosures(Checklist(), candidate, given.iterates, given.first_integral)


def with_tables(found: Any, name: str, value: Any) -> Any:
    return (
        SimpleNamespace(**{**vars(found), name: value})
        if isinstance(found, SimpleNamespace)
        else replace(found, **{name: value})
    )


def places(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Of all tables."""
    if isinstance(value, DerivativeTable):
        yield path
    elif isinstance(value, tuple):
        for place, each in enumerate(value):
            yield from places(each, (*path, place))


def changed(value: Any, path: tuple[Any, ...], change: Callable[[DerivativeTable], DerivativeTable]) -> Any:
    if not path:
        return change(value)
    return tuple(changed(each, path[1:], change) if i == path[0] else each for i, each in enumerate(value))


def one_less(value: Any, path: tuple[Any, ...]) -> Any:
    """Without the entry there."""
    if len(path) == 1:
        return tuple(each for i, each in enumerate(value) if i != path[0])
    return tuple(one_less(each, path[1:]) if i == path[0] else each for i, each in enumerate(value))


def refused(check: Check, given: Any) -> bool:
    try:
        check(given)
    except NotEstablishedError:
        return True
    return False


@pytest.mark.parametrize("m", [1, 2])
@pytest.mark.parametrize("make", [of_breaking, of_resonance, of_orbit, of_bifurcation])
def test_each_derivative_of_each_function_has_to_be_there(make: Callable[[int], tuple[Any, Check]], m: int) -> None:
    found, check = make(m)
    assert not refused(check, found)
    assert make is of_bifurcation or refused(check, None)
    names = [name for name in vars(found) if any(True for _ in places(getattr(found, name)))]
    assert "iterates" in names
    for name in names:
        value = getattr(found, name)
        for path in places(value):
            inner = value
            for step in path:
                inner = inner[step]
            indices = list(inner.box)
            for part in ("box", "centre"):
                known = getattr(inner, part)
                for index in (indices[0], indices[1], indices[len(indices) // 2], indices[-1]):
                    rest = {each: ball for each, ball in known.items() if each != index}
                    for other in (rest, {**known, index: arb("nan")}, {**known, index: arb(0, "inf")}):
                        given = changed(value, path, lambda t, part=part, other=other: replace(t, **{part: other}))
                        assert refused(check, with_tables(found, name, given)), (name, path, part, index)
                    if make is not of_orbit:
                        far = {**known, index: arb(9)}
                        given = changed(value, path, lambda t, part=part, far=far: replace(t, **{part: far}))
                        assert refused(check, with_tables(found, name, given)), (name, path, part, index)
            if path:
                assert refused(check, with_tables(found, name, one_less(value, path))), (name, path)
    if make is of_orbit:
        for i in range(2):
            for j in range(2):
                rows = [list(row) for row in found.back]
                rows[i][j] = arb("nan")
                assert refused(check, replace(found, back=tuple(map(tuple, rows))))
            assert refused(check, replace(found, back=(found.back[0],)))
            assert refused(check, replace(found, back=tuple(row[: 2 - (k == i)] for k, row in enumerate(found.back))))
        assert refused(check, replace(found, first_integral=None))


def test_a_table_of_a_return_is_complete_with_every_derivative_and_no_other() -> None:
    whole, indices = table(3), indices_up_to(3, 3)
    assert is_complete(whole, indices)
    assert not is_complete(whole, indices_up_to(3, 2))
    for part in ("box", "centre"):
        known = getattr(whole, part)
        for index in indices:
            rest = {each: ball for each, ball in known.items() if each != index}
            for other in (rest, {**known, index: arb("nan")}, {**known, index: arb(0, "inf")}):
                assert not is_complete(replace(whole, **{part: other}), indices), (part, index)


def test_a_derivative_that_may_be_singular_shows_no_orbit() -> None:
    """All of whose entries are 1 +- 1/2."""
    found, _ = of_orbit(1)
    candidate: Any = SimpleNamespace(radii=RADII[:2], crossings=1, equation=Equation(LEVEL, Fraction(1)))
    with pytest.raises(NotEstablishedError, match="the derivative may be singular in the box") as error:
        proved_orbit._check_newton(Checklist(), candidate, found)
    assert error.value.reason.condition == "orbit"


@pytest.mark.parametrize("bad", [(0, (1, 0)), (0, (0, 3)), (1, (1, 0)), (1, (2, 1))])
def test_each_derivative_of_the_full_return_of_a_stable_orbit_is_finite(
    bad: tuple[int, tuple[int, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    jets = [Jet(2, 3, {index: arb(1) for index in indices_up_to(2, 3)}) for _ in range(2)]
    half = SimpleNamespace(is_complete=lambda n, has_integral: True)
    claimed: Any = SimpleNamespace(system=SimpleNamespace(first_integral=1))
    found: Any = SimpleNamespace(half_return=half)
    monkeypatch.setattr(room, "half_return_jets", lambda *rest: None)
    monkeypatch.setattr(room, "full_return_jets", lambda *rest: tuple(jets))
    assert room._check_return(Checklist(), claimed, found) == tuple(jets)
    half.is_complete = lambda n, has_integral: False
    with pytest.raises(NotEstablishedError, match="a derivative is missing"):
        room._check_return(Checklist(), claimed, found)
    half.is_complete = lambda n, has_integral: True
    component, index = bad
    jets[component] = Jet(2, 3, {**jets[component].coefficients, index: arb("nan")})
    with pytest.raises(NotEstablishedError, match="not finite"):
        room._check_return(Checklist(), claimed, found)
