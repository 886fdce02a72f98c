"""Which tests take so long that `make test` leaves them to `make test-slow`: ``python tests/heavy.py COSTS``.

COSTS is what ``pytest --costs COSTS`` has written. A test takes what it takes itself and what the fixtures take that
it shares with others. The longest go into `heavy.txt`, one a line, until the others take no more than the processor
seconds that are left to them. The marker `quick` keeps a test in `make test`.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

HEAVY = Path(__file__).parent / "heavy.txt"


def read(lines: Iterable[str]) -> tuple[dict[str, float], dict[str, float], dict[str, list[str]]]:
    """Seconds of tests, seconds of shared fixtures, and which fixtures a test shares. The last of two lines counts."""
    tests, fixtures, shared = dict[str, float](), dict[str, float](), dict[str, list[str]]()
    for line in lines:
        entry = json.loads(line)
        if "test" in entry:
            tests[entry["test"]], shared[entry["test"]] = entry["seconds"], entry["fixtures"]
        else:
            fixtures[entry["fixture"]] = max(entry["seconds"], fixtures.get(entry["fixture"], 0.0))
    return tests, fixtures, shared


def longest(
    tests: Mapping[str, float], fixtures: Mapping[str, float], shared: Mapping[str, Sequence[str]], left: float
) -> list[str]:
    """The tests without which the others take at most `left` seconds, those that take longest."""
    whole = {test: own + sum(fixtures.get(name, 0.0) for name in shared[test]) for test, own in tests.items()}
    found: list[str] = []
    users = {name: sum(name in names for names in shared.values()) for name in fixtures}
    total = sum(tests.values()) + sum(seconds for name, seconds in fixtures.items() if users[name])
    for test in sorted(whole, key=lambda test: -whole[test]):
        if total <= left:
            break
        found.append(test)
        total -= tests[test]
        for name in shared[test]:
            if name in users:
                users[name] -= 1
                total -= 0.0 if users[name] else fixtures[name]
    return sorted(found)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("costs", type=Path)
    words = "processor seconds of the others (default: %(default)g)"
    parser.add_argument("--left", type=float, default=450.0, help=words)
    parser.add_argument("--output", type=Path, default=HEAVY)
    options = parser.parse_args(arguments)
    tests, fixtures, shared = read(options.costs.read_text("utf-8").splitlines())
    found = longest(tests, fixtures, shared, options.left)
    options.output.write_text("".join(f"{test}\n" for test in found), encoding="utf-8")
    taken = sum(tests.values()) + sum(fixtures.values())
    print(f"{len(tests)} tests take {taken:.0f} s; {len(found)} of them are left to make test-slow")
    return 0


if __name__ == "__main__":
    sys.exit(main())
