"""Names of a file in formulas: any of them can be shown."""

from __future__ import annotations

import pytest
from latex2mathml.converter import convert
from support.metamorphic_changes import words

from orbitproof.figures.report.formulas import to_latex

ODD = (
    "vx1",
    "vx_1",
    "v_",
    "_x",
    "__a__",
    "x_1_2",
    "x1_0",
    "vmu1",
    "alpha_1",
    "eps_a",
    "R_coordinate",
    "h_1_coordinate",
)


@pytest.mark.parametrize("formula", ["{0}' = -2*{0}^2 + {0}/3", "H = {0}^(1/2)*(1 + {0})", "{0}"])
def test_any_name_can_be_shown(formula: str) -> None:
    """Formulas of LaTeX with two indices of one letter cannot."""
    for name in (*ODD, *words()):
        assert convert(to_latex(formula.format(name))).startswith("<math"), name


def test_names_have_one_index_at_most() -> None:
    shown = {"vx1": "v_{x_{1}}", "x_1": "x_{1}", "x1": "x_{1}", "x_1_2": r"\text{ x\_1\_2 }", "_x": r"\text{ \_x }"}
    assert {name: to_latex(name) for name in shown} == shown
