"""What `only` asks for."""

from __future__ import annotations

import pytest

from orbitproof.shared.formats import InputError, select_ids

NAMES = ["L1-k2-1", "L1-k4-1", "L2-k2-1", "L2-k2-[a]"]


def test_ids_and_patterns_choose_in_the_order_of_the_file() -> None:
    assert select_ids(NAMES, None, "row") == NAMES
    assert select_ids(NAMES, ["L2-k2-1", "L1-k2-1"], "row") == ["L1-k2-1", "L2-k2-1"]
    assert select_ids(NAMES, ["*-k2-?", "L1-*"], "row") == ["L1-k2-1", "L1-k4-1", "L2-k2-1"]


@pytest.mark.parametrize("only", [["L1-k2"], ["L1-k2-1", "l1-*"], ["*-k7-*"], [""]])
def test_what_matches_nothing_is_named(only: list[str]) -> None:
    with pytest.raises(InputError, match=r"no such row; known: L1-k2-1, L1-k4-1"):
        select_ids(NAMES, only, "row")


def test_only_a_pattern_may_match_nothing_where_none_will_do() -> None:
    assert select_ids(NAMES, ["*-k7-*"], "row", or_none=True) == []
    with pytest.raises(InputError, match=r"^only L7: no such row"):
        select_ids(NAMES, ["L7"], "row", or_none=True)
    with pytest.raises(InputError, match="known: none"):
        select_ids([], ["L7"], "row")
