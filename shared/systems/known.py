"""The systems that every installation knows, and mass parameters by name."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

from orbitproof.shared.systems.hill import HILL, HILL_AXIAL
from orbitproof.shared.systems.system import ParameterRange, ReversibleSystem
from orbitproof.shared.systems.three_body import CR3BP, CR3BP_AXIAL, CR3BP_PLANAR


def _falkner_skan(state: Sequence[Any], parameters: Sequence[Any]) -> Sequence[Any]:
    x, y, z = state
    (beta,) = parameters
    return (y, z, beta * (y * y - 1) - x * z)


FALKNER_SKAN = ReversibleSystem(
    name="falkner-skan",
    title="Falkner-Skan equation",
    state=("x", "y", "z"),
    parameters={"beta": ParameterRange(None, None)},
    vector_field=_falkner_skan,
    reversing_symmetry=(-1, 1, -1),
    section="z",
    family_parameter="beta",
)

SYSTEMS: Mapping[str, ReversibleSystem] = {
    system.name: system for system in (CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, HILL, HILL_AXIAL, FALKNER_SKAN)
}

MASS_PARAMETERS: Mapping[str, Fraction] = {
    "earth-moon": Fraction(float.fromhex("0x1.8e267d713713fp-7")),
    "sun-jupiter": Fraction(float.fromhex("0x1.f41bc26a74648p-11")),
    "jpl-earth-moon": Fraction("1.215058560962404e-2"),
    "jupiter-europa": Fraction("2.528017528540000e-5"),
    "mars-phobos": Fraction("1.611081404409632e-8"),
    "saturn-enceladus": Fraction("1.901109735892602e-7"),
    "saturn-titan": Fraction("2.366393158331484e-4"),
    "sun-earth": Fraction("3.054200000000000e-6"),
    "sun-mars": Fraction("3.227154996101724e-7"),
}
"""Mass parameters by name, exactly: the first two are those of the paper, equation (EM_SJ_mass), two IEEE doubles; the
others those of the systems of the JPL three-body periodic orbit catalogue, as decimals."""
EARTH_MOON = MASS_PARAMETERS["earth-moon"]
SUN_JUPITER = MASS_PARAMETERS["sun-jupiter"]
