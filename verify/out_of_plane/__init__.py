"""Variations of planar orbits out of their plane (section 21)."""

from orbitproof.verify.out_of_plane.out_of_plane import variations_across, with_variations
from orbitproof.verify.out_of_plane.variations import KnownVariations, VariationFunctions
