"""Theorems of claims about boxes in words, whatever their kind."""

from __future__ import annotations

from typing import Any

from orbitproof.shared.formats import BoxClaim
from orbitproof.verify.certificate.kinds import kind_of


def theorem_in_words(theorem: Any) -> str:
    """In short."""
    return kind_of(theorem.claim).in_words(theorem)


def in_full(claim: BoxClaim, theorem: Any, found: Any) -> str:
    """So that it stands alone."""
    return kind_of(claim).in_full(claim, theorem, found)
