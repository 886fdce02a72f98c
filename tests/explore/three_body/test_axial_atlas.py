"""Atlases of the axial family of L3, across which the derivatives of the half return are nearly singular."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from orbitproof.explore.flow import flow_of
from orbitproof.explore.three_body.atlases import LyapunovFamily, axial_atlas
from orbitproof.explore.three_body.atlases.axial import AxialFamily
from orbitproof.shared.systems import CR3BP, LIFTED, MASS_PARAMETERS
from orbitproof.verify.curve import PieceLimits, prove_birth_piece, prove_piece
from orbitproof.verify.oracle import ORACLE

EARTH_MOON = MASS_PARAMETERS["earth-moon"]
WHOLE = (Fraction(-1), Fraction(1))


@pytest.mark.slow
def test_the_family_is_followed_from_its_planar_orbit_in_steps_that_are_short_enough() -> None:
    """A step of 0.08 at once leads Newton's method away from it."""
    planar = LyapunovFamily("L3", EARTH_MOON)
    eps = planar.symmetry_breaking(-1, "axial")
    born = planar.orbit(eps)
    family = AxialFamily(EARTH_MOON, (planar.libration.x + eps, eps * born.vy, born.half_period), 0.08)
    orbit = family.orbit(0.16)
    assert orbit.half_period == pytest.approx(born.half_period, rel=1e-3)
    start = [orbit.x, 0.0, 0.0, 0.0, orbit.vy, 0.4]
    end = flow_of(CR3BP).derivative(start, orbit.half_period, [float(EARTH_MOON)]).state
    assert np.abs(end[1:4]).max() < 1e-9
    assert -0.3 < end[0] < -0.2


@pytest.mark.slow
def test_its_pieces_are_proved_with_second_derivatives() -> None:
    """The first of them, and that of the birth, which is not proved without."""
    atlas = axial_atlas("L3", EARTH_MOON, "earth-moon", 5e-9)
    first, (birth,) = atlas.curve_pieces()[0], atlas.birth_pieces()
    second = PieceLimits(top=2)
    assert prove_piece(LIFTED, atlas.parameters, first, WHOLE, ORACLE, second).is_proved
    assert prove_birth_piece(LIFTED, atlas.parameters, birth, WHOLE, ORACLE, second).is_proved
    assert not prove_birth_piece(LIFTED, atlas.parameters, birth, WHOLE, ORACLE).is_proved
