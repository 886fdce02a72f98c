"""Flows and Poincare maps of any system on sets of initial values, and their fixed points (section 23)."""

from orbitproof.verify.maps.affine_section import AffineSection
from orbitproof.verify.maps.fixed_points import Zeros, combination, displacement, enclose_zeros
from orbitproof.verify.maps.flow_map import enclose_flow
from orbitproof.verify.maps.image import Image, image_of
from orbitproof.verify.maps.poincare_map import enclose_poincare_map
from orbitproof.verify.maps.starting_set import Format, StartingSet
