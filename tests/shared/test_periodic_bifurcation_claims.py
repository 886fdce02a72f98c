"""Claims about bifurcations of periodic orbits without symmetry: written, read, and refused."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import pytest
from support.periodic_cases import LORENZ, OSCILLATORS

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import PeriodicBifurcation, define_system, read_claims, write_candidates
from orbitproof.verify.certificate import certify

ZERO, ONE = Fraction(0), Fraction(1)
TURN = ((-ONE, ZERO, ZERO), (ZERO, -ONE, ZERO), (ZERO, ZERO, ONE))


def _claim(**changes: Any) -> PeriodicBifurcation:
    claim: dict[str, Any] = {
        "id": "fold",
        "system": LORENZ,
        "parameters": {"sigma": Fraction(10), "rho": Fraction(28), "beta": Fraction(8, 3)},
        "normal": (ZERO, ZERO, ONE),
        "offset": Fraction(27),
        "direction": -1,
        "crossings": 2,
        "centre": (Fraction(-17, 8), Fraction(33, 16), Fraction(27)),
        "frame": ((ONE, ZERO), (ZERO, ONE), (ZERO, ZERO)),
        "radii": (Fraction(1, 1024), Fraction(1, 1024)),
        "kind": "periodic-fold",
        "kernel": ((ONE, Fraction(1, 3) - Fraction(1, 3)),),
        "kernel_radius": Fraction(1, 2**10),
        "parameter": "rho",
        "parameter_radius": Fraction(1, 2**20),
    }
    return PeriodicBifurcation(**(claim | changes))


TORUS: dict[str, Any] = {
    "id": "torus",
    "kind": "periodic-torus",
    "kernel": ((ONE, ZERO), (ZERO, ONE)),
    "multiplier": (Fraction(3, 4), Fraction(5, 8)),
}
PITCHFORK: dict[str, Any] = {"id": "pitchfork", "kind": "periodic-pitchfork", "symmetry": TURN}


def _on_level(**changes: Any) -> PeriodicBifurcation:
    size = 4
    claim: dict[str, Any] = {
        "id": "level",
        "system": OSCILLATORS,
        "parameters": {},
        "normal": (ZERO, ONE, ZERO, ZERO),
        "offset": ZERO,
        "direction": -1,
        "crossings": 1,
        "centre": (Fraction(2), ZERO, ZERO, ZERO),
        "frame": tuple(tuple(Fraction(int(i == j)) for j in range(size) if j != 1) for i in range(size)),
        "radii": (Fraction(1, 8),) * 3,
        "kind": "periodic-doubling",
        "kernel": ((ZERO, ONE, ZERO),),
        "kernel_radius": Fraction(1, 8),
        "parameter_radius": Fraction(1, 8),
        "level": Fraction(7, 3),
    }
    return PeriodicBifurcation(**(claim | changes))


@pytest.mark.parametrize(
    ("changes", "field"),
    [
        ({"kind": "fold"}, "kind"),
        ({"kernel": ()}, "kernel"),
        ({"kernel": ((ONE, ZERO), (ZERO, ONE))}, "kernel"),
        ({"kernel": ((ONE,),)}, "kernel"),
        ({"kernel": ((ZERO, ZERO),)}, "kernel"),
        ({"kernel": ((0.5, ZERO),)}, "kernel"),
        ({"kernel": ((Fraction(1, 3), ONE),)}, "kernel"),
        ({"kernel_radius": ZERO}, "kernel_radius"),
        ({"parameter_radius": ZERO}, "parameter_radius"),
        ({"parameter_radius": Fraction(1, 3)}, "parameter_radius"),
        ({"parameter": "tau"}, "parameter"),
        ({"parameter": None}, "parameter"),
        ({"level": ONE}, "level"),
        ({"multiplier": (ONE, ZERO)}, "multiplier"),
        ({**TORUS, "multiplier": None}, "multiplier"),
        ({**TORUS, "multiplier": (ONE,)}, "multiplier"),
        ({**TORUS, "kernel": ((ONE, ZERO),)}, "kernel"),
        ({**TORUS, "kernel": ((ONE, ZERO), (ZERO, ZERO))}, "kernel"),
        ({"symmetry": TURN}, "symmetry"),
        ({**PITCHFORK, "symmetry": None}, "symmetry"),
        ({**PITCHFORK, "symmetry": TURN[:2]}, "symmetry"),
        ({**PITCHFORK, "symmetry": (*TURN[:2], TURN[2][:2])}, "symmetry"),
        ({**PITCHFORK, "symmetry": ((Fraction(1, 3), ZERO, ZERO), *TURN[1:])}, "symmetry"),
        ({"direction": 2}, "direction"),
        ({"radii": (ONE, ZERO)}, "radii[1]"),
        ({"offset": 0.5}, "offset"),
    ],
)
def test_what_is_no_claim_is_refused(changes: dict[str, Any], field: str) -> None:
    with pytest.raises(InputError) as error:
        _claim(**changes)
    assert str(error.value).startswith((f"{field}: ", f"{field}["))


def test_a_state_of_few_coordinates_has_no_such_points() -> None:
    turn = define_system(
        {"name": "turn", "state": "x y", "field": {"x": "y", "y": "-x"}, "first_integral": "x**2 + y**2"}
    )
    small: dict[str, Any] = {
        "system": turn, "normal": (ZERO, ONE), "centre": (Fraction(2), ZERO), "frame": ((ONE,), (ZERO,)),
        "radii": (ONE,), "kernel": ((ONE,),),
    }  # fmt: skip
    with pytest.raises(InputError, match="at least 3 coordinates"):
        _on_level(**small)


def test_the_values_of_a_parameter_stay_in_its_range() -> None:
    for least, most in ((ZERO, Fraction(29)), (Fraction(27), Fraction(100))):
        interval = type(LORENZ.parameters["rho"])(least, most)
        system = replace(LORENZ, parameters={**LORENZ.parameters, "rho": interval})
        _claim(system=system)
        with pytest.raises(InputError, match="parameter_radius"):
            _claim(system=system, parameter_radius=Fraction(3, 2))


def test_files_name_the_field_that_is_wrong(tmp_path: Path) -> None:
    path = tmp_path / "claims.json"
    write_candidates(path, [_claim()])
    document = json.loads(path.read_text())
    document["candidates"][0]["parameter"] = "tau"
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match=r"candidates\[0\]\.parameter: .*'tau'"):
        read_claims(path)
    del document["candidates"][0]["kernel"]
    path.write_text(json.dumps(document))
    with pytest.raises(InputError, match="kernel"):
        read_claims(path)


def test_a_bifurcation_that_is_none_is_not_proved_and_nothing_breaks_off() -> None:
    for claim in (_claim(), _claim(**TORUS), _claim(**PITCHFORK), _on_level()):
        certificate = certify(claim)
        assert not certificate.proved
        assert certificate.reason is not None
        assert certificate.computation.precision < 320, "more bits do not help"
        assert certificate.reason.condition not in ("exact checks", "integration", "evaluation", "verification")
