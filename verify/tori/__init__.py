"""Invariant tori near one symmetric orbit, n = 2 (section 30)."""

from orbitproof.verify.tori.following import ToriEnclosures, enclose_tori
from orbitproof.verify.tori.proved_tori import ToriResults, ToriTheorem, prove_tori, theorem_of_tori
