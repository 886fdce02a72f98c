"""The theorems about an equilibrium and about a Hopf point in words, and what was found (section 36)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from orbitproof.shared.claims import AroundPoint, Equilibrium, HopfPoint
from orbitproof.verify.claim import keyed_in_words, names_in_words
from orbitproof.verify.equilibrium import (
    EquilibriumResults,
    EquilibriumTheorem,
    HopfResults,
    HopfTheorem,
    Spectrum,
)
from orbitproof.verify.evidence import decimal_interval, enclose, exact_text, located, symmetric
from orbitproof.verify.words.periodic import complex_in_words, field_in_lines

_DIGITS = 40
_TAKEN = ("a", "A", "B", "C", "f", "i", "k", "l", "q", "s", "u", "v")
"""Letters of theorems, which no formula has for a part of it."""
_OTHER = {"above": "below", "below": "above"}


def equilibrium_in_words(theorem: EquilibriumTheorem) -> str:
    """The theorem, in short."""
    return (
        f"In the box there is exactly one equilibrium of the {field_in_words(theorem.claim)}. The derivative of the "
        "field there is regular: the equilibrium persists for neighbouring values of the parameters. The results "
        "enclose the point and the eigenvalues of this derivative."
    )


def equilibrium_in_full(claim: Equilibrium, theorem: str, found: EquilibriumResults) -> Iterator[str]:
    """System, box, theorem and what was found, in lines."""
    yield from setting_in_words(claim)
    yield "Theorem."
    yield theorem
    yield from _point(claim, found)
    yield from _spectrum(found.eigenvalues, "The eigenvalues")
    if found.eigenvalues.is_stable:
        yield "The equilibrium is asymptotically stable."
    elif found.eigenvalues.right:
        yield "The equilibrium is unstable."


def hopf_in_words(theorem: HopfTheorem) -> str:
    """The theorem, in short."""
    claim = theorem.claim
    varying = _varying(claim)
    return (
        f"In the box and in the interval of {varying} there are exactly one point, one value of {varying}, one number "
        "omega and one vector q, normalised as in the candidate, with which the point is an equilibrium of the "
        f"{field_in_words(claim)} and the derivative of the field there has the eigenvalue i omega with the "
        "eigenvector q. It is a Hopf bifurcation: i omega and -i omega are simple eigenvalues, no other one has real "
        f"part 0, their real part has a derivative in {varying} that is not 0, and the first Lyapunov coefficient is "
        f"not 0. Therefore the point has a neighbourhood in which, for values of {varying} near its own, there is "
        "exactly one equilibrium, and on the side that the results name exactly one periodic orbit, which shrinks to "
        f"the point as {varying} tends to its value there, while its least period tends to 2 pi/omega. At that value, "
        "and on the other side, the neighbourhood contains no periodic orbit. How far the neighbourhood reaches is "
        "not said. The results enclose what they name."
    )


def hopf_in_full(claim: HopfPoint, theorem: str, found: HopfResults) -> Iterator[str]:
    """System, box, theorem and what was found, in lines."""
    varying = _varying(claim)
    yield from setting_in_words(claim)
    middle = enclose(claim.parameters[claim.parameter])
    yield f"  {varying} lies in {decimal_interval(middle + symmetric(claim.parameter_radius), _DIGITS)}"
    frequency = enclose(claim.frequency) + symmetric(claim.frequency_radius)
    yield f"  omega lies in {decimal_interval(frequency, _DIGITS)}"
    yield (
        "  q = u + i v: the components of u and v are within kernel_radius = "
        f"{exact_text(claim.kernel_radius)} of those of the two rows of kernel, k = k_1 + i k_2, and q has the same "
        "product as k with the conjugate of k."
    )
    yield "Theorem."
    yield theorem
    yield from _point(claim, found)
    yield f"The value of {varying} lies in {decimal_interval(found.parameter, _DIGITS)}."
    yield (
        f"omega lies in {decimal_interval(found.frequency, _DIGITS)}, the limit of the periods, 2 pi/omega, in "
        f"{decimal_interval(found.period, _DIGITS)}."
    )
    if found.eigenvalues.values:
        yield from _spectrum(found.eigenvalues, "The other eigenvalues")
    else:
        yield "There are no other eigenvalues."
    yield f"The derivative of the real part of the pair in {varying} lies in {decimal_interval(found.speed, _DIGITS)}."
    yield (
        "The first Lyapunov coefficient, for an eigenvector of length 1, lies in "
        f"{decimal_interval(found.lyapunov, _DIGITS)}: the bifurcation is {found.criticality}."
    )
    stable = "asymptotically stable, with asymptotic phase" if found.is_attracting else "unstable"
    yield (
        f"The periodic orbits are there for values of {varying} {found.side} that of the point, not for values "
        f"{_OTHER[found.side]} it. They are {stable}."
    )


def field_in_words(claim: AroundPoint) -> str:
    """The field as a noun, with the parameters that the candidate gives."""
    fixed = {name: value for name, value in claim.parameters.items() if name != claim.parameter}
    named = ", ".join(keyed_in_words(claim.system, fixed))
    return f"{claim.system.title}{f' ({named} as in the candidate)' if named else ''}"


def _varying(claim: HopfPoint) -> str:
    return names_in_words(claim.system).get(claim.parameter, claim.parameter)


def setting_in_words(claim: AroundPoint) -> Iterator[str]:
    """System, parameters and box, in lines."""
    system, names = claim.system, names_in_words(claim.system)
    field, _ = field_in_lines(system, _TAKEN)
    yield from field
    fixed = {name: value for name, value in claim.parameters.items() if name != claim.parameter}
    for name, value in keyed_in_words(system, fixed).items():
        yield f"  {name} = {exact_text(value)}"
    if names:
        called = ", ".join(f"{new} is called {name}" for name, new in names.items())
        yield f"In the description of the system {called}, which has another meaning here."
    yield "The box, whose centre and radii are exactly those of candidate in this statement:"
    state: Sequence[str] = [names.get(name, name) for name in system.given_state]
    for name, middle, radius in zip(state, claim.centre, claim.radii, strict=True):
        yield f"  {name} lies in {decimal_interval(enclose(middle) + symmetric(radius), _DIGITS)}"


def _point(claim: AroundPoint, found: EquilibriumResults | HopfResults) -> Iterator[str]:
    place = ", ".join(located(name, ball, _DIGITS) for name, ball in keyed_in_words(claim.system, found.point).items())
    yield f"The equilibrium in the box has {place}."


def _spectrum(found: Spectrum, which: str) -> Iterator[str]:
    if not found.values:
        yield f"{which} are not enclosed."
        return
    yield f"{which}, with multiplicity, lie in: {'; '.join(map(complex_in_words, found.values))}."
    yield f"Of them {found.left} {_have(found.left)} a negative real part, {found.right} a positive one."
    if found.undecided:
        yield f"Which sign the real part of {found.undecided} of them has is not decided."


def _have(count: int) -> str:
    return "has" if count == 1 else "have"
