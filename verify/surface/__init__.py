"""Halo orbits over ranges of the mass parameter (section 17)."""

from orbitproof.verify.surface.half_return import SurfaceLimits
from orbitproof.verify.surface.libration_piece import prove_libration_piece
from orbitproof.verify.surface.piece import prove_surface_piece
from orbitproof.verify.surface.stored_parts import unshown
from orbitproof.verify.surface.theorem import conclude_surface
from orbitproof.verify.surface.theorem import hypotheses_of as surface_hypotheses
