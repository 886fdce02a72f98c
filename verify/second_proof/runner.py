"""Command line: prove the rows of a certificates file a second time. README, section 7."""

from __future__ import annotations

import argparse
import fnmatch
import hashlib
import json
import os
import signal
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, cast

from flint import arb

from .proof import SECONDS, Proved, second_proof
from .statement import BadCertificate, read_statement
from .verdict import compare

FORMAT = "orbitproof-second-proofs"
Row = dict[str, Any]


def _ball(value: arb) -> str:
    """A ball as text: midpoint and radius, both exact."""
    (mid, power), (radius, scale) = value.mid().man_exp(), value.rad().man_exp()
    return f"{int(mid):#x}p{int(power):+d} +- {int(radius):#x}p{int(scale):+d}"


def fingerprint(certificate: Mapping[str, Any]) -> str:
    """Which certificate a row is about, and which software: a digest of both."""
    digest = hashlib.sha256(json.dumps(certificate, sort_keys=True).encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()


def prove_row(certificate: Mapping[str, Any], seconds: float) -> Row:
    """The row of one certificate."""
    begin = time.monotonic()
    result = second_proof(certificate, seconds=seconds)
    comparison = compare(certificate, result)
    row: Row = {"id": certificate["id"], "verdict": comparison.verdict, "reason": comparison.reason}
    if isinstance(result, Proved):
        row |= {
            "kind": result.kind,
            "k": result.k,
            "side": result.side,
            "bits": result.bits,
            "steps": result.steps,
            "point": {name: _ball(value) for name, value in result.point.items()},
            "parameter": _ball(result.parameter),
            "hypotheses": [
                {
                    "name": h.name,
                    "statement": h.says,
                    "enclosures": {key: _ball(value) for key, value in h.enclosures.items()},
                }
                for h in result.hypotheses
            ],
        }
    return row | {"seconds": round(time.monotonic() - begin, 1), "fingerprint": fingerprint(certificate)}


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadCertificate(f"{path}: {error}") from None


def _load(path: Path, only: Sequence[str]) -> list[dict[str, Any]]:
    content = _read(path)
    rows = content.get("certificates") if isinstance(content, dict) else None
    if not isinstance(rows, list) or not all(isinstance(row, dict) and isinstance(row.get("id"), str) for row in rows):
        raise BadCertificate(f"{path}: certificates: not a list of certificates with an id")
    chosen = [row for row in rows if not only or any(fnmatch.fnmatch(row["id"], pattern) for pattern in only)]
    if not chosen:
        raise BadCertificate(f"{path}: certificates: none has an id that --only names")
    for row in chosen:
        try:
            read_statement(row)
        except BadCertificate as error:
            raise BadCertificate(f"{path}: {row['id']}: {error}") from None
    return chosen


def _save(path: Path | None, rows: Mapping[str, Row]) -> None:
    if path is not None:
        text = json.dumps({"format": FORMAT, "version": 1, "rows": list(rows.values())}, indent=1) + "\n"
        partial = path.with_name(path.name + ".part")
        partial.write_text(text, encoding="utf-8")
        partial.replace(path)


def _kept(path: Path | None, certificates: Sequence[Mapping[str, Any]]) -> dict[str, Row]:
    if path is None or not path.exists():
        return {}
    content = _read(path)
    if not isinstance(content, dict) or content.get("format") != FORMAT or not isinstance(content.get("rows"), list):
        raise BadCertificate(f"{path}: format: not a file of second proofs; name another one")
    marks = {c["id"]: fingerprint(c) for c in certificates}
    return {row["id"]: row for row in content["rows"] if row.get("fingerprint") == marks.get(row.get("id"), 0)}


def _work(sender: Connection, parent: int, certificate: Mapping[str, Any], seconds: float) -> None:
    def watch() -> None:
        # The parent may be killed without a chance to end its workers.
        while os.getppid() == parent:
            time.sleep(1)
        os._exit(1)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=watch, daemon=True).start()
    sender.send(prove_row(certificate, seconds))


def _run(
    certificates: Sequence[Mapping[str, Any]], rows: dict[str, Row], output: Path | None, jobs: int, seconds: float
) -> None:
    """Prove the rows that are missing, each in a process of its own, and save after every one."""
    waiting = [c for c in certificates if c["id"] not in rows]
    begin, total, done = time.monotonic(), len(waiting), 0
    context = get_context("spawn")
    running: dict[Connection, tuple[BaseProcess, str]] = {}
    try:
        while waiting or running:
            while waiting and len(running) < jobs:
                certificate = waiting.pop(0)
                receiver, sender = context.Pipe(duplex=False)
                worker = context.Process(target=_work, args=(sender, os.getpid(), certificate, seconds), daemon=True)
                worker.start()
                sender.close()
                running[receiver] = worker, certificate["id"]
            for ready in wait(list(running)):
                receiver = cast("Connection", ready)
                ended, name = running.pop(receiver)
                try:
                    row = receiver.recv()
                except EOFError:
                    row = {"id": name, "verdict": "cannot follow", "reason": "its process ended early", "seconds": 0.0}
                receiver.close()
                ended.join()
                rows[name], done = row, done + 1
                _save(output, rows)
                spent = time.monotonic() - begin
                print(
                    f"{done}/{total} {name}: {row['verdict']}, {row['seconds']} s; {spent:.0f} s, "
                    f"about {spent / done * (total - done):.0f} s left",
                    file=sys.stderr,
                    flush=True,
                )
    finally:
        for process, _ in running.values():
            process.terminate()
            process.join()


def _stop(*_: object) -> None:
    raise KeyboardInterrupt


def main(argv: Sequence[str] | None = None) -> int:
    """0: all proved a second time, and the certificates agree; 1: otherwise; 2: bad input."""
    parser = argparse.ArgumentParser(
        prog="orbitproof verify --second-proof", description="Prove the rows of a certificates file a second time."
    )
    parser.add_argument("certificates", type=Path, help="certificates file")
    parser.add_argument("-o", "--output", type=Path, help="write the proofs here after every row, and go on from there")
    parser.add_argument("--jobs", type=int, default=1, help="rows at the same time (default 1)")
    parser.add_argument("--only", nargs="+", default=[], metavar="ID", help="only rows whose id matches")
    parser.add_argument("--row-timeout", type=float, default=SECONDS, help="seconds for one row (default %(default)s)")
    options = parser.parse_args(argv)
    try:
        if options.jobs < 1 or not options.row_timeout > 0:
            raise BadCertificate("--jobs and --row-timeout have to be positive")
        certificates = _load(options.certificates, options.only)
        rows = _kept(options.output, certificates)
    except BadCertificate as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    signal.signal(signal.SIGTERM, _stop)
    try:
        _run(certificates, rows, options.output, options.jobs, options.row_timeout)
    except KeyboardInterrupt:
        print("interrupted; what is done is kept", file=sys.stderr)
    print(f"{'row':34} {'verdict':14} {'side':6} {'seconds':>8}  reason")
    missing = {"verdict": "not tried", "reason": "", "seconds": ""}
    for certificate in certificates:
        row = rows.get(certificate["id"], missing)
        print(
            f"{certificate['id']:34} {row['verdict']:14} {row.get('side', '-'):6} {row['seconds']:>8}  {row['reason']}"
        )
    return 0 if all(rows.get(c["id"], missing)["verdict"] == "agrees" for c in certificates) else 1
