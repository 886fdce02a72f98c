"""Claims about boxes: bifurcations of symmetric periodic orbits, and single orbits."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal, NoReturn

from orbitproof.shared.claims.fields import Crossings, Id, Identifier, Numbers, Rows
from orbitproof.shared.errors import InputError, short
from orbitproof.shared.numbers import NUMBER, RATIONAL, format_exact, format_rational
from orbitproof.shared.stored import Rational, rules, stored
from orbitproof.shared.systems import ID, ID_IN_WORDS, LEVEL_NAME, ReversibleSystem, fits

FOLD = "fold"
ONCE = ("symmetry_breaking", FOLD)
"""Kinds of bifurcations of period-two points, k = 1; all others have k > 1."""
KINDS = (*ONCE, "period_tupling", "touch_and_go")

LEADING_POWERS = {kind: 1 if kind == "touch_and_go" else 2 for kind in KINDS}
"""Powers with which the bifurcation parameter begins to change along the new orbits, by kind (section 9.5)."""

ORBIT, STABLE_ORBIT, INVARIANT_TORI = "orbit", "stable_orbit", "invariant_tori"
"""What a claim says about one orbit, one that is stable for ever, one at which invariant tori accumulate; k = 1."""
ORBIT_KINDS = (ORBIT, STABLE_ORBIT, INVARIANT_TORI)
"""Claims about one orbit that an equation singles out."""
REVERSOR_BREAKING, KREIN_COLLISION = "reversor_breaking", "krein_collision"
"""Two orbits are born that R does not map to themselves; two pairs of multipliers meet on the unit circle and leave."""
DOUBLE_RESONANCE = "double_resonance"
"""What a claim says about a parameter at which two 1:k resonances of a family meet: a value of a coordinate beside
those of Fix(R)."""
ACROSS_KINDS = (REVERSOR_BREAKING, KREIN_COLLISION)
"""Claims about one orbit of a family whose proofs follow points beside Fix(R) too."""
BOX_KINDS = (*KINDS, *ORBIT_KINDS, *ACROSS_KINDS, DOUBLE_RESONANCE)
"""All that a candidate may claim."""
HALF_PERIOD, LEVEL, COORDINATE = "half period", "level", "coordinate"
QUANTITIES = (HALF_PERIOD, LEVEL, COORDINATE)
"""What one orbit of a family can be given by."""


@dataclass(frozen=True)
class Equation:
    """What singles out one orbit of a family: quantity = value.

    Attributes:
        quantity: one of `QUANTITIES`; the level is that of the first integral, the coordinate one of the centre's.
        value: the value, exactly; of the half period in nondimensional units.
        coordinate: name of the coordinate, if the quantity is one.
    """

    quantity: Literal["half period", "level", "coordinate"]
    value: Rational
    coordinate: Identifier | None = None


class OfKind:
    """What is about a symmetric orbit or bifurcation, and says what by a `kind`, one of `BOX_KINDS`."""

    kind: Any
    uses_reversor = True

    @property
    def is_of_orbit(self) -> bool:
        """Whether it is about one orbit, and no bifurcation."""
        return bool(self.kind in ORBIT_KINDS)

    @property
    def is_fold(self) -> bool:
        """Whether the family turns back there in the bifurcation parameter."""
        return bool(self.kind == FOLD)

    @property
    def breaks_symmetry(self) -> bool:
        """Whether the orbits that branch off are not those that S maps to themselves."""
        return bool(self.kind == "symmetry_breaking")

    @property
    def loses_reversor(self) -> bool:
        """Whether orbits are born that R does not map to themselves."""
        return bool(self.kind == REVERSOR_BREAKING)


@dataclass(frozen=True, repr=False)
class Candidate(OfKind):
    """A claim: the box ``centre + frame * (P_0 x P_1 x P_2)`` contains a bifurcation, or one orbit.

    Attributes:
        id: unique name within a file.
        system: the reversible system.
        parameters: exact values of the system's fixed parameters, by name; where two resonances meet, of all but one,
            which is the first coordinate then.
        kind: one of `BOX_KINDS`.
        k: multiplicity; 1 exactly for symmetry breaking, folds, orbits, where R is lost, and where multipliers collide.
        symmetry: name of the symmetry S that breaks, for symmetry breaking; for period tupling with k = 3, of one that
            fixes the points of the family.
        centre: shape (1 + n,), in the order of `coordinates`; 2 + n numbers where two resonances meet, and so below.
        frame: shape (1 + n, 1 + n), rows; column j is the direction of p_j.
        kernel_frame: shape (n, n), rows; q_i is row i times the kernel coordinates.
        radii: shape (1 + n,), half-widths of P_0, P_1, P_2, all positive.
        provenance: free-form, ignored by the verifier.
        level_sign: `None`, or, if the first integral is the first coordinate, the sign of the system's
            level coordinate, which follows from it on Fix(R).
        crossings: m, how often a half orbit, from Fix(R) to Fix(R), meets the section after its start; P^m then
            stands for P.
        equation: what singles out the orbit, if the claim is about one.
        twist: the sign of the twist of a stable orbit, if it is claimed.
    """

    id: Id
    system: ReversibleSystem
    parameters: Mapping[Identifier, Rational]
    kind: Literal[
        "symmetry_breaking", "fold", "period_tupling", "touch_and_go",
        "orbit", "stable_orbit", "invariant_tori", "reversor_breaking", "krein_collision", "double_resonance",
    ]  # fmt: skip
    k: Annotated[int, rules(minimum=1, maximum=1000)]
    centre: Numbers
    frame: Rows
    kernel_frame: Rows
    radii: Numbers
    symmetry: Identifier | None = stored(always=True, default=None)
    provenance: Mapping[str, Any] = stored(always=True, default_factory=dict)
    level_sign: Literal[1, -1] | None = stored(beside=("parameter", "first integral"), default=None)
    crossings: Crossings = 1
    equation: Equation | None = None
    twist: Literal[1, -1] | None = None

    def __post_init__(self) -> None:
        """Raises `InputError`, one line that begins with the field, for what could not be written as a claim."""

        def refuse(name: str, why: str, remedy: str) -> NoReturn:
            raise InputError(f"{name}: {why}; {remedy}")

        if not fits(ID, self.id):
            refuse("id", f"{self.id!r} is no id", ID_IN_WORDS)
        if self.kind not in BOX_KINDS:
            refuse("kind", f"{self.kind!r} is unknown", f"give one of {', '.join(BOX_KINDS)}")
        if self.system.arrival is not None:
            refuse("system", f"half orbits of {self.system.name} do not end in Fix(R)", "claim a curve of it (atlas)")
        if not isinstance(self.k, int) or self.k < 1:
            refuse("k", f"{self.k!r} is no multiplicity", "give an integer, at least 1")
        if not isinstance(self.crossings, int) or self.crossings < 1:
            refuse("crossings", f"{self.crossings!r} is no number of crossings", "give an integer, at least 1")
        if self.symmetry is not None and self.symmetry not in self.system.symmetries:
            known = ", ".join(self.system.symmetries) or "none"
            refuse("symmetry", f"{self.system.name} has no symmetry {self.symmetry!r}", f"known: {known}")
        if self.looks_across and (self.k != 1 or self.symmetry is not None):
            refuse("kind", f"{self.kind} with k = {self.k} and {self.symmetry}", "give k = 1, and no symmetry")
        if self.resonances_meet:
            from orbitproof.shared.claims.special_claims import check_varying

            check_varying(self, refuse)
        elif set(self.parameters) != set(self.system.fixed_parameters):
            wanted = ", ".join(self.system.fixed_parameters) or "none"
            refuse("parameters", f"there are {', '.join(self.parameters) or 'none'}", f"give exactly {wanted}")
        if self.level_sign is not None and self.system.family_parameter is not None:
            refuse("level_sign", f"{self.system.name} has the parameter {self.system.family_parameter}", "leave it out")
        if self.is_of_orbit != (self.equation is not None):
            refuse("equation", "a claim about an orbit has one, others have none", "give both or none")
        if self.twist is not None and (self.kind != STABLE_ORBIT or self.twist not in (1, -1)):
            refuse("twist", f"{self.kind} with {self.twist!r}", "a stable orbit may have 1 or -1, others have none")
        if self.equation is not None:
            from orbitproof.shared.claims.special_claims import check_equation

            check_equation(self, self.equation, refuse)
        names, kernel = self.titles, len(self.system.kernel_coordinates)
        size, wanted = len(names), ", ".join(names)
        for name, values in (("centre", self.centre), ("radii", self.radii)):
            if len(values) != size:
                refuse(name, f"{len(values)} numbers", f"{self.system.name} needs {size}: {wanted}")
        for name, matrix, n in (("frame", self.frame, size), ("kernel_frame", self.kernel_frame, kernel)):
            if len(matrix) != n or any(len(row) != n for row in matrix):
                refuse(name, "wrong shape", f"give {n} rows of {n} numbers")
        numbers: dict[str, Sequence[Sequence[Fraction]]] = {
            **{f"parameters.{name}": [[value]] for name, value in self.parameters.items()},
            "centre": [self.centre], "frame": self.frame, "kernel_frame": self.kernel_frame, "radii": [self.radii],
        }  # fmt: skip
        if self.equation is not None:
            numbers[_EQUATION_VALUE] = [[self.equation.value]]
        for name, rows in numbers.items():
            for value in (value for row in rows for value in row):
                if not isinstance(value, (int, Fraction)):
                    refuse(name, f"{value!r} is no exact number", "give Fractions, shared.parse_exact reads them")
                try:
                    short_enough = _can_be_written(Fraction(value), _is_rational(name))
                except ValueError:
                    refuse(name, f"{short(str(value))} is neither dyadic nor decimal", "round it to a decimal number")
                if not short_enough:
                    refuse(name, "a number is too long to be written exactly", "give fewer digits, an exponent near 0")
        for position, radius in enumerate(self.radii):
            if radius <= 0:
                refuse(f"radii[{position}]", "not positive", "give positive half-widths")

    def __repr__(self) -> str:
        return f"<Candidate {self.id!r}: {self.kind}, k = {self.k}, of {self.system.name}>"

    @property
    def coordinates(self) -> tuple[str, ...]:
        """Names of the coordinates of the centre, no two alike (1.6); a parameter first where two resonances meet."""
        if self.resonances_meet:
            return (self.varying, *self.system.centre_coordinates)
        return self.system.centre_coordinates if self.level_sign is None else self.system.level_coordinates

    @property
    def titles(self) -> tuple[str, ...]:
        """What people call the `coordinates`; nothing is found by these."""
        level = self.system.first_integral_name or "first integral"
        return tuple(level if name == LEVEL_NAME else name for name in self.coordinates)

    @property
    def has_branch(self) -> bool:
        """Whether other symmetric orbits branch off there."""
        return not (self.is_of_orbit or self.is_fold or self.looks_across or self.resonances_meet)

    @property
    def resonances_meet(self) -> bool:
        """Whether two 1:k resonances of the family meet there while a parameter of the system varies."""
        return self.kind == DOUBLE_RESONANCE

    @property
    def varying(self) -> str:
        """The parameter that has no value of its own, where two resonances meet."""
        return next(name for name in self.system.fixed_parameters if name not in self.parameters)

    @property
    def looks_across(self) -> bool:
        """Whether points beside Fix(R) count: R is lost there, or multipliers collide."""
        return self.kind in ACROSS_KINDS

    @property
    def uses_symmetry(self) -> bool:
        """Whether the theorem rests on a symmetry S, which maps the family to itself, point by point."""
        return self.breaks_symmetry or (self.kind == "period_tupling" and self.k == 3)

    @property
    def is_tangential(self) -> bool:
        """Whether the bifurcation parameter has an extremum along the branch, or along the curve of a fold."""
        return LEADING_POWERS.get(self.kind, 2) > 1

    @property
    def uses_level(self) -> bool:
        """Whether a coordinate of its points follows from the level of the first integral."""
        return self.level_sign is not None or self.system.fixed_level is not None

    @property
    def is_family_of_maps(self) -> bool:
        """Whether the first coordinate is the bifurcation parameter: a family parameter or the level of H."""
        return self.system.family_parameter is not None or self.level_sign is not None


_EQUATION_VALUE = "equation.value"


def _is_rational(name: str) -> bool:
    """Whether a number of a claim may be any fraction."""
    return name.startswith("parameters") or name == _EQUATION_VALUE


def _can_be_written(value: Fraction, is_parameter: bool) -> bool:
    """Whether the text of a number is one that files may hold. Raises `ValueError` for one that has no such text."""
    text = format_rational(value) if is_parameter else format_exact(value)
    return re.fullmatch(RATIONAL if is_parameter else NUMBER, text) is not None
