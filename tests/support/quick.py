"""Which tests `make test` runs, and what each of them takes.

Nothing is left out for good: what `make test` does not run, `make test-slow` does. It leaves out

- all but the first seeds of tests that try random systems by seed, and cases of a test none of whose values is new;
- tests that take long: the list `heavy.txt` is made from times that were measured (`tests/heavy.py`).

The marker `quick` keeps a test in `make test`, with all of its cases. A test that is named on the command line, as
`tests/verify/test_series.py::test_squares_enclose`, runs with all of its cases too.
"""

from __future__ import annotations

import functools
import json
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache, wraps
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

import pytest

HEAVY = Path(__file__).parents[1] / "heavy.txt"
_cache = functools.cache
_LITTLE = 0.02
"""What takes no longer counts for the test that has made it, in seconds."""
SEEDS = 3
"""So many random systems of each test are tried by `make test`."""


@cache
def heavy() -> frozenset[str]:
    """The names of tests that take long."""
    return frozenset(HEAVY.read_text("utf-8").splitlines()) if HEAVY.exists() else frozenset()


def choose(items: Sequence[pytest.Item], with_heavy: bool = False) -> None:
    """Mark as slow what `make test` leaves out; in the order of the tests, so that each process chooses alike."""
    seen: set[tuple[str, tuple[str, ...], int]] = set()
    order: dict[tuple[str, tuple[str, ...]], dict[tuple[int, ...], int]] = {}
    for item in items:
        if "slow" in item.keywords or "quick" in item.keywords:
            continue
        test = item.nodeid.partition("[")[0]
        if not with_heavy and not heavy().isdisjoint((test, item.nodeid)):
            item.add_marker(pytest.mark.slow("long"))
        elif (spec := getattr(item, "callspec", None)) is not None:
            values = set()
            for names in _together(item, spec.params):
                numbers = order.setdefault((test, names), {})
                number = numbers.setdefault(tuple(id(spec.params[name]) for name in names), len(numbers))
                if names != ("seed",) or number < SEEDS:
                    values.add((test, names, number))
            if values <= seen:
                item.add_marker(pytest.mark.slow)
            seen |= values


def _together(item: pytest.Item, params: Mapping[str, Any]) -> Iterator[tuple[str, ...]]:
    """Names of parameters whose values stand in one table, and each that is alone; pytest numbers all cases."""
    left = set(params)
    for mark in item.iter_markers("parametrize"):
        given = mark.args[0].split(",") if isinstance(mark.args[0], str) else mark.args[0]
        names = tuple(name.strip() for name in given)
        if left.issuperset(names):
            left -= {*names}
            yield names
    yield from ((name,) for name in sorted(left))


class Costs:
    """A plugin of pytest that appends to a file what each test takes: a line of JSON, in processor seconds.

    Each line holds ``test``, the ``seconds`` of its own, and the names of what it shares with other tests, fixtures
    and what functions with a cache have made; or ``fixture``, the name of one of these, with its ``seconds``. Processes
    that a test has started count once they have ended.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.apart = 0.0
        self.long: set[str] = set()
        self.used: set[str] = set()

    def add(self, **line: Any) -> None:
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")

    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.apart, self.used, begin = 0.0, set(_shared(item)), spent()
        result = yield
        own = spent() - begin - self.apart
        quick = "quick" in item.keywords
        self.add(test=item.nodeid, seconds=round(own, 3), fixtures=sorted(self.used), quick=quick)
        return result

    @pytest.hookimpl(wrapper=True)
    def pytest_fixture_setup(self, fixturedef: Any, request: Any) -> Iterator[None]:
        if fixturedef.scope == "function":
            return (yield)
        with self.made(_name(fixturedef, request.param_index)):
            return (yield)

    @contextmanager
    def made(self, name: str) -> Iterator[None]:
        """Around what is made once; what is made on the way is apart."""
        before, begin = self.apart, spent()
        yield
        inside, whole = self.apart - before, spent() - begin
        if whole - inside > _LITTLE:
            self.apart = before + whole
            self.long.add(name)
            self.add(fixture=name, seconds=round(whole - inside, 3))

    def cache(self, function: Callable[..., Any]) -> Any:
        """`functools.cache`, which for functions of the tests notes what they have made, and for whom."""
        if HEAVY.parent not in Path(function.__code__.co_filename).parents:
            return _cache(function)
        work = f"{function.__module__}.{function.__qualname__}"

        def made(*arguments: Any, **named: Any) -> Any:
            with self.made(f"{work} {hash((arguments, *sorted(named.items())))}"):
                return function(*arguments, **named)

        kept = _cache(made)

        @wraps(function)
        def asked(*arguments: Any, **named: Any) -> Any:
            result = kept(*arguments, **named)
            name = f"{work} {hash((arguments, *sorted(named.items())))}"
            if name in self.long:
                self.used.add(name)
            return result

        vars(asked).update(cache_clear=kept.cache_clear, cache_info=kept.cache_info)
        return asked


def _shared(item: pytest.Item) -> Iterator[str]:
    """Its fixtures that other tests share."""
    numbers = getattr(getattr(item, "callspec", None), "indices", {})
    for name, found in getattr(item, "_fixtureinfo").name2fixturedefs.items():  # noqa: B009
        yield from (_name(each, numbers.get(name, 0)) for each in found if each.scope != "function")


def _name(definition: Any, number: int) -> str:
    return f"{definition.baseid}::{definition.argname}[{number}]"


def spent() -> float:
    """Processor seconds of this process, of those that it has ended, and of those of its server of processes."""
    times = os.times()
    server = getattr(forkserver, "_forkserver")._forkserver_pid  # noqa: B009
    ticks = 0
    if server and (file := Path(f"/proc/{server}/stat")).exists():
        ticks = sum(map(int, file.read_text("utf-8").rpartition(")")[2].split()[11:15]))
    return time.process_time() + times.children_user + times.children_system + ticks / os.sysconf("SC_CLK_TCK")
