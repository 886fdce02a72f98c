"""Comparison with certificates, and the command line. README, section 7."""

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
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from multiprocessing import active_children, get_context
from pathlib import Path
from typing import Any

from flint import arb, arb_mat

from .jets import ball, precision
from .proof import SECONDS, NotProved, Proved, second_proof
from .statement import BadCertificate, exact, read_statement

FORMAT = "orbitproof-second-proofs"
Row = dict[str, Any]


@dataclass(frozen=True)
class Comparison:
    """`verdict` is ``agrees``, ``disagrees`` or ``cannot follow``; `reason` says where or why."""

    verdict: str
    reason: str


def _apart(mine: arb, stored: Mapping[str, Any], field: str) -> bool:
    """Whether two balls certainly have no common point."""
    try:
        mid, rad = exact(stored["mid"], field), exact(stored["rad"], field)
    except (KeyError, TypeError):
        raise BadCertificate(f"{field}: not a ball") from None
    with precision(4096):
        return not mine.overlaps(ball(mid) + arb(0, ball(rad).upper()))


def _place(result: Proved, claim: Mapping[str, Any]) -> bool | None:
    """Whether the point certainly lies in the box of the candidate, certainly does not, or None: neither is certain."""
    try:
        frame = [[exact(c, "frame") for c in row] for row in claim["frame"]]
        centre = [exact(c, "centre") for c in claim["centre"]]
        radii = [exact(c, "radii") for c in claim["radii"]]
    except (KeyError, TypeError):
        raise BadCertificate("statement.candidate: frame, centre or radii are missing") from None
    with precision(4096):
        away = [[v - ball(c)] for v, c in zip(result.point.values(), centre, strict=True)]
        coordinates = arb_mat([[ball(c) for c in row] for row in frame]).solve(arb_mat(away))
        sizes = [(abs(coordinates[i, 0]), ball(r)) for i, r in enumerate(radii)]
        if any(size > radius for size, radius in sizes):
            return False
        return True if all(size <= radius for size, radius in sizes) else None


def compare(certificate: Mapping[str, Any], result: Proved | NotProved) -> Comparison:
    """Whether a second proof says the same as the certificate: kind, k, side, and enclosures that overlap."""
    if isinstance(result, NotProved):
        return Comparison("cannot follow", result.reason)
    results, claim = certificate.get("results"), certificate["statement"]["candidate"]
    if certificate.get("verdict") != "proved" or not isinstance(results, Mapping):
        return Comparison("cannot follow", "the certificate proves nothing to compare with")
    if (result.kind, result.k) != (claim["kind"], claim["k"]):
        return Comparison("disagrees", f"kind or k: {result.kind}, {result.k}")
    if results.get("side") != result.side:
        return Comparison("disagrees", f"side: {results.get('side')} in the certificate, {result.side} here")
    for name, value in result.point.items():
        if name not in results["point"] or _apart(value, results["point"][name], f"results.point.{name}"):
            return Comparison("disagrees", f"{name}: the enclosures have no common point")
    if _apart(result.parameter, results["parameter"], "results.parameter"):
        return Comparison("disagrees", "parameter: the enclosures have no common point")
    place = _place(result, claim)
    if place is None:
        return Comparison("cannot follow", "the enclosure of the point is too wide to tell whether it is in the box")
    if not place:
        return Comparison("disagrees", "the point is not in the box of the candidate")
    return Comparison("agrees", "kind, k, side; point and parameter overlap; the point is in the box of the candidate")


def _text(value: arb) -> str:
    """A ball as text: midpoint and radius, both exact."""
    (mid, power), (radius, scale) = value.mid().man_exp(), value.rad().man_exp()
    return f"{int(mid):#x}p{int(power):+d} +- {int(radius):#x}p{int(scale):+d}"


def _texts(values: Mapping[str, arb]) -> dict[str, str]:
    return {name: _text(value) for name, value in values.items()}


