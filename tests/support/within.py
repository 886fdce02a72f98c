"""Fixtures in which all tests of a module run."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from typing import Any, Literal

import pytest


def within(
    context: Callable[[], AbstractContextManager[Any]], scope: Literal["function", "module"] = "function"
) -> Any:
    """All tests of the module that holds the result run within what `context` makes: for each, or for all, one."""

    @pytest.fixture(autouse=True, scope=scope)
    def inside() -> Iterator[None]:
        with context():
            yield

    return inside
