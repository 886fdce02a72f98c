"""Command line of the second proof: ``orbitproof verify --second-proof certificates.json -o second-proofs.json``.

The proof itself is `verify/second_proof`, which shares nothing with the rest. Here its rows are done side by side, and
what it finds is compared with the certificates and written down.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from flint import arb

from orbitproof.shared.answers import answered, tell
from orbitproof.shared.formats import (
    InputError,
    check_writable,
    read_document,
    refused,
    select_ids,
    stated_format,
    write_text,
)
from orbitproof.shared.printed_tables import fitted
from orbitproof.shared.processes import Answer, Failure, Report, Task
from orbitproof.shared.systems import shown
from orbitproof.verify import second_proof as folder
from orbitproof.verify.evidence import guarded
from orbitproof.verify.run import (
    ArgumentParser,
    CheckLimits,
    Display,
    Processes,
    Workplace,
    apart,
    interrupted,
    positive_seconds,
    whole_number,
)
from orbitproof.verify.run.relation import NOT_CONFIRMED, Comparison, agreement
from orbitproof.verify.run.second_bifurcation import compare_bifurcation, compare_torus
from orbitproof.verify.run.second_equilibrium import compare_curve, compare_equilibrium
from orbitproof.verify.run.second_periodic import compare_periodic, is_in_the_box
from orbitproof.verify.run.second_symmetric import compare_birth, compare_symmetric
from orbitproof.verify.second_proof import (
    BadCertificate,
    CannotFollow,
    NotProved,
    Outcome,
    Proved,
    ProvedBirth,
    ProvedCurve,
    ProvedEquilibrium,
    ProvedHopf,
    ProvedPeriodic,
    ProvedPeriodicBifurcation,
    ProvedSymmetric,
    ProvedTorus,
    read_claim,
    second_proof,
)

FORMAT, CURVE = "orbitproof-second-proofs", "atlas-certificate"
Row = dict[str, Any]

_DESCRIPTION = """\
Prove certified bifurcations, losses of R, symmetric orbits, their stability and tori, periodic orbits without symmetry
with their bifurcations, equilibria, their curves and Hopf points once more, by code that shares nothing with the first
proof, and compare the results.
"""

_EXAMPLES = """\
examples:
  orbitproof verify --second-proof certificates.json -o second-proofs.json --jobs 2
      prove all rows again; if interrupted, the same command goes on

exit codes: 0 all rows are proved again and agree, 1 some are not, 2 bad input, 130 interrupted
"cannot follow" says nothing against the certificate
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    parser = ArgumentParser("orbitproof verify --second-proof", _DESCRIPTION, _EXAMPLES)
    parser.add_argument("file", type=Path, help="certificates file (JSON)")
    parser.add_argument("-o", "--output", type=Path, help="file of second proofs; rows are saved as they finish")
    parser.add_argument("--only", nargs="+", metavar="ID", help="these only (with * and ? as in file names)")
    parser.number("--jobs", "N", "rows side by side, each in a process of its own (default: 1)", whole_number(1), 1)
    parser.number("--row-timeout", "SECONDS", "give a row up after this processor time", positive_seconds, None)
    parser.memory_option("each row")
    parser.add_argument("--fresh", action="store_true", help="prove again what an earlier run proved")
    parser.add_argument("--quiet", action="store_true", help="no progress on stderr")
    options = parser.parse_args(arguments)
    return answered("orbitproof verify --second-proof", options.json, lambda: _done(options))


def _done(options: argparse.Namespace) -> int:
    try:
        return _run(options)
    except InputError as error:
        return refused(error)


COMPARED: tuple[tuple[type[Any] | tuple[type[Any], ...], Callable[[Mapping[str, Any], Any], Comparison]], ...] = (
    (ProvedPeriodic, compare_periodic),
    (ProvedPeriodicBifurcation, compare_bifurcation),
    (ProvedTorus, compare_torus),
    (ProvedBirth, compare_birth),
    (ProvedSymmetric, compare_symmetric),
    ((ProvedEquilibrium, ProvedHopf), compare_equilibrium),
    (ProvedCurve, compare_curve),
)
"""How what is proved of each kind is compared."""


