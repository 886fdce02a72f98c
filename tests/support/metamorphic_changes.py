"""The ways in which a case of `metamorphic_cases` is told otherwise."""

from __future__ import annotations

import builtins
import keyword
import re
from collections.abc import Iterator
from fractions import Fraction as Q
from functools import cache
from pathlib import Path
from random import Random

from support.metamorphic import Change
from support.metamorphic_cases import Case, Curve, system_of

from orbitproof import shared, verify
from orbitproof.shared.claims import BirthCurveClaim
from orbitproof.shared.formats import Candidate, PeriodicAtlas
from orbitproof.shared.systems import DescriptionError, ReversibleSystem
from orbitproof.shared.systems.described_functions import name_of
from orbitproof.shared.systems.description import is_title

OURS = """
    distance rate level elapsed_time time t lambda mid rad energy centre frame R S H P p_0 p_1 q_1 s v0 v1 v2 mu x
    period parameter point value start end sin cos exp log first_integral half_period crossing h q w xi sigma unused
"""
"""Symbols of theorems, of programs and of files."""
KEYS = """
    name state field section parameters kind k id mid rad decimal box centre frame radii equation quantity coordinate
    value verdict results enclosures point real imaginary reason condition digest software statement candidate system
"""
GREEK = """
    alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi omicron pi rho sigma tau upsilon phi chi
    psi omega
"""
LETTERS = " ".join("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_")
PYTHON = " ".join([*keyword.kwlist, *dir(builtins), "self", "arb", "Fraction", "jax"])


_WORD = re.compile(r'"([A-Za-z_]\w*)"|\b([A-Za-z_]\w*): ')


@cache
def words() -> tuple[str, ...]:
    """All words of our own sources that could be names: texts, and names of fields and arguments."""
    found = set[str]()
    for package in (shared, verify):
        for path in sorted(Path(str(package.__file__)).parent.rglob("*.py")):
            found.update(*_WORD.findall(path.read_text(encoding="utf-8")))
    return tuple(sorted(filter(is_free, found)))


def is_free(word: str) -> bool:
    """Whether a file may call a coordinate so."""
    try:
        return bool(name_of("name", word))
    except DescriptionError:
        return False


def symbols(case: Case) -> tuple[str, ...]:
    """Coordinates, parameters, symmetries and further reversors."""
    system = system_of(case)
    if not isinstance(system, ReversibleSystem):
        return (*system.state, *system.parameters)
    return (*system.state, *system.parameters, *system.symmetries, *(system.original or system).reversors)


def _held(case: Case) -> set[str]:
    """Coordinates and parameters whose direction is part of the claim."""
    if isinstance(case, Curve):
        claim = case.atlas.claim
        varies = claim.parameter if isinstance(case.atlas, PeriodicAtlas) else None
        covered = (claim.covers.coordinate,) if claim.covers is not None else ()
        turned = (claim.section, claim.amplitude) if isinstance(claim, BirthCurveClaim) else ()
        return {*turned, *claim.increasing, *covered, *([varies] if varies is not None else [])} | _family(case)
    return {str(getattr(case, "parameter", None))} | _family(case)


def _family(case: Case) -> set[str]:
    """What varies along the family, and what has no value of its own."""
    system = system_of(case)
    held = {str(system.family_parameter)} if isinstance(system, ReversibleSystem) else set()
    return held | ({case.varying} if isinstance(case, Candidate) and case.resonances_meet else set())


def changes(name: str, case: Case, seed: int) -> Iterator[Change]:
    """Every way in which a case is told otherwise; by chance, and always the same for a name and a seed."""
    source, system, own = Random(f"{name} {seed}"), system_of(case), symbols(case)
    pools = {"ours": OURS, "keys": KEYS, "Python": PYTHON, "Greek": GREEK, "letters": LETTERS}
    for title, pool in (("sources", words()), *((title, pool.split()) for title, pool in pools.items())):
        names = source.sample([word for word in pool if is_free(word)], len(own) + 1)
        yield Change(title, dict(zip(own, names, strict=False)), next(filter(is_title, names[::-1]), None))
    turned = source.randrange(1, len(own))
    yield Change("exchanged", dict(zip(own, (*own[turned:], *own[:turned]), strict=True)))
    if system.first_integral is not None:
        yield Change("integral: coordinate", integral=source.choice(system.state))
        yield Change("integral: parameter", integral=source.choice([*system.parameters, "H"]))
    yield Change("permuted", shuffle=source.randrange(100))
    yield Change("time", time=source.choice((Q(1, 4), Q(4))))
    units = {each: Q(2) ** source.choice((-2, -1, 1, 2)) for each in _scaled(case)}
    yield Change("units", factors=units, level=Q(2) ** source.choice((-2, 2)))
    yield Change("reflected", factors={each: Q(-1) for each in _scaled(case) if each not in _held(case)})
    values = {
        word: Q(source.choice((0, 1, -3)), source.choice((1, 2, 10**8))) for word in ("distance", "rate", "level")
    }
    yield Change("unused parameters", unused={word: value for word, value in values.items() if word not in own})
    if has_room(case):
        yield Change("coordinates beside", beside=("level_beside", "distance_beside"))
    yield all_at_once(name, case, seed)


def all_at_once(name: str, case: Case, seed: int = 0) -> Change:
    """Names, order, units and signs together."""
    source, own, held = Random(f"{name} {seed}, all at once"), symbols(case), _held(case)
    names = source.sample([word for word in OURS.split() if is_free(word) and word not in own], len(own) + 3)
    told, unused = names[: len(own)], names[len(own) :]
    signs = {each: 1 if each in held else source.choice((-1, 1)) for each in _scaled(case)}
    return Change(
        "all at once",
        dict(zip(own, told, strict=True)),
        integral=source.choice(told),
        shuffle=source.randrange(100),
        factors={each: sign * Q(2) ** source.choice((-1, 1)) for each, sign in signs.items()},
        time=Q(2),
        level=Q(2),
        unused={word: Q(source.choice((0, 1))) for word in unused},
    )


def _scaled(case: Case) -> tuple[str, ...]:
    """What has units."""
    return (*system_of(case).given_state, *system_of(case).parameters)


def has_room(case: Case) -> bool:
    """Whether coordinates that play no part may stand beside."""
    if system_of(case).defined or (isinstance(case, Curve) and case.complete is not None):
        return False
    kinds = (
        "stable_orbit", "invariant_tori", "krein_collision", "double_resonance", "periodic-torus", "homoclinic",
        "heteroclinic", "homoclinic_curve",
    )  # fmt: skip
    return getattr(case, "kind", "") not in kinds