def fingerprint(certificate: Mapping[str, Any]) -> str:
    """Which certificate a row is about, and which software: a digest of both."""
    digest = hashlib.sha256(json.dumps(certificate, sort_keys=True).encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(source.read_bytes())
    return digest.hexdigest()


def prove_row(certificate: Mapping[str, Any], seconds: float) -> Row:
    """The row of one certificate."""
    begin, used = time.monotonic(), time.process_time()
    result = second_proof(certificate, seconds=seconds)
    row: Row = {"id": certificate["id"]} | vars(compare(certificate, result))
    if isinstance(result, Proved):
        row |= {name: getattr(result, name) for name in ("kind", "k", "side", "bits", "steps")}
        row |= {"radius": _text(result.radius), "point": _texts(result.point), "parameter": _text(result.parameter)}
        row["hypotheses"] = [vars(h) | {"enclosures": _texts(h.enclosures)} for h in result.hypotheses]
    row |= {"seconds": round(time.monotonic() - begin, 1), "cpu_seconds": round(time.process_time() - used, 1)}
    return row | {"fingerprint": fingerprint(certificate)}


def _read(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise BadCertificate(f"{path}: {error}") from None


def _load(path: Path, only: Sequence[str]) -> list[Row]:
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


def _kept(path: Path | None, certificates: Sequence[Row]) -> dict[str, Row]:
    if path is None or not path.exists():
        return {}
    content = _read(path)
    if not isinstance(content, dict) or content.get("format") != FORMAT or not isinstance(content.get("rows"), list):
        raise BadCertificate(f"{path}: format: not a file of second proofs; name another one")
    marks = {c["id"]: fingerprint(c) for c in certificates}
    return {row["id"]: row for row in content["rows"] if row.get("fingerprint") == marks.get(row.get("id"), 0)}


def _save(path: Path | None, rows: Mapping[str, Row]) -> None:
    if path is not None:
        text = json.dumps({"format": FORMAT, "version": 1, "rows": list(rows.values())}, indent=1) + "\n"
        partial = path.with_name(path.name + ".part")
        partial.write_text(text, encoding="utf-8")
        partial.replace(path)


def _prepare_worker(parent: int) -> None:
    """Leave the interrupt key to the parent, and end with it even if it is killed."""

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1)
        os._exit(1)

    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=watch, daemon=True).start()


def _run(certificates: Sequence[Row], rows: dict[str, Row], output: Path | None, jobs: int, seconds: float) -> None:
    """Prove the rows that are missing in processes of their own, and save after every one."""
    waiting, begin = [c for c in certificates if c["id"] not in rows], time.monotonic()
    pool = ProcessPoolExecutor(jobs, get_context("spawn"), _prepare_worker, (os.getpid(),))
    try:
        futures: dict[Future[Row], str] = {pool.submit(prove_row, c, seconds): c["id"] for c in waiting}
        for done, future in enumerate(as_completed(futures), 1):
            name, error = futures[future], future.exception()
            ended = {"verdict": "cannot follow", "reason": f"its process ended early: {error}", "seconds": 0.0}
            rows[name] = future.result() if error is None else {"id": name} | ended
            _save(output, rows)
            spent = time.monotonic() - begin
            left = f"{spent:.0f} s, about {spent / done * (len(waiting) - done):.0f} s left"
            text = f"{done}/{len(waiting)} {name}: {rows[name]['verdict']}, {rows[name]['seconds']} s; {left}"
            print(text, file=sys.stderr, flush=True)
    except BaseException:
        for worker in active_children():
            worker.terminate()
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def _stop(*_: object) -> None:
    raise KeyboardInterrupt


def main(argv: Sequence[str] | None = None) -> int:
    """0: all proved a second time, and the certificates agree; 1: otherwise; 2: bad input; 130: interrupted."""
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
    interrupted = False
    try:
        _run(certificates, rows, options.output, options.jobs, options.row_timeout)
    except KeyboardInterrupt:
        print("interrupted; what is done is kept", file=sys.stderr)
        interrupted = True
    missing = {"verdict": "not tried", "reason": "", "seconds": ""}
    print(f"{'row':34} {'verdict':14} {'side':6} {'seconds':>8}  reason")
    for name in (c["id"] for c in certificates):
        row = rows.get(name, missing)
        print(f"{name:34} {row['verdict']:14} {row.get('side', '-'):6} {row['seconds']:>8}  {row['reason']}")
    if interrupted:
        return 130
    return 0 if all(rows.get(c["id"], missing)["verdict"] == "agrees" for c in certificates) else 1