def compare(certificate: Mapping[str, Any], result: Outcome) -> Comparison:
    """Whether a second proof says the same as the certificate, value by value. Section 7 of its chapter.

    Of bifurcations kind, k, side; the point, the parameter and the normal form; the point in the box of the candidate.
    Raises `LookupError` or `ValueError` for a certificate that is not well formed.
    """
    if isinstance(result, NotProved):
        return Comparison("cannot follow", result.reason)
    if certificate["verdict"] != "proved":
        return Comparison("cannot follow", "the certificate proves nothing to compare with")
    if not isinstance(result, Proved):
        (comparison,) = [function for kind, function in COMPARED if isinstance(result, kind)]
        with guarded(4096):
            return comparison(certificate, result)
    claim, results = certificate["statement"]["candidate"], certificate["results"]
    if (result.kind, result.k) != (claim["kind"], claim["k"]):
        return Comparison("disagrees", f"kind or k: {result.kind}, {result.k}")
    if results["side"] != result.side:
        return Comparison("disagrees", f"side: {results['side']} in the certificate, {result.side} here")
    with guarded(4096):
        stored, mine = _values(results), _values_here(certificate, result)
        for name in sorted(name for name in {*stored} ^ {*mine} if not name.startswith("normal_form.")):
            return Comparison("disagrees", f"{name}: is here or in the certificate, and not in both")
        pairs = {name: (mine[name], entry) for name, entry in stored.items() if name in mine}
        untold = [name for name in stored if name not in mine]
        is_in_box = is_in_the_box(claim, list(result.point.values()))
        return agreement(["kind, k, side"], pairs, [*untold, NOT_CONFIRMED], is_in_box)


def _values(results: Mapping[str, Any]) -> dict[str, Any]:
    """Every number among the results of a certificate, by the path at which it stands."""
    values = {f"{part}.{name}": ball for part in ("point", "normal_form") for name, ball in results[part].items()}
    return {"parameter": results["parameter"]} | values


def _values_here(certificate: Mapping[str, Any], result: Proved) -> dict[str, arb]:
    """The balls of a second proof, as far as they are about the same coordinates."""
    # h_fp' is a derivative in p_0, and p_0 of a level form is not that of the candidate.
    foreign = {"h_fp'"} if "level_form" in certificate["statement"] else set()
    form = {f"normal_form.{name}": ball for name, ball in result.normal_form.items() if name not in foreign}
    return {"parameter": result.parameter} | {f"point.{name}": ball for name, ball in result.point.items()} | form


