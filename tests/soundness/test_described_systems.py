"""What has one description is one system: no proof is about another one than its statement."""

from __future__ import annotations

import pickle
from dataclasses import replace
from fractions import Fraction as Q
from typing import Any

import pytest

from orbitproof import verify
from orbitproof.shared.claims import Claim, Piece
from orbitproof.shared.formats import Atlas, define_system
from orbitproof.shared.systems import ReversibleSystem, describe, described
from orbitproof.verify.curve import PieceLimits, prove_piece
from orbitproof.verify.oracle import ORACLE

UNIT = ((Q(1), Q(0)), (Q(0), Q(1)))
DRIFT = Q(1, 2**40)
LINE = Piece("p1", "regular", (Q(1, 2), Q(1)), UNIT, Q(1, 2), ((Q(0),),), (Q(1, 2**48),), "physical")
"""a from 0 to 1, u = 1, up to far less than the drift."""


def turning(name: str) -> ReversibleSystem:
    """u = r cos t, y = r sin t, q' = r^2 - 1: the orbits have u = 1; R has another name as well."""
    signs = {"y": -1, "q": -1}
    system = define_system(
        {
            "name": name, "state": "u y q", "parameters": "a", "section": "y", "family_parameter": "a",
            "field": {"u": "-y", "y": "u", "q": "u**2 + y**2 - 1"}, "R": signs, "reversors": {"S": signs},
        }
    )  # fmt: skip
    assert isinstance(system, ReversibleSystem)
    return system


def drifting(x: Any, _: Any) -> Any:
    """The same with q' = r^2 - 1 + `DRIFT`: the orbits have u = (1 - DRIFT)^(1/2)."""
    return -x[1], x[0], x[0] * x[0] + x[1] * x[1] - 1 + DRIFT


def verdict(system: ReversibleSystem) -> str:
    """Of the claim that the orbits have u = 1."""
    atlas = Atlas("arc", "an arc", system, {}, Claim("arc", None), (LINE,))
    (found,) = verify.certify(atlas, precision=104, order=30, width=12, max_splits=1, quiet=True)
    return str(found.document["verdict"])


def test_a_changed_copy_of_a_system_under_another_reversor_is_itself() -> None:
    own = turning("turning-changed").under("S")
    other = replace(own, vector_field=drifting)
    assert describe(other) != describe(own)
    assert pickle.loads(pickle.dumps(other)).program == other.program
    assert described(describe(own)).program == own.program
    assert verdict(own) == "proved"
    assert verdict(other) == "not proved"


def test_of_two_systems_that_differ_across_their_plane_alone_the_second_is_refused() -> None:
    plain = replace(turning("turning"), name="turning-across")
    first, second = (replace(plain, stiffness_across=lambda x, _, k=k: (k + x[1] ** 2,)) for k in (1, 4))
    assert pickle.loads(pickle.dumps(first)) is first
    with pytest.raises(ValueError, match="stiffness_across"):
        pickle.dumps(second)


@pytest.mark.parametrize("name", ["u", "y", "q", "a", "mu"])
def test_a_piece_takes_no_value_for_what_is_no_fixed_parameter(name: str) -> None:
    found = prove_piece(turning("turning"), {name: Q(1)}, LINE, (Q(-1), Q(1)), ORACLE, PieceLimits(80, 24, 12)).stored
    assert found.reason is not None
    assert "has other parameters" in found.reason.message
