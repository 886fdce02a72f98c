"""``orbitproof doctor``: what is installed, what is missing, and whether a small proof goes through."""

from __future__ import annotations

import argparse
import platform
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from fractions import Fraction
from importlib import metadata
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from orbitproof.shared import Candidate

from orbitproof.shared.answers import add_json_option, answered, tell
from orbitproof.shared.help_text import HelpFormatter

_IMPORTS = {
    "explore": "jax.numpy, diffrax, mpmath, scipy.integrate",
    "figures": "matplotlib.pyplot, jinja2, latex2mathml.converter",
    "oem": "ccsds_ndm",
    "spk": "spiceypy",
    "parquet": "pyarrow",
    "interactive": "plotly",
    "cluster": "distributed",
    "completion": "argcomplete",
}
"""What is imported to see whether an extra works, by its name. `docs` and `dev` are for work on the project itself."""
_REQUIREMENT = re.compile(r"([\w.-]+)([^;\s]*)\s*(?:;\s*extra == [\"'](\w+)[\"'])?")
_SECONDS = 120


@dataclass(frozen=True)
class Finding:
    """One line of the report: a topic, what was found, and whether something that is installed does not work."""

    topic: str
    words: str
    is_fault: bool = False


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code: 1 if something that is installed does not work."""
    parser = argparse.ArgumentParser(
        prog="orbitproof doctor",
        description="What is installed, which extras are missing, and whether a small proof goes through.",
        epilog="examples:\n  orbitproof doctor\n\nExit codes: 0 all is well, 1 what is installed does not all work.",
        formatter_class=HelpFormatter,
    )
    add_json_option(parser)
    options = parser.parse_args(arguments)
    return answered(parser.prog, options.json, _report)


def _report() -> int:
    is_well = True
    for finding in findings():
        is_well = is_well and not finding.is_fault
        tell(f"{finding.topic:13}{finding.words}", [asdict(finding)])
    tell("all is well" if is_well else "not all is well: see the lines with FAULT")
    return 0 if is_well else 1


def findings() -> Iterator[Finding]:
    """All that is looked at, in order."""
    yield Finding("orbitproof", f"{metadata.version('orbitproof')}, Python {platform.python_version()}, "
                                f"{platform.system()} {platform.machine()}")  # fmt: skip
    needs = requirements(metadata.requires("orbitproof") or ())
    base = found_base(needs[""])
    yield base
    for extra in _IMPORTS:
        yield found_extra(extra, needs[extra])
    if not base.is_fault:
        yield from found_proofs()


def requirements(lines: Sequence[str]) -> dict[str, dict[str, str]]:
    """Package and versions wanted, such as ``>=1,<2``, by extra; those of the base stand under the empty name."""
    needs: dict[str, dict[str, str]] = {"": {}}
    for line in lines:
        if found := _REQUIREMENT.fullmatch(line.strip()):
            package, versions, extra = found.groups()
            needs.setdefault(extra or "", {})[package] = versions
    return needs


def installed(package: str) -> str | None:
    """The version of a distribution; `None` if it is not there."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return None


def fits(version: str, wanted: str) -> bool:
    """Whether a version lies within bounds such as ``>=1.2,<2``; by its leading numbers.

    >>> fits("0.10.1", ">=0.9,<0.10"), fits("0.9.0", ">=0.9,<0.10")
    (False, True)
    """

    def numbers(text: str) -> list[int]:
        return [int(part) for part in re.findall(r"\d+", text.partition("+")[0])]

    for bound in filter(None, wanted.split(",")):
        sign, limit = bound.rstrip("0123456789."), numbers(bound)
        if (sign == ">=" and numbers(version) < limit) or (sign == "<" and numbers(version) >= limit):
            return False
    return True


def _told(needs: Mapping[str, str]) -> tuple[str, list[str], list[str]]:
    """Packages with their versions, in words; those that are missing; those of a version that does not fit."""
    there = {package: version for package in needs if (version := installed(package)) is not None}
    unfit = [f"{package} {version}, wanted {needs[package]}" for package, version in there.items()
             if not fits(version, needs[package])]  # fmt: skip
    words = ", ".join(f"{package} {version}" for package, version in there.items())
    return words, [package for package in needs if package not in there], unfit


def found_base(needs: Mapping[str, str]) -> Finding:
    """What every proof needs."""
    words, missing, unfit = _told(needs)
    if missing or unfit:
        return Finding("base", f"FAULT: {'; '.join([*(f'{name} is missing' for name in missing), *unfit])}", True)
    return Finding("base", words)


def found_extra(extra: str, needs: Mapping[str, str]) -> Finding:
    """Whether an extra is there, and can be imported."""
    words, missing, unfit = _told(needs)
    if missing:
        return Finding(extra, f"not installed: pip install 'orbitproof[{extra}]'")
    if unfit:
        return Finding(extra, f"FAULT: {'; '.join(unfit)}", True)
    command = [sys.executable, "-c", f"import {_IMPORTS[extra]}"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, timeout=_SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return Finding(extra, f"FAULT: not imported within {_SECONDS} s", True)
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"exit code {done.returncode}"])[-1]
        return Finding(extra, f"FAULT: {last}", True)
    return Finding(extra, words)


def claim() -> Candidate:
    """A true claim that is proved in a second: where orbits of twice the period branch off the Falkner-Skan family."""
    from orbitproof.shared import FALKNER_SKAN, Candidate, parse_exact

    def exact(*numbers: str) -> tuple[Fraction, ...]:
        return tuple(parse_exact(number) for number in numbers)

    centre = exact("340.187534989143534435148315217286353972779", "0.939792756949623004698036155135298100128")
    frame = (exact("1", "0"), exact("6.56766193564755e-07", "1"))
    return Candidate(
        id="doctor", system=FALKNER_SKAN, parameters={}, kind="period_tupling", k=2, centre=centre, frame=frame,
        kernel_frame=(exact("-1"),), radii=exact("0x1p-80", "0x1p-50"),
    )  # fmt: skip


def found_proofs() -> Iterator[Finding]:
    """A true claim is proved and its certificate stands; a false one is not proved."""
    from orbitproof import verify

    true = claim()
    false = replace(true, id="doctor-false", centre=(true.centre[0] + 10 * true.radii[0], *true.centre[1:]))
    proof, refused = verify.certify([true, false], quiet=True)
    yield Finding("true claim", f"{proof}" if proof.proved else f"FAULT: {proof}", not proof.proved)
    (check,) = verify.recheck(proof, quiet=True)
    yield Finding("its check", check.word if check.stands else f"FAULT: {check.word}", not check.stands)
    yield Finding("false claim", "FAULT: proved" if refused.proved else "not proved, as it should be", refused.proved)
