"""Equilibria of vector fields once more. README, sections 17.1 to 17.3."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from flint import acb, arb, arb_mat, arb_series

from .conditions import Hypothesis, Vector
from .jets import CannotFollow, Jet, ball, precision
from .multipliers import multipliers
from .newton import KNOWN, Newton, checked
from .periodic import ERRORS
from .proof import NotProved
from .statement import BadCertificate, Program, exact, read

FUNCTIONS = "sin", "cos", "exp", "log"
HOPF = "hopf"


@dataclass(frozen=True)
class HopfClaim:
    """What the claim of a Hopf point says besides: what varies, the frequency, and the vector q about `kernel`."""

    parameter: str
    parameter_radius: Fraction
    frequency: Fraction
    frequency_radius: Fraction
    kernel: tuple[tuple[Fraction, ...], ...]
    kernel_radius: Fraction


@dataclass(frozen=True)
class EquilibriumStatement:
    """What a certificate claims of an equilibrium: the field, with the coordinates that are functions, and the box.

    Attributes:
        names: the given coordinates; `functions`: for each other one its name, the function and what it is of.
        varying: a parameter that varies, of a Hopf point or along a curve.
        claim: of a Hopf point; `None` for an equilibrium.
    """

    names: tuple[str, ...]
    parameters: Mapping[str, Fraction]
    field: Program
    functions: tuple[tuple[str, str, Program], ...]
    centre: tuple[Fraction, ...]
    radii: tuple[Fraction, ...] = ()
    varying: str | None = None
    claim: HopfClaim | None = None

    def rates(self, state: Sequence[Jet], *varied: Jet) -> list[Jet]:
        """Jets of f at the given coordinates, and at the value of what varies. README, 17.2."""
        known: dict[str, Any] = {**self.parameters, **dict(zip(self.names, state, strict=True))}
        if self.varying is not None:
            known |= dict(zip([self.varying], varied, strict=True))
        # A function of one that comes after it is not finite.
        known |= {name: Jet({(): arb("nan")}, state[0].degree) for name, _, _ in self.functions}
        for name, function, argument in self.functions:
            known[name] = applied(function, argument.at(known, state[0])[0])
        return self.field.at(known, state[0])[: len(state)]


def applied(function: str, jet: Jet) -> Jet:
    """A function of a jet, from its Taylor polynomial at the constant."""
    factors = getattr(arb_series([jet[()], 1], jet.degree + 1), function)()
    found, rest = Jet({}, jet.degree), jet.varying()
    for j in reversed(range(jet.degree + 1)):
        found = found * rest + Jet({(): factors[j]}, jet.degree)
    return found


@dataclass(frozen=True)
class ProvedEquilibrium:
    """The equilibrium is proved.

    Attributes:
        point: enclosures of the given coordinates, by name.
        multipliers: the eigenvalues of the derivative there, each in a ball of its own.
        left, right: how many of them have negative and positive real parts.
        is_only: whether the box of the claim is shown to have no other one.
        hypotheses, width, bits: as of `ProvedPeriodic`.
    """

    point: dict[str, arb]
    multipliers: tuple[acb, ...]
    left: int
    right: int
    is_only: bool
    hypotheses: tuple[Hypothesis, ...]
    width: int
    bits: int


class OfEquilibrium(Newton):
    """One attempt; the unknowns begin with the given coordinates."""

    lost = 0

    def __init__(self, statement: EquilibriumStatement, bits: int) -> None:
        self.statement, self.bits, self.size = statement, bits, len(statement.names)
        self.centre, self.reach = [ball(c).mid() for c in statement.centre], arb(0)

    def evaluated(self, around: Sequence[arb], degree: int) -> tuple[None, list[Jet]]:
        """Jets of f in the coordinates, and in what varies."""
        count = self.size + (self.statement.claim is not None)
        state = [Jet({(): x, (j,): arb(1)}, degree) for j, x in enumerate(around[:count])]
        return None, self.statement.rates(state[: self.size], *state[self.size :])

    def system(self, rows: Sequence[Jet], around: Sequence[arb]) -> list[Vector]:
        """The derivatives of all equations by all unknowns, at the points of a set."""
        return [[row[j,] for j in range(self.size)] for row in rows]

    def zeros(self, rows: Sequence[Jet]) -> Vector:
        """The left sides of all equations at the centre."""
        return [row[()] for row in rows]

    def names(self) -> list[str]:
        """The names of all unknowns."""
        return list(self.statement.names)

    def box(self) -> Vector:
        """The unknowns that the box of the claim allows."""
        pairs = zip(self.statement.centre, self.statement.radii, strict=True)
        return [about(middle, radius) for middle, radius in pairs]

    def is_only(self) -> bool:
        """Whether the equations are shown to have one zero at most in the box of the claim. README, 17.3."""
        try:
            box = self.box()
            inverse = arb_mat(self.system(self.evaluated(box, self.degree[1])[1], box)).inv()
        except (CannotFollow, ZeroDivisionError):
            return False
        return all(entry.is_finite() for entry in inverse.entries())


def about(middle: Fraction, radius: Fraction) -> arb:
    """An interval of a claim."""
    return ball(middle) + arb(0, ball(radius).upper())


def prove_equilibrium(certificate: Mapping[str, Any]) -> ProvedEquilibrium | NotProved:
    """Prove the equilibrium that a certificate claims, from its statement and its box alone.

    Raises `BadCertificate` for a certificate that cannot be read; whatever else goes wrong is a `NotProved`.
    """
    statement = read_equilibrium(certificate)
    bits = bits_for(statement.radii)
    with precision(bits):
        try:
            proof = OfEquilibrium(statement, bits)
            newton, zero, _, rows = proof.enclosed()
            hypotheses = checked([newton])
            balls = multipliers(arb_mat(proof.system(rows, zero)), [])
            counts = sum(z.real < 0 for z in balls), sum(z.real > 0 for z in balls)
            point = dict(zip(statement.names, zero, strict=True))
            return ProvedEquilibrium(point, tuple(balls), *counts, proof.is_only(), hypotheses, proof.width, bits)
        except (CannotFollow, *ERRORS) as error:
            return NotProved(f"{type(error).__name__}: {error}")


def bits_for(radii: Sequence[Fraction]) -> int:
    """Bits in which the box of a claim is wide."""
    return 2 * KNOWN + 2 * max((1 / radius).__ceil__().bit_length() for radius in radii)


def read_field(certificate: Mapping[str, Any], parameters: Mapping[str, Fraction]) -> EquilibriumStatement:
    """The field of a certificate; centre and radii are empty. Raises `BadCertificate`."""
    field = read(certificate, "statement.vector_field", Program.from_text)
    state = field.inputs[: len(field.outputs)]
    functions = read(certificate, "statement", lambda given: tuple(map(_function, given.get("functions") or ())))
    size = len(state) - len(functions)
    inputs = {*field.inputs, *(name for _, _, argument in functions for name in argument.inputs)}
    if len(set(state)) != len(state) or state[size:] != tuple(name for name, _, _ in functions) or size < 1:
        raise BadCertificate("statement.functions: are not the last coordinates of the state")
    if not {*state, *parameters} >= inputs or {*state} & {*parameters}:
        raise BadCertificate("parameters: state and parameters are not the inputs of the programs")
    return EquilibriumStatement(state[:size], parameters, field, functions, ())


def read_equilibrium(certificate: Mapping[str, Any]) -> EquilibriumStatement:
    """The statement of a certificate of an equilibrium or of a Hopf point. Raises `BadCertificate`."""
    claim = "statement.candidate"
    parameters = read(certificate, f"{claim}.parameters", lambda known: {n: exact(v) for n, v in known.items()})
    statement = read_field(certificate, parameters)
    centre, radii = (read(certificate, f"{claim}.{name}", exact) for name in ("centre", "radii"))
    size, varying = len(statement.names), None
    if read(certificate, f"{claim}.kind", str) == HOPF:
        names = "parameter_radius", "frequency", "frequency_radius", "kernel", "kernel_radius"
        numbers = [read(certificate, f"{claim}.{name}", exact) for name in names]
        varying = HopfClaim(read(certificate, f"{claim}.parameter", str), *numbers)
        widths = varying.parameter_radius, varying.frequency_radius, varying.kernel_radius
        shape = [len(row) for row in varying.kernel]
        if varying.parameter not in parameters or shape != [size, size] or min(widths) <= 0:
            raise BadCertificate(f"{claim}: parameter, kernel or half-widths are not those of a claim")
    if len(centre) != size or len(radii) != size or min(radii) <= 0:
        raise BadCertificate(f"{claim}: centre and radii do not have the sizes of the coordinates")
    name = None if varying is None else varying.parameter
    return replace(statement, centre=centre, radii=radii, varying=name, claim=varying)


def _function(given: Mapping[str, Any]) -> tuple[str, str, Program]:
    argument = Program.from_text(given["argument"])
    if given["function"] not in FUNCTIONS or len(argument.outputs) != 1:
        raise ValueError(f"{given['function']} is no function of one argument that is known here")
    return str(given["coordinate"]), given["function"], argument
