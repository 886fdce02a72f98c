"""No test depends on how fast the machine is: properties have no deadline."""

from __future__ import annotations

import multiprocessing

import pytest
from hypothesis import settings

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
    ]
)
_start_method = processes._start_method
processes._start_method = lambda: "forkserver"


@pytest.fixture
def fresh_workers(monkeypatch: pytest.MonkeyPatch) -> None:
    """Workers of this process start as those of users' processes with threads."""
    monkeypatch.setattr(processes, "_start_method", _start_method)


@pytest.fixture
def little_grace(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tasks that have come to their limit of time are ended soon."""
    monkeypatch.setattr(processes, "GRACE_SECONDS", 0.25)
