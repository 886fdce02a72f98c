"""Which tests take so long that `make test` leaves them to `make test-slow`: ``python tests/heavy.py COSTS``.

COSTS is what ``pytest --costs COSTS`` has written. A test takes what it takes itself, and its part of what it shares
with others. The longest go into `heavy.txt`, one a line, until the others take no more than the processor
seconds that are left to them. The marker `quick` keeps a test in `make test`.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence, Set
from pathlib import Path

HEAVY = Path(__file__).parent / "heavy.txt"


def read(lines: Iterable[str]) -> tuple[dict[str, float], dict[str, float], dict[str, list[str]], set[str]]:
    """Seconds of tests, seconds of what they share, what each shares, and which stay; the last of two lines counts."""
    tests, fixtures, shared = dict[str, float](), dict[str, float](), dict[str, list[str]]()
    stay: set[str] = set()
    for line in lines:
        entry = json.loads(line)
        if "test" in entry:
            tests[entry["test"]], shared[entry["test"]] = entry["seconds"], entry["fixtures"]
            stay |= {entry["test"]} if entry.get("quick") else set()
        else:
            fixtures[entry["fixture"]] = max(entry["seconds"], fixtures.get(entry["fixture"], 0.0))
    return tests, fixtures, shared, stay


def longest(
    tests: Mapping[str, float],
    fixtures: Mapping[str, float],
    shared: Mapping[str, Sequence[str]],
    stay: Set[str],
    left: float,
) -> list[str]:
    """The tests without which the others take at most `left` seconds, those that take longest."""
    found: list[str] = []
    users = Counter(name for names in shared.values() for name in names if name in fixtures)
    parts = {name: fixtures[name] / users[name] for name in users}
    whole = {test: own + sum(parts.get(name, 0.0) for name in shared[test]) for test, own in tests.items()}
    total = sum(tests.values()) + sum(fixtures[name] for name in users)
    for test in sorted(whole.keys() - stay, key=lambda test: (-whole[test], test)):
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
    tests, fixtures, shared, stay = read(options.costs.read_text("utf-8").splitlines())
    found = longest(tests, fixtures, shared, stay, options.left)
    options.output.write_text("".join(f"{test}\n" for test in found), encoding="utf-8")
    taken = sum(tests.values()) + sum(fixtures.values())
    print(f"{len(tests)} tests take {taken:.0f} s; {len(found)} of them are left to make test-slow")
    return 0


if __name__ == "__main__":
    sys.exit(main())
