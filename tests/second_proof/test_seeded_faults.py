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
        "o.contains(x + reach * f) for",
        "True for",
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
        "max(b, z.abs_upper())",
        "max(b, abs(z.mid()).upper() / 2)",
        "discs_end_before_the_solution_does",
    ),
    "one sector only": ("flow", "range(SECTORS)", "range(SECTORS - 1, SECTORS)", "discs_end_before_the_solution_does"),
    "fundamental matrix not refined": (
        "flow",
        "matrix.append([x + d for x, d",
        "matrix.append([x for x, d",
        "flow_encloses_exact_solutions",
    ),
    "inverse of the fundamental matrix not refined": (
        "flow",
        "inverse.append([x + d for x, d",
        "inverse.append([x for x, d",
        "flow_encloses_exact_solutions",
    ),
    "defect of the wrong sign": (
        "flow",
        "_cut(f[()] - x.derivative(),",
        "_cut(x.derivative() - f[()],",
        "flow_encloses_exact_solutions",
    ),
    "forces forgotten": ("flow", "if order > 1 else", "if order > 3 else", "flow_encloses_exact_solutions"),
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
        "guess - height(guess) / step.section_slope(moment)",
        "guess",
        "free_fall_crossing",
    ),
    "time derivative dropped at the crossing": (
        "crossing",
        "for _ in range(degree):",
        "for _ in range(degree - 1):",
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
        "targets = [jet * sign",
        "targets = [jet * 1",
        "iterates_of_a_reversible_map_are_enclosed",
    ),
    "preimage not reflected": (
        "proof",
        "* self.signs[j] for",
        "for",
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
    "squares lose their cross terms": (
        "jets",
        "term = term + term if square and a != b else term",
        "term = term",
        "flow_encloses_exact_solutions",
    ),
    "implicit function one order short": (
        "jets",
        "for _ in range(degree):",
        "for _ in range(degree - 1):",
        "implicit_functions_have_their_jet",
    ),
    "root of any enclosure": ("jets", "if half and not", "if False and not", "roots_need_a_positive_enclosure"),
    "division by any enclosure": ("jets", "if first.contains(0):", "if False:", "roots_need_a_positive_enclosure"),
    "derivative without its factor": (
        "conditions",
        "x * (a.count(j) + 1) *",
        "x *",
        "tables_enclose_derivatives",
    ),
    "mean value form at the centre only": (
        "conditions",
        "sum(changes, self.centre[a])",
        "self.centre[a]",
        "tables_enclose_derivatives",
    ),
    "factor 3 of the second derivative": (
        "conditions",
        "(3 * (g[0, 1] + g[0, 0] * slope))",
        "(g[0, 1] + g[0, 0] * slope)",
        "normal_forms_have_their_side",
    ),
    "side exchanged": ("conditions", '"above" if bend > 0', '"above" if bend < 0', "normal_forms_have_their_side"),
    "factorials forgotten": (
        "conditions",
        "prod(factorial(a.count(j)) for j in (0, 1)) * c",
        "c",
        "normal_forms_have_their_side",
    ),
    "reduction forgotten": (
        "conditions",
        "implicit([last[1].jet(reach)], [2])",
        "{}",
        "reduction_removes_p2",
    ),
    "HC3 without inclusion": (
        "conditions",
        "not g_0.contains(0) and abs(p0) < radii[0]",
        "not g_0.contains(0)",
        "false_maps_are_not_proved",
    ),
    "HC2 without inclusion": (
        "conditions",
        "not steep.contains(0) and abs(p2) < radii[2]",
        "not steep.contains(0)",
        "false_maps_are_not_proved",
    ),
    "family without inclusion": ("conditions", "is_inside, **{", "True, **{", "false_maps_are_not_proved"),
    "h_b'' not checked": ("conditions", "not bend.contains(0)", "True", "false_maps_are_not_proved"),
    "h_b' not checked": ("conditions", "not rise.contains(0)", "True", "false_maps_are_not_proved"),
    "middle iterates not checked": (
        "conditions",
        "not value.contains(0), determinant",
        "True, determinant",
        "middle_iterates_have_to_be_regular",
    ),
    "NaN accepted": (
        "conditions",
        "all(c.is_finite() for c in self.enclosures.values())",
        "True",
        "nothing_follows_from_nan",
    ),
    "no enclosure accepted": ("conditions", "and bool(self.enclosures) and", "and", "nothing_follows_from_nan"),
    "every sum has a parity": (
        "statement",
        '"+": lambda a, b: a if a == b else 0',
        '"+": lambda a, b: a',
        "asymmetric_fields_are_refused",
    ),
    "every square is even": (
        "statement",
        "a * a if e.numerator",
        "1 if e.numerator",
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
