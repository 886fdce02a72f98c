"""Deliberate faults: a copy of the package with one line changed fails the check that is named beside it."""

from __future__ import annotations

import importlib
import shutil
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from property_checks import CHECKS

from orbitproof.verify import second_proof

SOURCE = Path(second_proof.__file__).parent

FAULTS = {
    "remainder dropped": ("flow", "arb(0, (bound * g * last).upper())", "arb(0)", "remainder_covers_short_series"),
    "Picard's inclusion not checked": (
        "flow",
        "if all(o.contains(",
        "if outer is not box or all(o.contains(",
        "discs_end_before_the_solution_does",
    ),
    "bound at the centre only": (
        "flow",
        "tuple(z.abs_upper() for z in box)",
        "tuple(abs(x).upper() for x in start)",
        "discs_end_before_the_solution_does",
    ),
    "wrong factor in the integral of a series": (
        "flow",
        "c / (low + j)",
        "c / (low + j + 1)",
        "flow_encloses_exact_solutions",
    ),
    "wrong factor in variation of constants": (
        "flow",
        "powers[j] / j",
        "powers[j] / (j + 1)",
        "flow_encloses_exact_solutions",
    ),
    "fundamental matrix off by one": ("flow", "initial=arb(0)", "initial=arb(1)", "flow_encloses_exact_solutions"),
    "inverse with the wrong sign": ("flow", "[[-c for c in row]", "[[c for c in row]", "flow_encloses_exact_solutions"),
    "crossing not counted": (
        "crossing",
        "if sign not in (0, after):",
        "if sign == -1 and after == 1:",
        "oscillator_crossings_are_counted",
    ),
    "start counted as a crossing": (
        "crossing",
        "if sign not in (0, after):",
        "if sign != after:",
        "free_fall_crossing",
    ),
    "crossing counted late": (
        "crossing",
        "pieces[: crossings - len(states)]",
        "pieces[1:]",
        "oscillator_crossings_are_counted",
    ),
    "crossing time not widened": (
        "crossing",
        "moment = guess - value / step.section_slope(moment.union(guess))",
        "moment = guess",
        "free_fall_crossing",
    ),
    "time derivative dropped at the crossing": (
        "crossing",
        "for _ in range(table.degree):\n        field",
        "for _ in range(table.degree - 1):\n        field",
        "free_fall_crossing",
    ),
    "first integral not checked": (
        "crossing",
        "if not all(",
        "if False and not all(",
        "wrong_first_integral_is_noticed",
    ),
    "binomial without its denominator": (
        "jets",
        "weight *= order / (j + 1)",
        "weight *= order",
        "flow_encloses_exact_solutions",
    ),
    "squares lose their cross terms": ("jets", "term = term + term", "term = term", "flow_encloses_exact_solutions"),
    "implicit function one order short": (
        "jets",
        "for _ in range(table.degree):\n        rest",
        "for _ in range(table.degree - 1):\n        rest",
        "implicit_functions_have_their_jet",
    ),
    "negation lost": ("jets", "b if sign > 0 else -b", "b", "nothing_minus_something"),
    "root of any enclosure": ("jets", "if not first > 0:", "if first < 0:", "roots_need_a_positive_enclosure"),
    "derivative without its factor": (
        "conditions",
        "(a[j] + 1) * entry(above)",
        "entry(above)",
        "tables_enclose_derivatives",
    ),
    "mean value form at the centre only": (
        "conditions",
        "total = total + arb(0, radius.upper())",
        "total = total + 0 * arb(0, radius.upper())",
        "tables_enclose_derivatives",
    ),
    "factor 3 of the second derivative": (
        "conditions",
        "3 * (g01 + g00 * p0_1)",
        "(g01 + g00 * p0_1)",
        "normal_forms_have_their_side",
    ),
    "side exchanged": ("conditions", '"above" if bend > 0', '"above" if bend < 0', "normal_forms_have_their_side"),
    "factorials forgotten": ("conditions", "_factorial(a[0]) * _factorial(a[1])", "1", "normal_forms_have_their_side"),
    "reduction forgotten": (
        "conditions",
        "jets = eliminate(monomials(3, 3), last[1].jet(spread), jets)",
        "jets = eliminate(monomials(3, 3), [arb(0)] * 3 + [arb(1)] + [arb(0)] * 16, jets)",
        "reduction_removes_p2",
    ),
    "HC3 without inclusion": (
        "conditions",
        "nonzero(g_0) and inside(p0, radii[0])",
        "nonzero(g_0)",
        "false_maps_are_not_proved",
    ),
    "HC2 without inclusion": (
        "conditions",
        "nonzero(steep) and inside(p2, radii[2])",
        "nonzero(steep)",
        "false_maps_are_not_proved",
    ),
    "h_b'' not checked": ("conditions", "nonzero(bend)", "True", "false_maps_are_not_proved"),
    "h_b' not checked": ("conditions", "nonzero(slope)", "True", "false_maps_are_not_proved"),
    "middle iterates not checked": ("conditions", "nonzero(whole)", "True", "middle_iterates_have_to_be_regular"),
    "NaN accepted": (
        "conditions",
        "all(value.is_finite() for value in enclosures.values())",
        "True",
        "nothing_follows_from_nan",
    ),
    "no enclosure accepted": ("conditions", "and enclosures and all(", "and all(", "nothing_follows_from_nan"),
    "every sum has a parity": (
        "statement",
        "sides[0] if sides[0] == sides[1] else None",
        "sides[0]",
        "asymmetric_fields_are_refused",
    ),
}


@pytest.fixture
def workshop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    yield tmp_path
    for name in [name for name in sys.modules if name.split(".")[0] == "faulty_copy"]:
        del sys.modules[name]


@pytest.mark.parametrize("fault", FAULTS)
def test_fault_is_caught(fault: str, workshop: Path) -> None:
    name, right, wrong, check = FAULTS[fault]
    copy = workshop / "faulty_copy"
    shutil.copytree(SOURCE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    text = (copy / f"{name}.py").read_text(encoding="utf-8")
    assert text.count(right) == 1, f"the line to be changed occurs {text.count(right)} times"
    (copy / f"{name}.py").write_text(text.replace(right, wrong), encoding="utf-8")
    package = importlib.import_module("faulty_copy")
    failures = (
        AssertionError,
        ArithmeticError,
        IndexError,
        ValueError,
        package.jets.CannotFollow,
        pytest.fail.Exception,
    )
    with pytest.raises(failures):
        CHECKS[check](package)


def test_checks_pass_on_a_true_copy(workshop: Path) -> None:
    shutil.copytree(SOURCE, workshop / "faulty_copy", ignore=shutil.ignore_patterns("__pycache__"))
    package = importlib.import_module("faulty_copy")
    for check in {entry[3] for entry in FAULTS.values()}:
        CHECKS[check](package)