def prove_row(certificate: Mapping[str, Any], _: Report) -> Row:
    """The row of one certificate."""
    used = time.process_time()
    result = second_proof(certificate)
    row: Row = {"id": certificate["id"]} | vars(compare(certificate, result))
    if isinstance(result, Proved):
        row |= {name: getattr(result, name) for name in ("kind", "k", "side", "width", "bits", "steps")}
        row |= {"point": _texts(result.point), "parameter": _text(result.parameter)}
        row["normal_form"] = _texts(result.normal_form)
    if isinstance(result, ProvedPeriodicBifurcation):
        row |= {"kind": result.kind, "side": result.side, "criticality": result.criticality}
        row |= {name: _text(getattr(result, name)) for name in ("parameter", "opening")}
    if isinstance(result, ProvedTorus):
        row |= {"kind": result.kind, "side": result.side, "criticality": result.criticality}
        row |= {name: _text(getattr(result, name)) for name in ("parameter", "speed", "lyapunov")}
        row["multiplier"] = [_text(result.multiplier.real), _text(result.multiplier.imag)]
    if isinstance(result, (ProvedPeriodic, ProvedPeriodicBifurcation, ProvedTorus)):
        row |= {name: getattr(result, name) for name in ("inside", "on", "outside", "width", "bits", "steps")}
        row |= {"point": _texts(result.point), "period": _text(result.period)}
        row["multipliers"] = [[_text(value.real), _text(value.imag)] for value in result.multipliers]
    if isinstance(result, ProvedBirth):
        row |= {"kind": result.kind, "side": result.side, "direction": _texts(result.direction)}
        row |= {name: _text(getattr(result, name)) for name in ("parameter", "opening")}
    if isinstance(result, ProvedSymmetric):
        row |= {"kind": result.kind, "twists": _texts(result.twists)}
        row["stability_parameters"] = [[_text(value.real), _text(value.imag)] for value in result.stability]
        row |= {} if result.rotation_number is None else {"rotation_number": _text(result.rotation_number)}
        if result.torsion is not None:
            row["rotation_numbers"] = [_text(value) for value in result.torsion.rotation_numbers]
            row["torsion"] = [[_text(value) for value in line] for line in result.torsion.rows]
    if isinstance(result, (ProvedEquilibrium, ProvedHopf)):
        row |= {name: getattr(result, name) for name in ("left", "right", "is_only", "width", "bits")}
        row |= {"kind": certificate["statement"]["candidate"]["kind"], "point": _texts(result.point)}
        row["eigenvalues"] = [[_text(value.real), _text(value.imag)] for value in result.multipliers]
    if isinstance(result, ProvedHopf):
        row |= {name: getattr(result, name) for name in ("side", "criticality")}
        row |= {name: _text(getattr(result, name)) for name in ("parameter", "frequency", "speed", "lyapunov")}
    if isinstance(result, ProvedCurve):
        row |= {"kind": certificate["statement"]["atlas"]["claim"]["kind"], "boxes": result.boxes, "bits": result.bits}
        row |= {name: _texts(getattr(result, name)) for name in ("start", "end")}
        row["extrema"] = [[each.is_maximum, _text(each.value)] for each in result.extrema]
        row["parts"] = [[_text(part.values), part.sides] for part in result.parts]
    if isinstance(result, (ProvedBirth, ProvedSymmetric)):
        row |= {name: getattr(result, name) for name in ("width", "bits", "steps")}
        row |= {name: _texts(getattr(result, name)) for name in ("point", "other_point")}
        row["period"] = _text(result.period)
    if not isinstance(result, NotProved):
        row["hypotheses"] = [{"name": h.name, "enclosures": _texts(h.enclosures)} for h in result.hypotheses]
    return row | {"cpu_seconds": round(time.process_time() - used, 1), "fingerprint": fingerprint(certificate)}


def fingerprint(certificate: Mapping[str, Any]) -> str:
    """Which certificate a row is about, and which program proved and compared it: a digest of both."""
    digest, here = hashlib.sha256(json.dumps(certificate, sort_keys=True).encode()), Path(__file__).parent
    sources = (*Path(str(folder.__file__)).parent.glob("*.py"), *here.glob("second_*.py"), here / "relation.py")
    for source in sorted(sources):
        digest.update(source.read_bytes())
    return digest.hexdigest()


class SecondProofs:
    """The rows of second proofs so far: those of an earlier run that count, and those that are made.

    Attributes:
        rows: by id, as the file has them.
        pending: ids of the certificates that no row is about.
    """

    def __init__(self, certificates: Mapping[str, Row], output: Path | None = None, fresh: bool = False) -> None:
        """`output` is the file that keeps them. Raises `InputError` if it holds something else."""
        self._certificates, self._output = certificates, output
        self.rows: dict[str, Row] = {} if output is None else _earlier(output)
        marks = {name: fingerprint(certificate) for name, certificate in certificates.items()}
        self.pending = [n for n, mark in marks.items() if fresh or self.rows.get(n, {}).get("fingerprint") != mark]
        for name in self.pending:
            self.rows.pop(name, None)

    def prove(self, workplace: Workplace) -> None:
        """Prove what is left; what ends it, an interrupt too, leaves what is done here and in the file."""
        display = Display(dict.fromkeys(self.pending, 1.0), workplace.quiet)
        total = len(self._certificates)
        if len(self.pending) < total:
            display.message(f"{total - len(self.pending)} of {total} rows are there already, kept")
        tasks = iter([Task(name, self._certificates[name]) for name in self.pending])

        def finished(answer: Answer) -> None:
            row = answer.result
            if isinstance(row, Failure):
                # Without a fingerprint: the next run tries it again.
                row = {"id": answer.task.name, "verdict": "cannot follow", "reason": row.message}
            self.rows[answer.task.name] = dict(row)
            if self._output is not None:
                _save(self._output, self.rows)
            display.finish(answer.task.name, f"{row['verdict']}, {answer.seconds:.1f} s")

        engine = Processes(workplace.jobs, workplace.timeout, workplace.memory)
        with display.shown():
            engine.run(prove_row, lambda: next(tasks, None), display.advance, finished)


