"""A process that runs tests on a copy of the package, those that take little before others."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

_QUICK = 0.25


class QuickFirst:
    """A plugin of pytest that chooses tests, slow ones or others, in the order of the seconds that they took before.

    Attributes:
        slow: whether slow tests run in place of the others.
        first: beginnings of the names of those that run before all others; single tests that are slow run last.
        seconds: what they take now.
        failed: those that fail, in order; files that cannot be collected among them.
        by_slow: whether a slow one of them fails.
    """

    def __init__(self, slow: bool, before: Mapping[str, float], first: Sequence[str]) -> None:
        self.slow, self.before, self.first = slow, before, tuple(first)
        self.seconds: dict[str, float] = {}
        self.failed: list[str] = []
        self.by_slow = False

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Quick tests keep their order, so that what they share is made once."""
        order, single = {}, tuple(name for name in self.first if "::" in name)
        for item in items:
            # Those of the list of long tests (`tests/heavy.txt`) are no slow ones.
            mark = item.get_closest_marker("slow")
            name, of_others = item.nodeid, (mark is None or bool(mark.args)) == self.slow
            if not of_others or name.startswith(single):
                order[item] = of_others, not name.startswith(self.first), max(_QUICK, self.before.get(name, 0.0))
        items[:] = sorted(order, key=order.__getitem__)

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            self.failed.append(report.nodeid)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.seconds[report.nodeid] = round(self.seconds.get(report.nodeid, 0.0) + report.duration, 2)
        if report.failed:
            self.failed.append(report.nodeid)
            self.by_slow |= "slow" in report.keywords


def run_tests(
    folder: Path, arguments: Sequence[str], slow: bool, before: Mapping[str, float], first: Sequence[str]
) -> None:
    """Run pytest in a folder whose ``src`` holds the package; leaves ``told.json`` and ``output.txt`` there."""
    # A session of its own, which ends with all processes that a fault may leave waiting.
    os.setsid()
    os.chdir(folder)
    output = os.open("output.txt", os.O_WRONLY | os.O_CREAT)
    for stream in (1, 2):
        os.dup2(output, stream)
    package = str(folder / "src")
    sys.path.insert(0, package)
    sys.dont_write_bytecode = True
    os.environ |= {"PYTHONPATH": package, "PYTHONDONTWRITEBYTECODE": "1", "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}
    plugin = QuickFirst(slow, before, first)
    code = int(pytest.main([*arguments, "-p", "_hypothesis_pytestplugin"], plugins=[plugin]))
    told = {"code": code, "failed": plugin.failed, "slow": plugin.by_slow, "seconds": plugin.seconds}
    Path("told.json").write_text(json.dumps(told), encoding="utf-8")
    sys.stdout.flush()
    os._exit(0)
