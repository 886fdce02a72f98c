"""The stability parameters of resonances, and what ids call them."""

from __future__ import annotations

from math import cos, gcd, pi

from orbitproof.shared.formats import FOLD


def short_name(kind: str | None, k: int) -> str:
    """What ids call a bifurcation: "fold", or "k3" for k = 3."""
    return FOLD if kind == FOLD else f"k{k}"


def resonant_values(k: int) -> tuple[float, ...]:
    """The stability parameters cos(2 pi j/k), gcd(j, k) = 1, 1 <= j <= k/2, of a 1:k resonance."""
    if k < 1:
        raise ValueError("a multiplicity is at least 1")
    if k == 1:
        return (1.0,)
    # Rounded where cos is off in the last digit, so that 1:4 is 0 and 1:3 is -1/2.
    return tuple(round(cos(2 * pi * j / k), 15) for j in range(1, k // 2 + 1) if gcd(j, k) == 1)
