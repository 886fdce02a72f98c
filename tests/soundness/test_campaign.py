"""The campaign of false claims and forged certificates, for two minutes."""

from __future__ import annotations

import contextlib
import subprocess
import sys
from collections import Counter
from pathlib import Path

import campaign
import pytest
from support.forgeries import forged
from test_forged_certificates import says_how_it_was_made

from orbitproof.shared.formats import InputError

KINDS = ("fold", "crossings", "orbit")


@pytest.mark.parametrize(
    ("kind", "each"),
    [("fold", 1), *(pytest.param(kind, 1000, marks=pytest.mark.slow) for kind in KINDS)],
)
def test_every_changed_field_of_other_claims_is_found_but_for_names(
    kind: str, each: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At most `each` places of a field are changed in each way."""
    monkeypatch.setattr(campaign.rechecking, "enclose", campaign.rechecking.enclose)
    document, check, every = campaign.material(kind)
    assert check(document).stands
    campaign._integrated_once(kind)
    missed = set()
    tried: Counter[tuple[str, str]] = Counter()
    for change in every:
        tried[change.field, change.how] += 1
        if tried[change.field, change.how] > each:
            continue
        with contextlib.suppress(InputError):
            result = check(forged(document, change.apply))
            found = not result.stands or result.rendered is not None
            if not found and not says_how_it_was_made(change.field):
                missed.add(change.field)
    assert missed <= {"statement.candidate.system"}


@pytest.mark.slow
def test_nothing_false_is_proved_and_no_forgery_stands(tmp_path: Path) -> None:
    script = Path(__file__).with_name("campaign.py")
    command = [sys.executable, str(script), "--output", str(tmp_path / "campaign.json"), "--seconds", "100"]
    found = subprocess.run(command, capture_output=True, text=True, check=False)
    assert found.returncode == 0, found.stdout + found.stderr
    assert "wrong: 0" in found.stdout
