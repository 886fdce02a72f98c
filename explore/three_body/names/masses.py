"""Mass parameters of the restricted three-body problem: by name, as numbers, and which are refused."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from fractions import Fraction

from orbitproof.explore.names import exact_number, exact_parameters, values_by_name
from orbitproof.shared.formats import InputError
from orbitproof.shared.systems import CR3BP_PLANAR, MASS_PARAMETERS, THREE_BODY, ReversibleSystem

PI = Fraction("3.14159265358979323846264338327950288419716939937510582097494459")
"""pi, to 63 digits: an exact number that may stand in what an orbit is singled out by."""

MONTHS: Mapping[str, Fraction] = {
    "sidereal_month": 2 * PI,
    "synodic_month": 2 * PI * Fraction("29.530588853") / Fraction("27.321661547"),
}
"""The Moon's mean months at J2000 in time units of the Earth-Moon system, of which 2 pi are one sidereal month.

Of a sidereal month of 27.321661547 days and a synodic month of 29.530588853 days only the ratio counts.
"""


def mass_name(text: str) -> str:
    """The name of a mass parameter that is asked for, in any case; other texts as they are."""
    return text.casefold() if text.casefold() in MASS_PARAMETERS else text


def mass_parameter(option: str, text: str, *, or_zero: bool = False) -> Fraction:
    """A mass parameter, by name or as a number in (0, 1/2], in [0, 1/2] with `or_zero`. Raises `InputError`."""
    value = MASS_PARAMETERS.get(mass_name(text))
    if value is None:
        close = get_close_matches(text.casefold(), MASS_PARAMETERS, 1)
        remedy = f"did you mean {close[0]}?" if close else "give a number in (0, 1/2]"
        names = ", ".join(MASS_PARAMETERS)
        value = exact_number(option, text, f"neither a name ({names}) nor a number; {remedy}")
    # Neither the number nor the double next to it may be an end.
    inside = 0 < value < 1 and 0.0 < float(value) < 1.0
    if not inside and not (or_zero and value == 0):
        interval = "[0, 1/2]" if or_zero else "(0, 1/2]"
        raise InputError(f"{option} {text}: outside {interval}; give the smaller mass over the total mass")
    if (why := exchanged(value)) is not None:
        raise InputError(f"{option} {text}: {why}")
    return value


def exchanged(mass: Fraction) -> str | None:
    """Why a mass parameter is refused that is that of the larger primary, with the remedy; `None` up to 1/2."""
    if mass <= Fraction(1, 2):
        return None
    smaller = str(1 - mass) if (1 - mass).denominator < 1000 else f"{float(1 - mass):.17g}"
    return (
        f"above 1/2, so the primaries are exchanged; give the smaller mass over the total, 1 - mu = {smaller}, and "
        "states with the other sign of x, y, vx, vy"
    )


def exchanged_in(system: ReversibleSystem, name: str, value: Fraction) -> str | None:
    """Why a value of this parameter of a system is refused: as `exchanged` for the mass parameter of three bodies."""
    return exchanged(value) if name == "mu" and system in (*THREE_BODY, CR3BP_PLANAR) else None


def given_parameters(
    system: ReversibleSystem, mass: str | None, assignments: Sequence[str] | None, varying: str | None = None
) -> dict[str, Fraction]:
    """The exact fixed parameters from ``--parameter NAME=VALUE``; ``--mass`` gives that of the CR3BP.

    One of them may vary, and has no value then. Raises `InputError`.
    """
    texts = values_by_name("--parameter", assignments or ())
    known = [name for name in system.fixed_parameters if name in texts]
    if varying == "mu" and mass is not None:
        raise InputError(f"--mass {mass}: mu varies, and --point says near which value; leave it out")
    if mass is not None and len(known) == len(texts):
        if system.fixed_parameters != ("mu",) or "mu" in texts:
            why = "given by --parameter as well" if "mu" in texts else f"{system.name} has no mass parameter"
            raise InputError(f"--mass {mass}: {why}; leave it out")
        return {"mu": mass_parameter("--mass", mass)}
    if system.fixed_parameters == ("mu",) and not texts and varying is None:
        raise InputError(f"--mass: missing; give a name ({', '.join(MASS_PARAMETERS)}) or a number in (0, 1/2]")
    return exact_parameters(system, texts, varying, exchanged_in)
