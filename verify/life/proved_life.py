"""The theorem about a life: proved curves of equilibria and of the orbits that are born on them (section 39)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from flint import arb, ctx

from orbitproof.shared.claims.life import Life
from orbitproof.shared.claims.parts import hanging_together
from orbitproof.shared.systems import shown
from orbitproof.verify.curve import CURVE_PRECISION
from orbitproof.verify.evidence import (
    Checklist,
    NotEstablishedError,
    NotProved,
    Outcome,
    Proved,
    excludes_zero,
)
from orbitproof.verify.life.arc import LifeCurve
from orbitproof.verify.life.joints import Birthplace, joint_shown


@dataclass(frozen=True)
class LifeTheorem:
    """The arcs of a life are proved curves that are joined as it says (Theorem 39.5)."""

    life: Life

    @property
    def hypotheses(self) -> tuple[str, ...]:
        """As in `evidence.Theorem`."""
        return ("arcs", "equations", "joints", "births", *(("connected",) if self.life.connected else ()))


@dataclass(frozen=True)
class ProvedLife:
    """What is known of a proved life.

    Attributes:
        arcs: in the order of the claim.
        values: for each a ball with the values of the parameter on it.
        joints: all of them, in that order.
        parts: the ids of arcs that hang together.
    """

    arcs: tuple[LifeCurve, ...]
    values: tuple[arb, ...]
    joints: tuple[Birthplace, ...]
    parts: tuple[tuple[str, ...], ...]


def conclude_life(life: Life, arcs: Sequence[LifeCurve]) -> Outcome[ProvedLife]:
    """The theorem about a life, or the first hypothesis that is not shown; `arcs` are those of the claim, in order."""
    checklist = Checklist()
    with ctx.workprec(CURVE_PRECISION):
        try:
            _check_arcs(checklist, life, arcs)
            _check_equations(checklist, arcs)
            found = _check_joints(checklist, life, arcs)
            _check_births(checklist, arcs)
            parts = hanging_together({arc.id: [arc.id, *(joint.arc for joint in arc.joints)] for arc in life.arcs})
            if life.connected:
                statement = "any two arcs are joined by arcs that follow one another"
                remedy = "name the arcs on which others begin, or do not claim it: connected = false"
                with checklist.hypothesis("connected", "39.4", statement, remedy) as evidence:
                    names = "; ".join(", ".join(map(shown, part)) for part in parts)
                    evidence.require(len(parts) == 1, f"these hang together, and no more is shown: {names}")
            values = tuple(arc.values for arc in arcs)
        except NotEstablishedError as error:
            return NotProved(error.reason, tuple(checklist.hypotheses))
    return Proved(LifeTheorem(life), ProvedLife(tuple(arcs), values, found, parts), tuple(checklist.hypotheses))


def _check_arcs(checklist: Checklist, life: Life, arcs: Sequence[LifeCurve]) -> None:
    statement = "every arc is a proved curve of equilibria or of orbits from their birth on, and no two share a piece"
    with checklist.hypothesis("arcs", "39.1", statement, "prove the curve, and give each once") as evidence:
        names = [arc.id for arc in arcs]
        evidence.require(names == [arc.id for arc in life.arcs] != [], "they are not those of the claim")
        evidence.require(len(set(names)) == len(names), "two arcs have the same id")
        for arc in arcs:
            proved = arc.curve is not None and not arc.problem
            evidence.require(proved, f"{shown(arc.id)}: {arc.problem or 'it is not proved'}")
        own = [arc.pieces for arc in arcs]
        evidence.require(len(set().union(*own)) == sum(map(len, own)), "two arcs have a piece in common")


def _check_equations(checklist: Checklist, arcs: Sequence[LifeCurve]) -> None:
    statement = "all arcs are about the same equations and the same parameter, the others having the same values"
    remedy = "give arcs of one system, along one parameter"
    with checklist.hypothesis("equations", "39.1", statement, remedy) as evidence:
        evidence.require(True, "")
        for arc in arcs[1:]:
            same = arc.equations == arcs[0].equations
            evidence.require(same, f"{shown(arc.id)} and {shown(arcs[0].id)} are about different ones")


def _check_joints(checklist: Checklist, life: Life, arcs: Sequence[LifeCurve]) -> tuple[Birthplace, ...]:
    by_id = {arc.id: arc for arc in arcs}
    statement, remedy = "every arc is joined to others as claimed", "correct the claim, or let the other reach further"
    found: list[Birthplace] = []
    with checklist.hypothesis("joints", "39.2", statement, remedy) as evidence:
        evidence.require(True, "")
        for arc, claimed in zip(arcs, life.arcs, strict=True):
            for joint in claimed.joints:
                pair = f"that {shown(arc.id)} {joint.how} {shown(joint.arc)}"
                on = by_id.get(joint.arc)
                birthplace = "that is none of the arcs" if on is None else joint_shown(arc, joint, on)
                if isinstance(birthplace, str):
                    evidence.require(False, f"it is not shown {pair}: {birthplace}")
                    continue
                found.append(birthplace)
                evidence.record(f"{shown(joint.arc)}, s where {shown(arc.id)} {joint.how} it", birthplace.place.s)
    return tuple(found)


def _check_births(checklist: Checklist, arcs: Sequence[LifeCurve]) -> None:
    statement = "all births are at different equilibria, or for different values of the parameter"
    with checklist.hypothesis("births", "39.3", statement, "give each birth once, by one certificate") as evidence:
        evidence.require(True, "")
        births = [(arc.id, birth.point) for arc in arcs for birth in arc.births.values()]
        for (one, first), (other, second) in combinations(births, 2):
            different = any(excludes_zero(first[name] - second[name]) for name in first)
            evidence.require(different, f"a birth of {shown(one)} and one of {shown(other)} may be the same")
