"""Claims about equilibria, Hopf points and curves of equilibria: written, read, and refused."""

from __future__ import annotations

import json
from dataclasses import replace
from fractions import Fraction as Q
from pathlib import Path
from typing import Any

import pytest
from support import equilibrium_cases as cases

from orbitproof.shared.errors import InputError
from orbitproof.shared.formats import read_atlas, write_atlas

REFUSED: dict[str, dict[str, Any]] = {
    "id": {"id": "a \n b"},
    "parameters": {"parameters": {"a": Q(0)}},
    "centre": {"centre": (Q(0),)},
    "radii": {"radii": (Q(1),)},
    "radii[1]": {"radii": (Q(1), Q(0), Q(1))},
    "kernel": {"kernel": ((Q(1), Q(0), Q(0)),)},
    "kernel: it is zero": {"kernel": ((Q(0),) * 3,) * 2},
    "kernel_radius[0]": {"kernel_radius": Q(0)},
    "parameter": {"parameter": "nu"},
    "parameter_radius[0]": {"parameter_radius": Q(-1)},
    "frequency": {"frequency": Q(1, 2**80)},
    "frequency_radius[0]": {"frequency_radius": Q(0)},
    "frequency: 1/3": {"frequency": Q(1, 3)},
}


@pytest.mark.parametrize("begins", REFUSED)
def test_malformed_claims_are_refused_with_the_field(begins: str) -> None:
    with pytest.raises(InputError) as refusal:
        replace(cases.hopf(), **REFUSED[begins])
    assert str(refusal.value).startswith(begins)
    assert "\n" not in str(refusal.value)


def test_parameters_are_put_in_by_their_names() -> None:
    claim = cases.hopf()
    assert len({*claim.values}) > 3
    assert replace(claim, parameters=dict(reversed(claim.parameters.items()))).values == claim.values


def test_curves_in_a_parameter_that_is_not_there_are_refused(tmp_path: Path) -> None:
    atlas = cases.curve_of_equilibria()
    path = tmp_path / "atlas.json"
    write_atlas(path, atlas)
    document = json.loads(path.read_text("utf-8"))
    for changes, field in (
        ({"claim": {**document["claim"], "parameter": "c"}}, "claim.parameter"),
        ({"claim": {**document["claim"], "increasing": ["w"]}}, "claim.increasing"),
        ({"parameters": {"c": "2"}}, "parameters"),
    ):
        path.write_text(json.dumps({**document, **changes}), "utf-8")
        with pytest.raises(InputError, match=field.replace(".", r"\.")):
            read_atlas(path)
