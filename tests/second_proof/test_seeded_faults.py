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
    "times of a stage at its beginning only": (
        "flow",
        "reach = arb(size / 2, size / 2)",
        "reach = arb(0)",
        "discs_end_before_the_solution_does",
    ),
    "bound at the centre only": (
        "flow",
        "max(b, z.abs_upper().upper())",
        "max(b, abs(z.mid()).upper() / 2)",
        "discs_end_before_the_solution_does",
    ),
    "one sector only": ("flow", "range(SECTORS)", "range(SECTORS - 1, SECTORS)", "discs_end_before_the_solution_does"),
    "wrong factor in the integral of a series": (
        "flow",
        "row[place - 1] / place",
        "row[place - 1] / (place + 1)",
        "flow_encloses_exact_solutions",
    ),
    "product of halves one term short": (
        "flow",
        "range(middle - 1 - low, ",
        "range(middle - low, ",
        "flow_encloses_exact_solutions",
    ),
    "forces forgotten": ("flow", "if order > 1:", "if order > 3:", "flow_encloses_exact_solutions"),
    "start counted as a crossing": (
        "crossing",
        "if sign not in (0, after):",
        "if sign != after:",
        "first_crossing_of_an_oscillator",
    ),
    "crossings from above not seen": (
        "crossing",
        "if sign not in (0, after):",
        "if sign == -1 and after == 1:",
        "every_crossing_in_a_step_is_seen",
    ),
    "last crossing first": (
        "crossing",
        "(middle, b, depth + 1), (a, middle, depth + 1)",
        "(a, middle, depth + 1), (middle, b, depth + 1)",
        "every_crossing_in_a_step_is_seen",
    ),
    "crossing time not widened": (
        "crossing",
        "moment = guess - value / step.section_slope(moment.union(guess))",
        "moment = guess",
        "free_fall_crossing",
    ),
    "time derivative dropped at the crossing": (
        "crossing",
        "for _ in range(degree):\n        field",
        "for _ in range(degree - 1):\n        field",
        "free_fall_crossing",
    ),
    "first integral not checked": (
        "proof",
        "if not all(before",
        "if False and not all(before",
        "wrong_first_integral_is_noticed",
    ),
    "backward is forward": (
        "proof",
        "targets = [scale(sign, jet)",
        "targets = [scale(1, jet)",
        "iterates_of_a_reversible_map_are_enclosed",
    ),
    "preimage not reflected": (
        "proof",
        "[scale(sign, add({zero: x}, w))",
        "[scale(1, add({zero: x}, w))",
        "iterates_of_a_reversible_map_are_enclosed",
    ),
    "iterates anywhere": (
        "proof",
        "if not all(abs(x - m) < self.size",
        "if not all(abs(x - m) < 1",
        "iterates_of_a_reversible_map_are_enclosed",
    ),
    "binomial without its denominator": (
        "jets",
        "(exponent - j) / (j + 1)",
        "(exponent - j)",
        "flow_encloses_exact_solutions",
    ),
    "squares lose their cross terms": ("jets", "term = term + term", "term = term", "flow_encloses_exact_solutions"),
    "implicit function one order short": (
        "jets",
        "for _ in range(degree):\n        values",
        "for _ in range(degree - 1):\n        values",
        "implicit_functions_have_their_jet",
    ),
    "root of any enclosure": ("jets", "if not first > 0:", "if first < 0:", "roots_need_a_positive_enclosure"),
    "division by any enclosure": ("jets", "if first.contains(0):", "if False:", "roots_need_a_positive_enclosure"),
    "derivative without its factor": (
        "conditions",
        "change * (a[j] + 1) *",
        "change *",
        "tables_enclose_derivatives",
    ),
    "mean value form at the centre only": (
        "conditions",
        "if not change.is_zero():",
        "if False:",
        "tables_enclose_derivatives",
    ),
    "factor 3 of the second derivative": (
        "conditions",
        "(3 * (g_01 + g[2, 0] * slope))",
        "(g_01 + g[2, 0] * slope)",
        "normal_forms_have_their_side",
    ),
    "side exchanged": ("conditions", '"above" if bend > 0', '"above" if bend < 0', "normal_forms_have_their_side"),
    "factorials forgotten": ("conditions", "factorial(a[0]) * factorial(a[1])", "1", "normal_forms_have_their_side"),
    "reduction forgotten": (
        "conditions",
        "implicit([last[1].jet(reach)], 2, 3)",
        "[{}]",
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
    "h_b' not checked": ("conditions", "nonzero(rise)", "True", "false_maps_are_not_proved"),
    "middle iterates not checked": ("conditions", "nonzero(value)", "True", "middle_iterates_have_to_be_regular"),
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
