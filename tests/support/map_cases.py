"""Claims about reversible maps in closed form: true ones by name, and their outcomes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction as F
from typing import Any

from flint import arb
from support.closed_form_maps import ReversibleMap, claim, description, square_root, tables_of_maps, verdict

from orbitproof.verify.bifurcation import BifurcationResults
from orbitproof.verify.evidence import NotProved, Outcome, Proved

R = F(1, 2**14)
ROOT = square_root(F(1, 2), 200)


def quadratic(p: Sequence[Any]) -> Sequence[Any]:
    return [p[0] * p[0]]


def cubic(p: Sequence[Any]) -> Sequence[Any]:
    return [p[0] * p[0] + p[0] * p[0] * p[0]]


def minus_cubic(p: Sequence[Any]) -> Sequence[Any]:
    return [p[0] * p[0] + p[0] * p[0] * p[0] * -1.0] if isinstance(p[0], float) else [
        p[0] * p[0] + (p[0] * p[0] * p[0]).scaled(arb(-1))]  # fmt: skip


def odd(p: Sequence[Any]) -> Sequence[Any]:
    return [p[0] * p[0] * p[0]]


def coupled(p: Sequence[Any]) -> Sequence[Any]:
    return [p[0] * p[0] + p[0] * p[1] + p[0] * p[0] * p[0], p[0] * p[0] + p[1] * p[1]]


def coupled_odd(p: Sequence[Any]) -> Sequence[Any]:
    return [p[0] * p[1] + p[0] * p[0] * p[0], p[0] * p[0] + p[1] * p[1]]


def tilted(p: Sequence[Any], number: Callable[[F], Any]) -> Any:
    """nu as a first integral that depends on every coordinate; even in p_1 up to a tiny linear term."""
    result = p[0] * number(F(2)) + p[1] * number(F(1, 2**30)) + p[1] * p[1] * number(F(3, 8))
    return result if len(p) == 2 else result + p[2] * number(F(1, 3))


def even(p: Sequence[Any], number: Callable[[F], Any]) -> Any:
    """nu as a first integral that is even in p_1."""
    result = p[0] * number(F(2)) + p[1] * p[1] * number(F(3, 8))
    return result if len(p) == 2 else result + p[2] * number(F(1, 3))


WIDE = (64 * R * R, R)
WIDE_2 = (64 * R * R, R, 64 * R * R)
SLOPED = (R, R / 16)
SLOPED_2 = (R, R / 16, 64 * R * R)

CASES: dict[str, tuple[ReversibleMap, str, int, tuple[F, ...]]] = {
    "k=1": (ReversibleMap(F(1), odd), "symmetry_breaking", 1, WIDE),
    "k=1, n=2": (ReversibleMap(F(1), coupled_odd, (F(1, 5),)), "symmetry_breaking", 1, WIDE_2),
    "k=2": (ReversibleMap(F(0), cubic), "period_tupling", 2, WIDE),
    "k=2, other sign": (ReversibleMap(F(0), minus_cubic), "period_tupling", 2, WIDE),
    "k=2, sloped family": (ReversibleMap(F(0), cubic, slope=F(1, 2**20)), "period_tupling", 2, WIDE),
    "k=2, n=2": (ReversibleMap(F(0), coupled, (F(1, 5),)), "period_tupling", 2, WIDE_2),
    "k=3": (ReversibleMap(F(-1, 2), cubic), "touch_and_go", 3, SLOPED),
    "k=3, sloped family": (ReversibleMap(F(-1, 2), cubic, slope=F(1, 2**8)), "touch_and_go", 3, SLOPED),
    "k=3, n=2": (ReversibleMap(F(-1, 2), coupled, (F(1, 5),)), "touch_and_go", 3, SLOPED_2),
    "k=3, symmetric": (ReversibleMap(F(-1, 2), odd), "period_tupling", 3, WIDE),
    "k=3, symmetric, n=2": (ReversibleMap(F(1, 2), coupled_odd, (F(1, 5),)), "period_tupling", 3, WIDE_2),
    "k=4": (ReversibleMap(ROOT, cubic), "period_tupling", 4, WIDE),
    "k=4, n=2": (ReversibleMap(ROOT, coupled, (F(1, 5),)), "period_tupling", 4, WIDE_2),
}


def outcome_of(name: str, hamiltonian: bool = False, **changes: Any) -> Outcome[BifurcationResults]:
    system, kind, k, radii = CASES[name]
    symmetric = k == 1 or (k == 3 and kind == "period_tupling")
    level = None if not hamiltonian else even if symmetric else tilted
    tables, integral = tables_of_maps(system, k, radii, level)
    n = len(radii) - 1
    values = {"symmetry": "S" if symmetric else None, **changes}
    candidate = claim(description(n, hamiltonian, symmetric_system=symmetric), kind, k, radii, **values)
    return verdict(candidate, tables, integral)


def proof(outcome: Outcome[BifurcationResults]) -> Proved[BifurcationResults]:
    assert isinstance(outcome, Proved), outcome.reason
    return outcome


def failed(outcome: Outcome[BifurcationResults], condition: str) -> NotProved:
    """The outcome, checked to be: everything before `condition` holds, and that does not."""
    assert isinstance(outcome, NotProved)
    assert outcome.reason.condition == condition, outcome.reason
    assert [hypothesis.holds for hypothesis in outcome.hypotheses] == [True] * (len(outcome.hypotheses) - 1) + [False]
    assert outcome.hypotheses[-1].name == condition
    return outcome