def _run(options: argparse.Namespace) -> int:
    certificates = _selected(options)
    proofs = SecondProofs(certificates, options.output, options.fresh)
    ended = False
    try:
        proofs.prove(Workplace(options.jobs, None, options.row_timeout, options.memory, options.quiet))
    except KeyboardInterrupt:
        ended = True
    tell("\n".join(_table(list(certificates), proofs.rows)), [proofs.rows[n] for n in certificates if n in proofs.rows])
    if ended:
        done = sum(name in proofs.rows for name in certificates)
        return interrupted(done, len(certificates), "rows finished", options.output if proofs.rows else None)
    return 0 if all(proofs.rows[name]["verdict"] == "agrees" for name in certificates) else 1


def _selected(options: argparse.Namespace) -> dict[str, Row]:
    """The certificates of a file by id, or some of them. Raises `InputError`."""
    path: Path = options.file
    if stated_format(path, "give the path of a certificates file") == CURVE:
        certificate = read_document(path, CURVE)
        certificates: dict[str, Row] = {certificate["id"]: certificate}
    else:
        certificates = {entry["id"]: entry for entry in read_document(path, "certificates")["certificates"]}
    chosen = {name: certificates[name] for name in select_ids(certificates, options.only, "certificate")}
    problem = problem_of(chosen, CheckLimits(memory=options.memory))
    if problem:
        raise InputError(f"{path}: {problem}; write the certificate again")
    return chosen


def problem_of(certificates: Mapping[str, Row], limits: CheckLimits) -> str:
    """Which of these is not well formed, and why; empty if none is. Read in a process of its own."""
    problem = apart(_first_problem, "statements", (list(certificates.items()),), limits)
    # What reading does not survive is the failure of its own row.
    return "" if isinstance(problem, Failure) else problem


def _first_problem(certificates: Sequence[tuple[str, Row]]) -> str:
    """Which certificate is not well formed, and why; empty if none is."""
    for name, entry in certificates:
        try:
            with suppress(CannotFollow):
                read_claim(entry)
        except BadCertificate as error:
            return f"{name}: {error}"
    return ""


def _earlier(path: Path) -> dict[str, Row]:
    """The rows of an earlier run. Raises `InputError` if the file holds anything else."""
    check_writable(path)
    if not path.is_file():
        return {}
    try:
        content = json.loads(path.read_text("utf-8"))
        if content["format"] == FORMAT:
            return {row["id"]: row for row in content["rows"]}
    except (OSError, ValueError, TypeError, LookupError):
        pass
    raise InputError(f"{path}: no file of second proofs; choose another output")


def _save(path: Path, rows: Mapping[str, Row]) -> None:
    write_text(path, json.dumps({"format": FORMAT, "version": 1, "rows": list(rows.values())}, indent=1) + "\n")


def _table(names: Sequence[str], rows: Mapping[str, Row]) -> list[str]:
    missing = {"verdict": "not tried", "reason": ""}
    found = [(name, rows.get(name, missing)) for name in names]
    cells = [
        [shown(name), row["verdict"], row.get("side", "-"), f"{row.get('cpu_seconds', '-')}"] for name, row in found
    ]
    lines = fitted([["row", "verdict", "side", "CPU s"], *cells])
    reasons = [
        f"{shown(name)}: {row['reason']}" for name, row in found if row["verdict"] not in ("agrees", "not tried")
    ]
    return lines + reasons


def _text(value: arb) -> str:
    """A ball as text: midpoint and radius, both exact."""
    (mid, power), (radius, scale) = value.mid().man_exp(), value.rad().man_exp()
    return f"{int(mid):#x}p{int(power):+d} +- {int(radius):#x}p{int(scale):+d}"


def _texts(values: Mapping[str, arb]) -> dict[str, str]:
    return {name: _text(value) for name, value in values.items()}
