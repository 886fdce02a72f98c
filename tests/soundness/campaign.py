"""False claims and forged certificates by the thousand: ``python tests/soundness/campaign.py --output campaign.json``.

Runs for hours, keeps what it has after every batch, and goes on with the same command. What is true of a claim is
decided as in `test_soundness_campaign`; a forgery is a certificate of any kind with one to three fields changed and a
new digest, checked at all levels. Nothing false may be proved, and what no level finds has to be among the fields that
belong to no claim.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import random
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

TESTS = Path(__file__).parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "soundness")]

from support import atlas_work  # noqa: E402
from support.chain_cases import parabola  # noqa: E402
from support.claims import EARTH_MOON, known, shifted, verdict_of  # noqa: E402
from support.forgeries import DATA, Change, Document, atlas_certificate, changes, checked, forged, honest, read  # noqa: E402
from test_soundness_campaign import EVERYWHERE, LIMITS, THREE_BODY, Trial, objection, perturbed_symmetry_point  # noqa: E402

import orbitproof.verify.certificate.rechecking as rechecking  # noqa: E402
from orbitproof.shared.formats import InputError  # noqa: E402
from orbitproof.shared.numbers import round_dyadic  # noqa: E402
from orbitproof.verify.bifurcation import level_form  # noqa: E402
from orbitproof.verify.certificate import Certificate, Level, Limits, Recheck, recheck  # noqa: E402
from orbitproof.verify.certificate.certify import certify  # noqa: E402

BATCH = 25

ROWS = ("fs2", "fs3", "fs4", "em1", "em1", "fs2", "fs3", "em2")
"""Rows that claims are made from; what takes longer comes seldom."""

CERTIFICATES = ("fs2", "fs3", "em1", "curve", "family", "surface")

HARMLESS = ("software.", "computation.", "results.*.computation.", "enclosures.", "statement.atlas.title",
            "statement.candidate.system", "statement.atlas.system")  # fmt: skip
"""Fields that belong to no claim, or whose change leaves a true one: a table entry on which nothing depends, a name."""

WEAKER = ("deviation.*", "slope_deviation.*", ".rad")
"""Bounds of atlases; larger ones are true as well."""


def sliver(name: str, source: random.Random) -> Trial:
    """The box moved until the point is just outside of it, by 1e-5 to 1e-1 of a radius."""
    claim = known(name)
    j = source.choice([0, *range(2, len(claim.radii))] if claim.k == 1 else range(len(claim.radii)))
    beyond = 1 + round_dyadic(Fraction(10 ** source.uniform(-5, -1)), 40)
    p = [Fraction(0)] * len(claim.radii)
    p[j] = source.choice((-1, 1)) * claim.radii[j] * beyond
    return Trial("sliver", shifted(claim, tuple(p)), claim.centre)


def mass_by_one_unit(name: str, source: random.Random) -> Trial:
    """The mass parameter off by one unit in its last place: the point moves by much more than the box is wide."""
    step = Fraction(source.choice((-1, 1)), 2**59)
    return Trial("mass, one unit", replace(known(name), parameters={"mu": EARTH_MOON["mu"] + step}), None)


def other_level(name: str, source: random.Random) -> Trial:
    """The level form of a claim at another level of the first integral."""
    claim = known(name)
    form = level_form(claim)
    assert form is not None
    shift = form.radii[0] * round_dyadic(Fraction(10 ** source.uniform(-5, 3)), 40)
    centre = (form.centre[0] + source.choice((-1, 1)) * (form.radii[0] + shift), *form.centre[1:])
    return Trial("level", replace(form, centre=centre), None)


Maker = Callable[[str, random.Random], Trial]


def makers(name: str) -> Sequence[Maker]:
    """Ways of changing a claim of this row."""
    if name.startswith("fs"):
        return (*EVERYWHERE, perturbed_symmetry_point, sliver, sliver, sliver)
    return (*THREE_BODY, sliver, sliver, mass_by_one_unit, other_level)


def claims_batch(seed: int) -> dict[str, Any]:
    """Counts and objections of one batch of claims."""
    source = random.Random(seed)
    counts: Counter[str] = Counter()
    wrong: list[str] = []
    for number in range(BATCH):
        name = source.choice(ROWS)
        trial = source.choice(makers(name))(name, source)
        trial = replace(trial, name=name, claim=replace(trial.claim, id=f"{seed}.{number} {trial.claim.id}"))
        certificate = certify(trial.claim, LIMITS)
        verdict = "proved" if certificate.proved else "refused"
        counts[f"{trial.change}: {'true' if trial.is_true else 'false'}, {verdict}"] += 1
        problem = objection(trial, certificate)
        if problem is not None:
            wrong.append(f"seed {seed}, {trial.claim.id}, {trial.change}: {problem} ({verdict_of(certificate)})")
    return {"counts": counts, "wrong": wrong}


@cache
def material(kind: str) -> tuple[Document, Callable[[Document], Recheck], tuple[Change, ...]]:
    """A certificate of a kind, how to check a forgery of it at all levels, and every change of one field."""
    if kind in ("curve", "family", "surface"):
        document = _atlas_document(kind)
        prover = honest(document["results"], document["statement"]["atlas"]["pieces"])
        return document, lambda changed: checked(changed, prover), tuple(changes(document))
    entry = certify(known(kind), Limits(max_precision=256)).to_json()
    return entry, lambda changed: recheck(Certificate.from_json(changed), True), tuple(changes(entry))


def _atlas_document(kind: str) -> Document:
    atlas, _ = parabola()
    asked = {"integrator": {"precision": 80, "order": 40, "width": 40}, "interval": ["-0x1", "0x1"]}
    results = [
        atlas_work.proving({**asked, "piece": piece.to_json()}, lambda fraction, label: None) for piece in atlas.pieces
    ]
    if kind == "surface":
        found = atlas_certificate(read("surface.json"), json.loads((DATA / "surface-results.json").read_text()))
    elif kind == "family":
        bounds = {"deviation": ["0x1p-40"], "slope_deviation": ["0x1p-36"]}
        found = atlas_certificate(read("atlas-lyapunov.json"), [{**results[0], "piece": "p001", **bounds}])
    else:
        found = atlas_certificate(atlas, results, [certify(known("fs3"), Limits(max_precision=256))])
    return json.loads(json.dumps(found))  # type: ignore[no-any-return]


@cache
def _integrated_once(kind: str) -> None:
    """Let a forgery with the claim of its original be compared with one true integration of it."""
    claim = rechecking._read(material(kind)[0]).claim
    integrate = rechecking.enclose_iterates
    fresh = integrate(claim, rechecking.IntegratorSettings(300, 100))
    rechecking.enclose_iterates = (  # type: ignore[attr-defined]
        lambda asked, *rest: fresh if asked == claim else integrate(asked, *rest)
    )


def forgeries_batch(seed: int) -> dict[str, Any]:
    """Counts of one batch of forgeries by kind and by what found them, and those that should have been found."""
    source = random.Random(seed)
    counts: Counter[str] = Counter()
    wrong: list[str] = []
    for _ in range(BATCH):
        kind = source.choice(CERTIFICATES)
        document, check, possible = material(kind)
        if kind not in ("curve", "family", "surface"):
            _integrated_once(kind)
        chosen = source.sample(possible, source.choice((1, 1, 2, 3)))

        def change(entry: Document, chosen: Sequence[Change] = chosen) -> None:
            for each in chosen:
                each.apply(entry)

        try:
            result = check(forged(document, change))
        except InputError:
            finder = "form"
        else:
            finder = "nothing" if result.stands else Level(result.level + 1).name.lower()
            finder = "nothing (cannot be checked)" if result.obstacle else finder
        counts[f"{kind}: {finder}"] += 1
        if finder == "nothing" and not all(_is_harmless(each) for each in chosen):
            wrong.append(f"seed {seed}, {kind}: {'; '.join(f'{each.field}, {each.how}' for each in chosen)}")
    return {"counts": counts, "wrong": wrong}


def _is_harmless(change: Change) -> bool:
    return change.field.startswith(HARMLESS) or (change.how == "larger" and change.field.endswith(WEAKER))


WORK = {"claims": claims_batch, "forgeries": forgeries_batch}


def run(wanted: dict[str, int], seed: int, output: Path, jobs: int, seconds: float) -> dict[str, Any]:
    """Do what is missing of the wanted numbers; returns and keeps the batches by part and seed."""
    state: dict[str, Any] = json.loads(output.read_text()) if output.exists() else {"seed": seed, "batches": {}}
    if state["seed"] != seed:
        raise SystemExit(f"{output}: was begun with seed {state['seed']}; give that, or another --output")
    deadline = time.monotonic() + seconds
    batches = state["batches"]
    missing = [
        (part, seed * 1_000_000 + number)
        for part, count in wanted.items()
        for number in range(-(-count // BATCH))
        if f"{part} {seed * 1_000_000 + number}" not in batches
    ]
    # Both parts advance together.
    missing.sort(key=lambda item: item[1])
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(jobs, context, signal.signal, (signal.SIGINT, signal.SIG_IGN)) as pool:
        waiting = iter(missing)
        running = {pool.submit(WORK[part], number): f"{part} {number}" for part, number in _first(waiting, 2 * jobs)}
        try:
            while running:
                task = next(as_completed(running))
                name = running.pop(task)
                batches[name] = task.result()
                output.write_text(json.dumps(state, indent=1))
                print(f"{len(batches)} batches, last {name}: {len(batches[name]['wrong'])} wrong", file=sys.stderr)
                if time.monotonic() < deadline:
                    running |= {pool.submit(WORK[p], n): f"{p} {n}" for p, n in _first(waiting, 1)}
        except KeyboardInterrupt:
            print("interrupted; the same command goes on from here", file=sys.stderr)
            pool.shutdown(cancel_futures=True)
    return state


def _first(items: Any, count: int) -> list[Any]:
    return [item for _, item in zip(range(count), items, strict=False)]


def summary(state: dict[str, Any]) -> str:
    """Counts by class, and everything that is wrong."""
    lines = [f"seed {state['seed']}"]
    wrong: list[str] = []
    for part in WORK:
        counts: Counter[str] = Counter()
        for name, batch in state["batches"].items():
            if name.startswith(f"{part} "):
                counts.update(batch["counts"])
                wrong += batch["wrong"]
        lines += [f"{part}: {counts.total()}", *(f"  {name:50} {count}" for name, count in sorted(counts.items()))]
    return "\n".join([*lines, f"wrong: {len(wrong)}", *wrong])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 0 if nothing is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--claims", type=int, default=10_000, metavar="N")
    parser.add_argument("--forgeries", type=int, default=2_000, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=Path("campaign.json"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no further batch after this time")
    options = parser.parse_args(arguments)
    wanted = {"claims": options.claims, "forgeries": options.forgeries}
    print(f"seed {options.seed}", file=sys.stderr)
    text = summary(run(wanted, options.seed, options.output, options.jobs, options.seconds))
    print(text)
    return 0 if "\nwrong: 0" in text else 1


if __name__ == "__main__":
    sys.exit(main())
