"""A plugin of pytest: quick tests before slow ones, by the times of an earlier run; tells times, and what failed."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

FILE = Path(os.environ["ORBITPROOF_TIMES"])
"""What was measured before: seconds by test. At the end it is ``{"seconds": {..}, "failed": [..]}``."""

_QUICK = 0.25
_before: dict[str, float] = json.loads(FILE.read_text(encoding="utf-8"))
_seconds: dict[str, float] = {}
_failed: list[str] = []


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Quick tests keep their order, so that what they share is made once."""
    items.sort(key=lambda item: max(_QUICK, _before.get(item.nodeid, 0.0)))


def pytest_collectreport(report: pytest.CollectReport) -> None:
    if report.failed:
        _failed.append(report.nodeid)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    _seconds[report.nodeid] = round(_seconds.get(report.nodeid, 0.0) + report.duration, 2)
    if report.failed:
        _failed.append(report.nodeid)


@pytest.hookimpl(wrapper=True)
def pytest_sessionfinish() -> Iterator[None]:
    yield
    FILE.write_text(json.dumps({"seconds": _seconds, "failed": _failed}), encoding="utf-8")
