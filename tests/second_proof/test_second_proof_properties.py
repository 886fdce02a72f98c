"""The second proof: enclosures contain what closed forms say, conditions hold and fail where they have to."""

from __future__ import annotations

import closed_forms
import property_checks
import pytest

from orbitproof.verify import second_proof

CHECKS = closed_forms.CHECKS | property_checks.CHECKS


@pytest.mark.parametrize("name", CHECKS)
def test_property(name: str) -> None:
    CHECKS[name](second_proof)


@pytest.mark.slow
def test_flow_encloses_thousands_of_random_points() -> None:
    property_checks.flow_encloses_exact_solutions(second_proof, points=1500)
