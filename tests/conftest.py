"""No test depends on how fast the machine is: properties have no deadline."""

from __future__ import annotations

import functools
import gc
import multiprocessing
import signal
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, chdir, nullcontext
from functools import cache
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings
from support import quick

from orbitproof.shared import processes

settings.register_profile("orbitproof", deadline=None)
settings.load_profile("orbitproof")

# pytest-xdist runs threads, so that each worker would be a fresh process, which takes longer to start than most proofs
# here. They are copies of one that has a single thread and has imported what they need. Commands in processes of their
# own, and tests that ask for `fresh_workers`, start theirs as users' do.
multiprocessing.set_forkserver_preload(
    [
        "jsonschema",
        "orbitproof.verify.run.rows",
        "orbitproof.verify.run.branch_checks",
        "orbitproof.verify.run.branches",
        "tests.support.prepared",
    ]
)
_start_method = processes._start_method


def _as_copies() -> str:
    with chdir(Path(__file__).parents[1]):
        forkserver.ensure_running()
    return "forkserver"


processes._start_method = _as_copies


# What is imported and collected stays to the end: it is not looked through for what can be freed.
gc.disable()


def pytest_addoption(parser: pytest.Parser) -> None:
    """``--costs FILE``: what each test takes, those that take long too."""
    parser.addoption(
        "--costs", metavar="FILE", help="append to this file what each test takes (tests/heavy.py reads it)"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Costs are written by the process that runs the test; signals reach that which hands tests out."""
    if config.getoption("costs"):
        costs = quick.Costs(Path(config.getoption("costs")))
        config.pluginmanager.register(costs)
        functools.cache = costs.cache
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        for each in (signal.SIGINT, signal.SIGTERM):
            signal.signal(each, _interrupted)


def _interrupted(*_: object) -> None:
    """Ended from outside (`make test`): once is enough, and those that run the tests are ended too."""
    for each in (signal.SIGINT, signal.SIGTERM):
        signal.signal(each, signal.SIG_IGN)
    raise KeyboardInterrupt


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What `make test` leaves out is slow, unless it is asked for by its name."""
    if not all("::" in word for word in config.args):
        quick.choose(items, bool(config.getoption("costs")))


def pytest_collection_finish() -> None:
    """From here on some is freed, seldom."""
    gc.freeze()
    gc.set_threshold(200_000)
    gc.enable()


@pytest.fixture(scope="session", autouse=True)
def typeset_once() -> Iterator[None]:
    """Formulas are set, and fonts made smaller for a document, as matplotlib does it, but once.

    A font is made smaller again if a document has characters that none before had.
    """
    if "matplotlib" not in sys.modules:
        yield
        return
    from matplotlib.backends import _backend_pdf_ps
    from matplotlib.mathtext import MathTextParser

    make = _backend_pdf_ps.get_glyphs_subset
    made: dict[str, tuple[set[Any], Any]] = {}

    parse = MathTextParser._parse_cached.__wrapped__
    parsers = {"vector": MathTextParser("path"), "raster": MathTextParser("agg")}

    @cache
    def parsed(kind: str, *text: Any) -> Any:
        """Each picture has parsers of its own, with the same results."""
        return parse(parsers[kind], *text)

    def subset(font: Any, characters: Any) -> AbstractContextManager[Any]:
        known, found = made.get(str(font), (set(), None))
        if not known.issuperset(characters):
            known = known.union(characters)
            found = opened.enter_context(make(font, known))
            made[str(font)] = known, found
        return nullcontext(found)

    with ExitStack() as opened, pytest.MonkeyPatch.context() as patch:
        patch.setattr(_backend_pdf_ps, "get_glyphs_subset", subset)
        patch.setattr(MathTextParser, "_parse_cached", lambda parser, *text: parsed(parser._output_type, *text))
        yield


@pytest.fixture
def fresh_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers of this process start as those of users' processes with threads."""
    monkeypatch.setattr(processes, "_start_method", _start_method)


@pytest.fixture
def little_grace(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tasks that have come to their limit of time are ended soon."""
    monkeypatch.setattr(processes, "GRACE_SECONDS", 0.25)


@pytest.fixture(scope="session")
def point() -> Any:
    """A certificate of the Falkner-Skan touch-and-go bifurcation."""
    from support.claims import known

    from orbitproof.verify.certificate import Limits, certify

    return certify(known("fs3"), Limits(max_precision=256))
