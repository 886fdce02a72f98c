"""Stability along a proved curve: complete lists of resonances, intervals of linear stability (section 18)."""

from orbitproof.verify.functions import REACH
from orbitproof.verify.stability.confirmation import unconfirmed
from orbitproof.verify.stability.decided import open_on
from orbitproof.verify.stability.matrix import SLOPE_BITS, stability_to_json
from orbitproof.verify.stability.theorem import with_complete_list
