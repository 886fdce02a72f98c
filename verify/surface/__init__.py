"""Halo orbits over ranges of the mass parameter (section 17)."""

from orbitproof.verify.surface.half_return import SurfaceLimits, SurfaceReturn, enclose_surface
from orbitproof.verify.surface.libration_piece import prove_libration_piece
from orbitproof.verify.surface.piece import prove_surface_piece
from orbitproof.verify.surface.planar_family import PlanarFamily
from orbitproof.verify.surface.proved_parts import ProvedPart, ProvedParts, SurfaceResult
from orbitproof.verify.surface.proved_surface import Height, ProvedSurface, SurfaceTheorem, conclude_surface
from orbitproof.verify.surface.stored_parts import unshown
