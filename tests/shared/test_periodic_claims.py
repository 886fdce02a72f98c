"""Claims about periodic orbits without symmetry: written, read, and refused."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.periodic_cases import LORENZ

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import (
    PeriodicOrbit,
    candidate_from_json,
    define_system,
    read_candidates,
    read_claims,
    write_candidates,
)
from orbitproof.shared.systems import System


def _claim(**changes: Any) -> PeriodicOrbit:
    zero, one = Fraction(0), Fraction(1)
    claim = PeriodicOrbit(
        id="AB",
        system=LORENZ,
        parameters={"sigma": Fraction(10), "rho": Fraction(28), "beta": Fraction(8, 3)},
        normal=(zero, zero, one),
        offset=Fraction(27),
        direction=-1,
        crossings=2,
        centre=(Fraction(-17, 8), Fraction(33, 16), Fraction(27)),
        frame=((one, zero), (zero, one), (zero, zero)),
        radii=(Fraction(1, 1024), Fraction(1, 1024)),
    )
    return replace(claim, **changes)


def test_a_system_with_a_first_integral_needs_no_symmetry() -> None:
    system = define_system(
        {"name": "turn", "state": "x y", "field": {"x": "y", "y": "-x"}, "first_integral": "x**2 + y**2"}
    )
    assert type(system) is System
    assert system.first_integral_program is not None
    assert system.first_integral_name == "first integral"


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"direction": 0}, "direction"),
        ({"crossings": 0}, "crossings"),
        ({"parameters": {"sigma": Fraction(10)}}, "parameters"),
        ({"radii": (Fraction(1), Fraction(0))}, "radii[1]"),
        ({"radii": (Fraction(1),)}, "radii"),
        ({"normal": (Fraction(1),)}, "normal"),
        ({"centre": (Fraction(1),) * 4}, "centre"),
        ({"centre": (Fraction(1, 3),) * 3}, "centre"),
        ({"frame": ((Fraction(1),),) * 3}, "frame"),
        ({"level": Fraction(1)}, "level"),
        ({"id": "\n"}, "id"),
        ({"offset": 0.5}, "offset"),
    ],
)
def test_what_is_no_claim_is_refused(changes: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as error:
        _claim(**changes)
    assert str(error.value).startswith(f"{field}: ")


def test_files_name_the_field_that_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "claims.json"
    write_candidates(path, [_claim()])
    document = json.loads(path.read_text())
    document["candidates"][0]["direction"] = 2
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="direction"):
        read_claims(path)
    del document["candidates"][0]["system"]["field"]
    document["candidates"][0]["direction"] = 1
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"system\.field: missing"):
        read_claims(path)


def test_what_is_about_symmetric_orbits_only_says_so(tmp_path: Path) -> None:
    path = tmp_path / "claims.json"
    write_candidates(path, [_claim()])
    with pytest.raises(InputError, match="about no symmetric orbit, which is not available here"):
        read_candidates(path)
    with pytest.raises(InputError, match="about no symmetric orbit, which is not available here"):
        candidate_from_json(json.loads(path.read_text())["candidates"][0], "claim")


def test_coordinates_that_are_functions_of_others_are_none_of_the_claim() -> None:
    field = {"x": "y", "y": "cos(z) - x", "z": "-z"}
    system = define_system({"name": "forced", "state": "x y z", "field": field})
    claim = _claim(system=system, parameters={})
    assert claim.coordinates == ("x", "y", "z")
    assert system.state == ("x", "y", "z", "cos_z", "sin_z")
    with pytest.raises(InputError, match="centre: 5 numbers; give 3; the state is x, y, z"):
        replace(claim, centre=(*claim.centre, Fraction(1), Fraction(0)))
