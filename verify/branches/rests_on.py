"""The certificates that a graph of curves rests on (sections 33.7 and 39.6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import get_args

from orbitproof.shared.claims.life import Life
from orbitproof.shared.claims.web import Web
from orbitproof.shared.formats import InputError
from orbitproof.shared.printing import printable
from orbitproof.shared.systems import shown
from orbitproof.verify.branches.joined import Part
from orbitproof.verify.certificate import Certificate, Key

_PARTS = get_args(Part)


class RestingError(InputError):
    """What is wrong with one of the certificates that a graph rests on.

    Attributes:
        key: of the certificate.
    """

    def __init__(self, key: Key, why: str) -> None:
        super().__init__(key, why)
        self.key = key

    def __str__(self) -> str:
        key, why = self.args
        return printable(f"the certificate {called(key)}: {why}")


def called(key: Key) -> str:
    """A certificate in a sentence."""
    return f"of the index of {shown(key[1])}" if key[0] == "index" else shown(key[1])


def claiming_indices(web: Web, given: Sequence[Certificate]) -> Web:
    """The claim of a web that asks for the index of each arc of which a certificate of that is given, too."""
    there = {name for part, name in (entry.key for entry in given) if part == "index"}
    return replace(web, arcs=tuple(replace(arc, index=arc.index or arc.id in there) for arc in web.arcs))


def resting(claim: Web | Life, given: Sequence[Certificate]) -> tuple[Certificate, ...]:
    """The certificates that a graph needs, in its order. Raises `InputError` if one is not there, or twice."""
    wanted, name = claim.keys, claim.kind
    found: dict[Key, Certificate] = {}
    for entry in given:
        key = entry.key
        if key[0] not in _PARTS:
            continue
        if entry.id in claim.reserved:
            raise RestingError(key, "has the name of a libration point; give it another id")
        if key in found:
            raise RestingError(key, "appears twice; give each once")
        if key in wanted:
            # Where it lies on a curve is found again.
            found[key] = entry.without_place()
        elif key[0] != "index" and entry.id in claim.certificates:
            is_one, of = ("a curve", "a vertex") if key[0] == "arc" else ("one orbit", "an arc")
            raise RestingError(key, f"is about {is_one}; the {name} claims that it is {of}")
    for key in wanted:
        if key not in found:
            what = f"claims the index of {shown(key[1])}" if key[0] == "index" else f"names {shown(key[1])}"
            raise InputError(f"the {name} {what}, and no such certificate is given; give its file")
    return tuple(found[key] for key in wanted)
