"""A command loads what it needs, and copies itself for its workers only where nothing else runs in it."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest


def printed(program: str, **environment: str) -> str:
    result = subprocess.run(
        [sys.executable, "-c", program], env={**os.environ, **environment}, capture_output=True, text=True, check=True
    )
    return result.stdout.strip()


START = "from orbitproof.shared.processes import _start_method\n"


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="threads are counted on Linux")
def test_a_process_is_copied_only_if_nothing_else_runs_in_it() -> None:
    for modules in ("orbitproof.verify.__main__", "orbitproof.explore.search.run, orbitproof.explore.families.tracing"):
        alone = f"import {modules}\n{START}print(_start_method())"
        assert printed(alone, OPENBLAS_NUM_THREADS="1") == "fork"
    threaded = f"import threading\n{START}threading.Thread(target=threading.Event().wait, daemon=True).start()\n"
    assert printed(f"{threaded}print(_start_method())") == "spawn"


@pytest.mark.slow
def test_a_search_of_named_families_and_a_catalogue_leave_scipy_out() -> None:
    rooms = ("search.run", "families.tracing", "three_body.families.named", "three_body.catalogues.making")
    modules = ", ".join(f"orbitproof.explore.{room}" for room in rooms)
    loaded = "*(name in sys.modules for name in ('jax', 'scipy.integrate', 'scipy.optimize'))"
    assert printed(f"import sys, {modules}\nprint({loaded})") == "True False False"


@pytest.mark.parametrize(
    ("arguments", "left_out"),
    [
        (["--version"], {"numpy", "flint", "jax", "matplotlib", "rich", "jsonschema", "jsonschema_rs"}),
        (["verify", "--help"], {"jax", "matplotlib", "mpmath", "rich", "jsonschema", "jsonschema_rs"}),
        (["report", "--help"], {"jax", "matplotlib", "jinja2", "rich", "jsonschema", "jsonschema_rs"}),
    ],
)
def test_a_command_loads_no_more_than_it_needs(arguments: list[str], left_out: set[str]) -> None:
    program = (
        "import sys\nfrom orbitproof.__main__ import main\n"
        f"sys.argv[1:] = {arguments!r}\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "print('\\n', *sorted(sys.modules))"
    )
    loaded = set(printed(program).rpartition("\n")[2].split())
    assert "orbitproof.__main__" in loaded
    assert not loaded & left_out
