"""The theorem about a torus that is born at a periodic orbit in words, and what was found of it (section 25.12)."""

from __future__ import annotations

from collections.abc import Iterator

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.claim import keyed_in_words
from orbitproof.verify.evidence import decimal_interval, is_positive, located
from orbitproof.verify.periodic_bifurcation import TorusResults, TorusTheorem
from orbitproof.verify.words.periodic import force_in_full, multipliers_in_words
from orbitproof.verify.words.periodic_bifurcation import setting_with_interval, varying_in_words

_DIGITS = 40
_OTHER = {"above": "below", "below": "above"}


def torus_in_words(theorem: TorusTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    system, m, varying = claim.system, claim.crossings, varying_in_words(claim)
    fixed = {name: value for name, value in claim.parameters.items() if name != claim.parameter}
    named = ", ".join(keyed_in_words(system, fixed))
    flow = f"under the flow of the {system.title}{f' ({named} as in the candidate)' if named else ''}"
    times = "once" if m == 1 else f"in {m} points"
    return (
        f"In the box, which lies in the section, and in the interval of {varying} there are exactly one point and one "
        f"value of {varying} at which the point comes back to itself at crossing number {m} of the section in the "
        f"direction of the candidate, {flow}, and a number of absolute value 1 is a multiplier whose real and "
        "imaginary part differ by at most kernel_radius from those of the candidate. The orbit of the point is "
        f"periodic and crosses the section in that direction {times} in its least period. The multiplier and its "
        "conjugate are no roots of unity of order 1, 2, 3 or 4; they are simple, and cross the unit circle with a "
        f"speed that is not 0 as {varying} varies; all other multipliers but that of the direction of the flow lie off "
        "the circle; and the first Lyapunov coefficient is not 0. So it is a Neimark-Sacker bifurcation: for values of "
        f"{varying} near it the orbit continues, and there is a neighbourhood of the orbit in which, for values near "
        "it on the side that the results name, there is a torus, invariant under the flow, that does not meet the "
        "orbit; every compact invariant set in the neighbourhood that does not meet the orbit lies on it, and it tends "
        "to the orbit of the point. For values near it on the other side, and for the value, the orbit is the only "
        "compact invariant set in the neighbourhood. How large the neighbourhood is, how near the values have to be "
        "and what the orbits on the torus do is not said, nor whether the box contains bifurcations of periodic orbits "
        "with another number of crossings. The results enclose what they name."
    )


def torus_in_full(claim: PeriodicBifurcation, theorem: str, found: TorusResults) -> Iterator[str]:
    """System, section, box, interval, theorem and what was found, in lines."""
    yield from setting_with_interval(claim)
    yield "Theorem."
    yield theorem
    yield from torus_found(claim, found)


def torus_found(claim: PeriodicBifurcation, found: TorusResults) -> Iterator[str]:
    """What was found, in lines."""
    varying = varying_in_words(claim)
    place = ", ".join(located(name, ball, _DIGITS) for name, ball in keyed_in_words(claim.system, found.point).items())
    yield f"The bifurcation is where {located(varying, found.parameter, _DIGITS)}; its point has {place}."
    yield f"The least period of its orbit lies in {decimal_interval(found.period, _DIGITS)}."
    yield from force_in_full(claim, found.point, found.period, found.parameter)
    real, imaginary = (decimal_interval(part, _DIGITS) for part in (found.multiplier.real, found.multiplier.imag))
    yield f"Two multipliers are conjugate numbers of absolute value 1, one of them in {real} + i {imaginary}."
    yield from multipliers_in_words(found.multipliers)
    grows = is_positive(found.speed)
    yield (
        f"The derivative of the absolute value of the pair by {varying} lies in "
        f"{decimal_interval(found.speed, _DIGITS)}: the pair crosses the circle {'outward' if grows else 'inward'} as "
        f"{varying} grows."
    )
    yield (
        "The first Lyapunov coefficient, for the eigenvector whose Hermitian product with the kernel of the candidate, "
        "its first vector plus i times the second one, is that of the kernel with itself, lies in "
        f"{decimal_interval(found.lyapunov, _DIGITS)}: the bifurcation is {found.criticality}."
    )
    yield f"The torus is there at values of {varying} {found.side} that of the bifurcation."
    yield from _stability(found, grows)


def _stability(found: TorusResults, grows: bool) -> Iterator[str]:
    if found.multipliers.outside:
        yield "Near the bifurcation the torus and the orbit are unstable: a multiplier lies outside the unit circle."
        return
    stable = "below" if grows else "above"
    yield (
        f"Near the bifurcation the orbit is asymptotically stable {stable} the value and unstable {_OTHER[stable]} it; "
        f"the torus is {'asymptotically stable' if found.is_attracting else 'unstable'}."
    )
