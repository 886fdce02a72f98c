"""False claims and forged certificates by the thousand: ``python tests/soundness/campaign.py --output campaign.json``.

Runs for an hour or more, keeps what it has after every batch, and goes on with the same command. What is true of a
claim is decided as in `test_soundness_campaign`; with ``--candidates`` every row of a candidates file gives false
claims too, about which nothing has to be known but that its centre is the bifurcation point. A forgery is a certificate
of any kind with one to three fields changed and a new digest, or with one entry of what it stores changed and all else
derived from that again. It is checked at all levels; for the last, a claim is integrated once more, and what a prover
would find on the pieces of an atlas is what was proved there. Nothing false may be proved, and what no level finds has
to be among the fields that belong to no claim. A claim of every kind is told otherwise, with other names, in another
order, in other units, beside things that play no part: what is proved, checked again and proved once more is the same.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import math
import random
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import replace
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any

TESTS = Path(__file__).parents[1]
sys.path[:0] = [str(TESTS), str(TESTS / "soundness")]

from support import atlas_work, stability_cases  # noqa: E402
from support.chain_cases import parabola  # noqa: E402
from support.claims import known, shifted, verdict_of  # noqa: E402
from support.forgeries import DATA, Change, Document, atlas_certificate, changes, checked, forged, honest, read  # noqa: E402
from support.metamorphic_cases import CASES  # noqa: E402
from support.metamorphic_runs import table, told_in_every_way  # noqa: E402
from support.stored import values  # noqa: E402
from test_soundness_campaign import (  # noqa: E402
    LIMITS,
    Trial,
    objection,
    perturbed_centre,
    perturbed_frame,
    perturbed_kernel_frame,
    perturbed_kind,
    perturbed_mass,
    perturbed_multiplicity,
    perturbed_radii,
    perturbed_symmetry,
    perturbed_symmetry_point,
    perturbed_system,
)

import orbitproof.verify.certificate.rechecking as rechecking  # noqa: E402
from orbitproof.shared import parse_exact  # noqa: E402
from orbitproof.shared.codec import to_json  # noqa: E402
from orbitproof.shared.formats import Candidate, InputError, read_candidates, write_text  # noqa: E402
from orbitproof.shared.interrupts import run_command  # noqa: E402
from orbitproof.shared.numbers import round_dyadic  # noqa: E402
from orbitproof.shared.processes import Failure, Report, Task, answers  # noqa: E402
from orbitproof.shared.systems import ReversibleSystem  # noqa: E402
from orbitproof.verify.bifurcation import level_form  # noqa: E402
from orbitproof.verify.branches import (  # noqa: E402
    atlas_of,
    conclusion_of,
    make_atlas_certificate,
    order_of,
)
from orbitproof.verify.certificate import (  # noqa: E402
    Certificate,
    Level,
    Limits,
    Recheck,
    certify,
    recheck,
)

BATCH = 25

ROWS = (*16 * ("fs2", "em1"), *6 * ("fs3",), *2 * ("fs4",), "fs5", "em2")
"""Rows that claims are made from; what takes longer comes seldom."""

ROW_LIMITS = Limits(max_precision=512, timeout=300.0)

ATLASES = ("curve", "list", "family", "surface")
CERTIFICATES = ("fs2", "fs3", "em1", "fold", "crossings", "orbit", *ATLASES)
"""Bifurcations, one of them a fold and one of half orbits with two crossings; one orbit; atlases, one with a list."""

HARMLESS = ("software.", "computation.", "results.*.computation.", "enclosures.", "statement.atlas.title",
            "statement.candidate.system", "statement.atlas.system")  # fmt: skip
"""Fields that belong to no claim, or whose change leaves a true one: a table entry on which nothing depends, a name."""

WEAKER = ("deviation.*", "slope_deviation.*", ".error", ".rad")
"""Bounds of atlases; larger ones are true as well."""


def sliver(name: str, source: random.Random) -> Trial:
    """The box moved until the point is just outside of it, by 1e-5 to 1e-1 of a radius."""
    return beside(known(name), source)


def beside(claim: Candidate, source: random.Random) -> Trial:
    """The same for any claim."""
    j = source.choice([0, *range(2, len(claim.radii))] if claim.k == 1 else range(len(claim.radii)))
    beyond = 1 + round_dyadic(Fraction(10 ** source.uniform(-5, -1)), 40)
    p = [Fraction(0)] * len(claim.radii)
    p[j] = source.choice((-1, 1)) * claim.radii[j] * beyond
    return Trial("sliver", shifted(claim, tuple(p)), claim.centre)


def mass_by_one_unit(name: str, source: random.Random) -> Trial:
    """The mass parameter off by one unit in its last place: the point moves by much more than the box is wide."""
    return with_mass_by_one_unit(known(name), source)


def with_mass_by_one_unit(claim: Candidate, source: random.Random) -> Trial:
    """The same for any claim."""
    mass = float(claim.parameters["mu"])
    other = math.nextafter(mass, source.choice((0.0, 1.0)))
    return Trial("mass, one unit", replace(claim, parameters={"mu": Fraction(other)}), None)


def other_level(name: str, source: random.Random) -> Trial:
    """The level form of a claim at another level of the first integral."""
    return at_other_level(known(name), source)


def at_other_level(claim: Candidate, source: random.Random) -> Trial:
    """The same for any claim."""
    form = level_form(claim)
    assert form is not None
    shift = form.radii[0] * round_dyadic(Fraction(10 ** source.uniform(-5, 3)), 40)
    centre = (form.centre[0] + source.choice((-1, 1)) * (form.radii[0] + shift), *form.centre[1:])
    return Trial("level", replace(form, centre=centre), None)


def false_symmetry(name: str, source: random.Random) -> Trial:
    """R or S with one sign turned: the system does not have it."""
    return with_false_symmetry(known(name), source)


def with_false_symmetry(claim: Candidate, source: random.Random) -> Trial:
    """The same for any claim; S matters for its breaking only."""
    system = claim.system
    if claim.symmetry is not None and source.random() < 0.5:
        signs = list(system.symmetries[claim.symmetry])
        signs[source.randrange(len(signs))] *= -1
        changed = replace(system, symmetries={claim.symmetry: tuple(signs)})
        return Trial("S", replace(claim, system=changed), None)
    return Trial("R", replace(claim, system=source.choice(without_its_symmetry(system))), None)


def without_its_symmetry(system: ReversibleSystem) -> list[ReversibleSystem]:
    """The system with every other R that has a Fix(R) of the right dimension; it has none of them."""
    true = [system.reversing_symmetry]
    true += [tuple(a * b for a, b in zip(true[0], signs, strict=True)) for signs in system.symmetries.values()]
    found = []
    for signs in itertools.product((1, -1), repeat=len(system.state)):
        if signs not in true:
            with contextlib.suppress(ValueError):
                found.append(replace(system, reversing_symmetry=signs))
    return found


def exchanged(claim: Candidate, rows: Sequence[Candidate]) -> Trial:
    """The box of a row around the point of the nearest row of the same mass at which something else happens."""
    others = [
        row for row in rows if row.parameters == claim.parameters and (row.k, row.kind) != (claim.k, claim.kind)
    ]  # fmt: skip
    nearest = min(others, key=lambda row: sum(abs(a - b) for a, b in zip(row.centre, claim.centre, strict=True)))
    return Trial("nearest row's point", replace(claim, centre=nearest.centre), None)


def other_multiplicity(claim: Candidate, source: random.Random) -> Trial:
    """Another k, with the kind that goes with it, or another kind."""
    if source.random() < 0.3:
        kind = "touch_and_go" if claim.kind != "touch_and_go" else "period_tupling"
        return Trial("kind", replace(claim, kind=kind), None)
    k = source.choice([k for k in (2, 3, 4) if k != claim.k])
    return Trial("k", replace(claim, k=k, kind="touch_and_go" if k == 3 else "period_tupling", symmetry=None), None)


Maker = Callable[[str, random.Random], Trial]


def makers(name: str) -> Sequence[Maker]:
    """Ways of changing a claim of this row; those that often leave it true come seldom."""
    often = (*8 * (sliver,), *2 * (perturbed_centre, perturbed_kind, perturbed_system, perturbed_multiplicity))
    seldom = (perturbed_frame, perturbed_kernel_frame, perturbed_radii, false_symmetry)
    if not name.startswith("fs"):
        return (*often, *seldom, *4 * (mass_by_one_unit, other_level), perturbed_symmetry, perturbed_mass)
    return (*often, *seldom) if name == "fs5" else (*often, *seldom, *2 * (perturbed_symmetry_point,))


class Record:
    """Counts and objections of one batch.

    Attributes:
        false: how many false claims there were.
    """

    def __init__(self, seed: int) -> None:
        self.seed = seed
        self.counts: Counter[str] = Counter()
        self.rows: Counter[str] = Counter()
        self.wrong: list[str] = []
        self.false = 0

    def add(self, trial: Trial, limits: Limits) -> None:
        """Certify a claim and judge the verdict."""
        row, is_true = trial.claim.id, trial.is_true
        claim = replace(trial.claim, id=f"{self.seed}.{self.counts.total()} {row}")
        certificate = certify(claim, limits)
        verdict = "proved" if certificate.proved else "refused"
        system = claim.system.name
        self.counts[f"{system}, {trial.change}: {'true' if is_true else 'false'}, {verdict}"] += 1
        if not is_true:
            self.false += 1
            self.rows[row] += 1
        problem = objection(trial, certificate)
        if problem is not None:
            self.wrong.append(f"seed {self.seed}, {claim.id}, {trial.change}: {problem} ({verdict_of(certificate)})")

    def to_json(self) -> dict[str, Any]:
        """What is kept."""
        return {"counts": self.counts, "rows": self.rows, "wrong": self.wrong}


def claims_batch(seed: int) -> dict[str, Any]:
    """One batch of false claims, and of true ones that came up among them."""
    source, record = random.Random(seed), Record(seed)
    while record.false < BATCH:
        name = source.choice(ROWS)
        trial = replace(source.choice(makers(name))(name, source), name=name)
        record.add(trial, replace(LIMITS, level=source.choice(("auto", "auto", "integral", "coordinates"))))
    return record.to_json()


def rows_batch(seed: int) -> dict[str, Any]:
    """A false claim from one row of the candidates file; the rows take turns."""
    source, record = random.Random(seed), Record(seed)
    rows = candidate_rows(_CANDIDATES[0])
    claim = rows[seed % 1_000_000 % len(rows)]
    match source.randrange(6):
        case 0 | 1:
            trial = exchanged(claim, rows)
        case 2:
            trial = with_mass_by_one_unit(claim, source)
        case 3:
            trial = at_other_level(claim, source)
        case 4:
            trial = other_multiplicity(claim, source)
        case _:
            trial = beside(claim, source)
    assert not trial.is_true
    record.add(trial, ROW_LIMITS)
    return record.to_json()


@cache
def candidate_rows(path: Path) -> list[Candidate]:
    """The rows of a candidates file that depend on a mass."""
    return [candidate for candidate in read_candidates(path) if "mu" in candidate.parameters]


_CANDIDATES: list[Path] = []
"""The candidates file of this process."""


def batch(argument: tuple[str, int, Path | None], report: Report) -> dict[str, Any]:
    """One batch of a part, by its seed; in a process of its own."""
    part, seed, candidates = argument
    _CANDIDATES[:] = [] if candidates is None else [candidates]
    return WORK[part](seed)


@cache
def material(kind: str) -> tuple[Document, Callable[[Document], Recheck], tuple[Change, ...]]:
    """A certificate of a kind, how to check a forgery of it at all levels, and every change of one field."""
    if kind in ATLASES:
        document = _atlas_document(kind)
        prover = honest(document["results"], document["statement"]["atlas"]["pieces"])
        return document, lambda changed: checked(changed, prover), tuple(changes(document))
    entry = certify(claim_of(kind), Limits(max_precision=256)).to_json()
    assert entry["verdict"] == "proved"
    return entry, lambda changed: recheck(Certificate.from_json(changed), True), tuple(changes(entry))


def claim_of(kind: str) -> Candidate:
    """The true claim of which a certificate is forged."""
    files = {"fold": "known-folds.json", "crossings": "known-crossings.json", "orbit": "orbit-candidates.json"}
    return read_candidates(DATA / files[kind])[-1] if kind in files else known(kind)


def _atlas_document(kind: str) -> Document:
    atlas, _ = parabola()
    asked = {"integrator": {"precision": 80, "order": 40, "width": 40}, "interval": ["-0x1", "0x1"]}
    results = [
        atlas_work.proving({**asked, "piece": to_json(piece)}, lambda fraction, label: None) for piece in atlas.pieces
    ]
    if kind == "list":
        known_ = stability_cases.results()
        found = make_atlas_certificate(stability_cases.atlas(), values(known_), stability_cases.listed(known_))
    elif kind == "surface":
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
    integrate = rechecking.enclose
    fresh = integrate(claim, rechecking.IntegratorSettings(300, 100))
    rechecking.enclose = (  # type: ignore[attr-defined]
        lambda asked, *rest: fresh if asked == claim else integrate(asked, *rest)
    )


def forgeries_batch(seed: int) -> dict[str, Any]:
    """Counts of one batch of forgeries by kind and by what found them, and those that should have been found."""
    source = random.Random(seed)
    counts: Counter[str] = Counter()
    missed: Counter[str] = Counter()
    wrong: list[str] = []
    # One kind for a batch: a batch has a process of its own, which has to make the certificate first.
    kind = CERTIFICATES[seed % len(CERTIFICATES)]
    document, check, possible = material(kind)
    if kind not in ATLASES:
        _integrated_once(kind)
    for _ in range(BATCH):
        consistent = source.random() < 0.3
        chosen = source.sample(
            _stored(possible) if consistent else possible, 1 if consistent else source.choice((1, 1, 2, 3))
        )

        def change(entry: Document, chosen: Sequence[Change] = chosen) -> None:
            for each in chosen:
                each.apply(entry)

        try:
            changed = forged(document, change)
            result = check(derived_again(kind, changed) if consistent else changed)
        except InputError:
            finder = "form"
        else:
            finder = "nothing" if result.stands else Level(result.level + 1).name.lower()
            finder = "nothing (cannot be checked)" if result.obstacle else finder
            finder = "words, told anew" if result.stands and result.rendered is not None else finder
        counts[f"{kind}{', derived again' if consistent else ''}: {finder}"] += 1
        if finder == "nothing":
            missed.update({f"{kind}: {each.field}, {each.how}" for each in chosen})
        if finder == "nothing" and not all(_is_harmless(each, document) for each in chosen):
            wrong.append(f"seed {seed}, {kind}: {'; '.join(f'{each.field}, {each.how}' for each in chosen)}")
    return {"counts": counts, "missed": missed, "wrong": wrong}


def _stored(possible: Sequence[Change]) -> list[Change]:
    """Changes of what a certificate stores and everything else is derived from."""
    return [
        each for each in possible
        if each.field.startswith(("enclosures.", "results.*.")) and "computation" not in each.field
    ]  # fmt: skip


def derived_again(kind: str, changed: Document) -> Document:
    """The certificate that follows from what the changed one stores, as far as anything does."""
    try:
        if kind in ATLASES:
            rests_on = [Certificate.from_json(entry) for entry in changed.get("rests_on", ())]
            atlas, results = atlas_of(changed), changed["results"]
            conclusion = conclusion_of(
                atlas,
                values(results),
                rests_on,
                lambda entries: [recheck(entry) for entry in entries],
                order_of(changed),
            )
            again = make_atlas_certificate(atlas, values(results), conclusion, rests_on)
            return json.loads(json.dumps(again))  # type: ignore[no-any-return]
        return rechecking.derived(changed)
    except (KeyError, ValueError):
        return changed


def _is_harmless(change: Change, document: Document) -> bool:
    if change.field.startswith("results.*.stability.") and change.field.endswith("coefficients.*"):
        # A function whose bound is larger than the change still contains the one that a new integration finds.
        function: Any = document
        for key in change.place[:-2]:
            function = function[key]
        before = parse_exact(function["coefficients"][change.place[-1]])
        return abs(parse_exact(change.value) - before) < parse_exact(function["error"])
    return change.field.startswith(HARMLESS) or (change.how == "larger" and change.field.endswith(WEAKER))


def told_batch(seed: int) -> dict[str, Any]:
    """Every way of telling a claim otherwise, of a kind; the kinds take turns."""
    around, place = divmod(seed % 1_000_000, len(CASES))
    name = list(CASES)[place]
    found = dict(told_in_every_way(name, seed - place + around))
    wrong = [f"seed {seed}, {name}, {title}: {'; '.join(each)}" for title, each in found.items() if each]
    return {"counts": {f"{name}: {title}": int(not each) for title, each in found.items()}, "wrong": wrong}


WORK = {"claims": claims_batch, "rows": rows_batch, "forgeries": forgeries_batch, "told": told_batch}


def run(
    wanted: dict[str, int], seed: int, output: Path, jobs: int, seconds: float, candidates: Path | None
) -> dict[str, Any]:
    """Do what is missing of the wanted numbers of batches; returns and keeps the batches by part and seed."""
    state: dict[str, Any] = json.loads(output.read_text()) if output.exists() else {"seed": seed, "batches": {}}
    if state["seed"] != seed:
        raise SystemExit(f"{output}: was begun with seed {state['seed']}; give that, or another --output")
    deadline = time.monotonic() + seconds
    batches = state["batches"]
    # All parts advance together.
    every = sorted((number / count, part, number) for part, count in wanted.items() for number in range(count))
    missing = [
        (part, seed * 1_000_000 + number)
        for _, part, number in every
        if f"{part} {seed * 1_000_000 + number}" not in batches
    ]
    waiting = iter(missing)

    def next_batch() -> Task | None:
        part, number = next(waiting, ("", 0)) if time.monotonic() < deadline else ("", 0)
        return Task(f"{part} {number}", (part, number, candidates)) if part else None

    for answer in answers(batch, next_batch, lambda *_: None, jobs):
        if isinstance(answer.result, Failure):
            raise RuntimeError(f"{answer.task.name}: {answer.result.message}")
        batches[answer.task.name] = answer.result
        write_text(output, json.dumps(state, indent=1))
        wrong = len(batches[answer.task.name]["wrong"])
        print(f"{len(batches)} of {len(every)} batches, last {answer.task.name}: {wrong} wrong", file=sys.stderr)
    return state


def summary(state: dict[str, Any]) -> str:
    """Counts by class, and everything that is wrong."""
    lines = [f"seed {state['seed']}"]
    wrong: list[str] = []
    rows: Counter[str] = Counter()
    missed: Counter[str] = Counter()
    for part in WORK:
        counts: Counter[str] = Counter()
        for name, batch in state["batches"].items():
            if name.startswith(f"{part} "):
                counts.update(batch["counts"])
                rows.update(batch.get("rows", {}))
                missed.update(batch.get("missed", {}))
                wrong += batch["wrong"]
        each = [f"  {name:58} {count}" for name, count in sorted(counts.items())]
        lines += [f"{part}: {counts.total()}", *(table(counts) if part == "told" else each)]
    for title, found in (("false claims", rows), ("found by no level", missed)):
        lines += [f"{title}: {found.total()}", *(f"  {name:58} {count}" for name, count in sorted(found.items()))]
    return "\n".join([*lines, f"wrong: {len(wrong)}", *wrong])


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; 0 if nothing is wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--claims", type=int, default=10_000, metavar="N")
    parser.add_argument("--forgeries", type=int, default=2_000, metavar="N")
    parser.add_argument("--candidates", type=Path, metavar="FILE", help="a file whose rows give false claims too")
    parser.add_argument("--of-each-row", type=int, default=4, metavar="N", help="false claims from each row (4)")
    parser.add_argument("--told", type=int, default=1, metavar="N", help="how often each kind is told in every way (1)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--output", type=Path, default=Path("campaign.json"))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=float("inf"), help="begin no further batch after this time")
    options = parser.parse_args(arguments)
    wanted = {"claims": -(-options.claims // BATCH), "forgeries": -(-options.forgeries // BATCH)}
    wanted["told"] = options.told * len(CASES)
    if options.candidates is not None:
        wanted["rows"] = options.of_each_row * len(candidate_rows(options.candidates))
    print(f"seed {options.seed}", file=sys.stderr)
    state = run(wanted, options.seed, options.output, options.jobs, options.seconds, options.candidates)
    print(summary(state))
    return 1 if any(batch["wrong"] for batch in state["batches"].values()) else 0


if __name__ == "__main__":
    # By its name as a module: processes of their own do the work, and import it.
    import campaign

    sys.exit(run_command(campaign.main))
