"""Claims about equilibria of vector fields, and about points at which periodic orbits are born from them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from orbitproof.shared.claims.fields import Id, Identifier, Numbers, Rows, Vector
from orbitproof.shared.claims.without_symmetry import WithoutSymmetry, check_numbers, check_positive, refuse
from orbitproof.shared.stored import Rational, stored
from orbitproof.shared.systems import System

EQUILIBRIUM = "equilibrium"
HOPF = "hopf"


class AroundPoint(WithoutSymmetry):
    """A claim about a box of the state, in which nothing is followed.

    Attributes:
        centre: shape (N,), in the order of the state but for functions of other coordinates.
        radii: shape (N,), half-widths, all positive.
        parameter: the name of the one that varies; `None` if none does.
    """

    centre: Vector
    radii: Vector
    parameter: str | None

    @property
    def crossings(self) -> int:
        """1: nothing is followed for longer than once. Other claims about boxes have the number too."""
        return 1

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the box, and then of all else that varies."""
        return self.radii

    def check_box(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        size = len(self.system.given_state)
        self.check_setting()
        self.check_lengths({"centre": size, "radii": size})
        check_numbers({"centre": [self.centre], "radii": [self.radii]})
        check_positive("radii", self.radii)


@dataclass(frozen=True, repr=False)
class Equilibrium(AroundPoint):
    """A claim: the box of the x with |x_i - centre_i| <= radii_i contains exactly one equilibrium f(x) = 0.

    Attributes:
        id: unique name within a file.
        system: the vector field.
        parameters: exact values of all parameters of the vector field, by name.
        centre: shape (N,), in the order of the state but for functions of other coordinates.
        radii: shape (N,), half-widths, all positive.
        provenance: free-form, ignored by the verifier.
    """

    id: Id
    system: System
    parameters: Mapping[Identifier, Rational]
    centre: Numbers
    radii: Numbers
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = EQUILIBRIUM
    parameter = None

    def __post_init__(self) -> None:
        """Raises `InputError` as `check_box`."""
        self.check_box()

    def __repr__(self) -> str:
        return f"<Equilibrium {self.id!r}: of {self.system.name}>"


@dataclass(frozen=True, repr=False)
class HopfPoint(AroundPoint):
    """A claim: for one value of a parameter an equilibrium has the eigenvalues +- i omega, and orbits are born there.

    A is the derivative of f in x. Claimed to be in the box: exactly one (x, a, omega, q) with f(x, a) = 0,
    A q = i omega q and <k, q> = <k, k>; k is the `kernel`, <k, q> the sum of the products of its conjugates with q.

    Attributes:
        id: unique name within a file.
        system: the vector field.
        parameters: exact values of all parameters, by name; of the one that varies the middle of its interval.
        parameter: name of the one that varies, a.
        parameter_radius: half-width of its interval, positive.
        centre: shape (N,), in the order of the state but for functions of other coordinates.
        radii: shape (N,), half-widths, all positive.
        frequency: the middle of the interval of omega.
        frequency_radius: its half-width, positive; all of the interval is positive.
        kernel: shape (2, N), real and imaginary part of k: about an eigenvector of i omega, and not zero.
        kernel_radius: half-width in which q is looked for about k, positive, the same for both parts of all components.
        provenance: free-form, ignored by the verifier.
    """

    id: Id
    system: System
    parameters: Mapping[Identifier, Rational]
    parameter: Identifier
    parameter_radius: Fraction
    centre: Numbers
    radii: Numbers
    frequency: Fraction
    frequency_radius: Fraction
    kernel: Rows
    kernel_radius: Fraction
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    kind = HOPF

    def __post_init__(self) -> None:
        """Raises `InputError` as `check_box`."""
        size = len(self.system.given_state)
        self.check_box()
        if len(self.kernel) != 2 or any(len(row) != size for row in self.kernel):
            refuse("kernel", "wrong shape", f"give 2 rows of {size} numbers, real and imaginary parts")
        if size < 2:
            refuse("kind", f"{self.kind} takes a state of at least 2 coordinates", "give another kind")
        widths = {
            "parameter_radius": (self.parameter_radius,),
            "frequency_radius": (self.frequency_radius,),
            "kernel_radius": (self.kernel_radius,),
        }
        check_numbers({"frequency": [(self.frequency,)], "kernel": self.kernel})
        for name, values in widths.items():
            check_numbers({name: [values]})
            check_positive(name, values)
        self.check_varying(self.parameter, self.parameter_radius)
        if self.frequency <= self.frequency_radius:
            refuse("frequency", "its interval is not positive", "give a positive one, or a smaller half-width")
        if not any(map(any, self.kernel)):
            refuse("kernel", "it is zero", "give an eigenvector")

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the box, then of parameter, frequency and eigenvector."""
        return (*self.radii, self.parameter_radius, self.frequency_radius, self.kernel_radius)

    def __repr__(self) -> str:
        return f"<HopfPoint {self.id!r}: while {self.parameter} varies, of {self.system.name}>"
