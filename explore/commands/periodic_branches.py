"""``orbitproof explore periodic --from-branches``: orbits that a reversor does not map to themselves, as claims."""

from __future__ import annotations

import argparse
from functools import partial

from orbitproof.explore.commands.periodic_claims import ClaimStore, kept_claims
from orbitproof.shared.answers import tell
from orbitproof.shared.formats import InputError, select_ids
from orbitproof.shared.interrupts import INTERRUPTED
from orbitproof.shared.printed_tables import wrapped

_OTHERS = (
    "system", "parameter", "period", "section", "direction", "level", "transient", "along", "generations", "symmetry",
    "claims", "csv", "family_output", "atlas", "id",
)  # fmt: skip


def take_from_branches(options: argparse.Namespace) -> int:
    """Refine orbits of a branch file and write the claims; returns the exit code. Raises `InputError`."""
    for name in _OTHERS:
        if getattr(options, name):
            option = "--" + name.replace("_", "-")
            raise InputError(
                f"{option}: has no meaning with --from-branches, whose file says what is needed; leave it out"
            )
    if options.output is None:
        raise InputError("-o: missing; name a candidates file for the claims")
    from orbitproof.explore.branches import numbered, read_branches, task_of

    records = {each.id: each for each in read_branches(options.from_branches)}
    chosen = [records[name] for name in select_ids(records, options.only, "branch")]
    losses = [each for each in chosen if each.loses_reversor and each.sides]
    if not losses:
        raise InputError(
            f"{options.from_branches}: it has no branch of orbits without symmetry; explore orbit claims symmetric ones"
        )
    try:
        tasks = [
            task_of(each, number, options.digits)
            for each in losses
            for number in options.orbits or [len(each.sides[1].orbits)]
        ]
    except ValueError as error:
        raise InputError(f"--orbits: {error}") from None
    kept = kept_claims(options)
    from orbitproof.explore.engines import Reporter
    from orbitproof.explore.periodic import refine_periodic

    with Reporter(options.quiet) as report:
        store = ClaimStore(options.output, kept, report)
        try:
            for task in tasks:
                store.add(task.id, partial(refine_periodic, task, report.update))
        except KeyboardInterrupt:
            report.error("interrupted")
            return INTERRUPTED
        finally:
            store.close()
    for task in tasks:
        orbit = numbered(records[task.provenance["branch"]], task.provenance["number"])
        level = "" if task.level is None else f", level {float(task.level):.12g}"
        words = f"{task.id}: period {task.period:.12g}{level}, {orbit.level_difference:.3g} from the birth"
        result = {"id": task.id, "period": task.period, "level": task.level, "level_difference": orbit.level_difference}
        tell(wrapped([words]), [result])
    return 0 if store.complete else 1
