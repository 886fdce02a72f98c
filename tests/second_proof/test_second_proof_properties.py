"""The second proof: enclosures contain what closed forms say, conditions hold and fail where they have to."""

from __future__ import annotations

import pytest
from property_checks import CHECKS, flow_encloses_exact_solutions

from orbitproof.verify import second_proof


@pytest.mark.parametrize("name", CHECKS)
def test_property(name: str) -> None:
    CHECKS[name](second_proof)


def test_flow_encloses_thousands_of_random_points() -> None:
    flow_encloses_exact_solutions(second_proof, points=1500)
