"""Claims about bifurcations of periodic orbits of vector fields, with a parameter or the level of a first integral."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Literal

from orbitproof.shared.claims.fields import Identifier, Pair, Rows, Vector
from orbitproof.shared.claims.in_section import BoxInSection
from orbitproof.shared.claims.without_symmetry import check_numbers, check_positive, refuse
from orbitproof.shared.stored import Rational, stored

PERIODIC_FOLD = "periodic-fold"
PERIODIC_DOUBLING = "periodic-doubling"
PERIODIC_PITCHFORK = "periodic-pitchfork"
PERIODIC_TORUS = "periodic-torus"
PERIODIC_BIFURCATIONS = (PERIODIC_FOLD, PERIODIC_DOUBLING, PERIODIC_PITCHFORK, PERIODIC_TORUS)


@dataclass(frozen=True, repr=False)
class PeriodicBifurcation(BoxInSection):
    """A claim: for one value of a parameter, or of the level, a periodic orbit through the box bifurcates.

    P_m is crossing number m of the section in the direction. The point of the orbit returns to itself at crossing m;
    with a symmetry S, S takes it there: its image under S o P_m, the map that stands for P_m then, is itself. A fold is
    where a multiplier of that map is 1, a doubling or a pitchfork where it is -1, a torus where two are cos +- i sin.

    Attributes:
        kind: one of `PERIODIC_BIFURCATIONS`.
        kernel: one vector of the shape (N - 1,), in the coordinates p, about an eigenvector of the multiplier; for a
            torus two, its real and imaginary part. Not zero.
        kernel_radius: half-width in which the eigenvector is looked for, positive, the same for all of its components.
        parameter_radius: half-width of the interval of the parameter about its value in `parameters`, or, if none is
            named, of the level about `level`; positive.
        parameter: name of the parameter that varies; `None` if the level does.
        level: of the first integral: the middle of its interval, or its value if a parameter varies; `None` where no
            first integral is used.
        multiplier: for a torus cos and sin of the multiplier, about; looked for within `kernel_radius`.
        symmetry: for a pitchfork S, shape (N, N), rows: a linear involution of the state that the vector field respects
            and that maps the section to itself.
        provenance: free-form, ignored by the verifier.
    """

    kind: Literal["periodic-fold", "periodic-doubling", "periodic-pitchfork", "periodic-torus"]
    kernel: Rows
    kernel_radius: Fraction
    parameter_radius: Fraction
    parameter: Identifier | None = None
    level: Rational | None = None
    multiplier: Pair | None = None
    symmetry: Rows | None = None
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""
        super().__post_init__()
        if self.kind not in PERIODIC_BIFURCATIONS:
            refuse("kind", f"{self.kind!r} is no kind", f"give one of {', '.join(PERIODIC_BIFURCATIONS)}")
        self._check_kernel()
        self._check_interval()
        is_torus, is_pitchfork = self.is_torus, self.is_mirrored
        if (self.multiplier is None) == is_torus or (is_torus and len(self.multiplier or ()) != 2):
            refuse("multiplier", f"{self.kind} with {self.multiplier}", "a torus has two numbers, others have none")
        if (self.symmetry is None) == is_pitchfork:
            refuse("symmetry", f"{self.kind} with {self.symmetry}", "a pitchfork has a matrix, others have none")
        size = len(self.system.given_state)
        if self.symmetry is not None and (len(self.symmetry) != size or any(len(row) != size for row in self.symmetry)):
            refuse("symmetry", "wrong shape", f"give {size} rows of {size} numbers")
        check_numbers({"multiplier": [self.multiplier or ()], "symmetry": self.symmetry or ()})

    @property
    def half_widths(self) -> Vector:
        """Half-widths of the box, then that of what varies."""
        return (*self.radii, self.parameter_radius)

    @property
    def is_fold(self) -> bool:
        """Whether the orbit turns back there in what varies: a multiplier is 1."""
        return self.kind == PERIODIC_FOLD

    @property
    def is_mirrored(self) -> bool:
        """Whether S takes the orbit to itself, and orbits branch off that it exchanges: a pitchfork."""
        return self.kind == PERIODIC_PITCHFORK

    @property
    def is_torus(self) -> bool:
        """Whether a torus is born: two multipliers leave the unit circle."""
        return self.kind == PERIODIC_TORUS

    def _check_kernel(self) -> None:
        size = len(self.radii)
        wanted = 2 if self.is_torus else 1
        if len(self.kernel) != wanted or any(len(row) != size for row in self.kernel):
            refuse("kernel", "wrong shape", f"give {wanted} of {size} numbers")
        check_numbers({"kernel": self.kernel, "kernel_radius": [(self.kernel_radius,)]})
        if not all(map(any, self.kernel)):
            refuse("kernel", "a vector is zero", "give an eigenvector, in the coordinates of the frame")
        check_positive("kernel_radius", [self.kernel_radius])

    def _check_interval(self) -> None:
        self.check_level(self.level)
        check_numbers({"parameter_radius": [(self.parameter_radius,)]})
        check_positive("parameter_radius", [self.parameter_radius])
        if self.is_torus and (self.level is not None or self.parameter is None):
            refuse("level", "a torus is claimed while a parameter varies, on no level", "name the parameter alone")
        if self.parameter is None:
            if self.level is None:
                refuse("parameter", "there is none, and no level", "name the parameter that varies, or give the level")
        else:
            self.check_varying(self.parameter, self.parameter_radius)
        fewest = 2 + (self.level is not None or self.is_torus)
        if len(self.system.given_state) < fewest:
            refuse("kind", f"{self.kind} takes a state of at least {fewest} coordinates", "give another kind")

    def __repr__(self) -> str:
        return f"<PeriodicBifurcation {self.id!r}: {self.kind}, {self.crossings} crossings, of {self.system.name}>"
