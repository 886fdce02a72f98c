"""What runs have proved and checked, for stdout."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from orbitproof.shared.formats import BoxClaim, as_options
from orbitproof.shared.printed_tables import filled, fitted, terminal_width
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import MEANINGS, Certificate, Level, Recheck
from orbitproof.verify.certificate.kinds import kind_of
from orbitproof.verify.evidence import certain_digits
from orbitproof.verify.run.other_boxes import remark

_SHOWN_DIGITS = 34
_DIGITS_OF_A_POINT = 16
_NAMED = 3
"""So many candidates that are not finished are named."""


def verdict_text(
    candidates: Sequence[BoxClaim], certificates: Mapping[str, Certificate], kept: frozenset[str] = frozenset()
) -> str:
    """What is proved, a block of lines for each candidate in order, and why what is not proved is not.

    `kept` names the rows that an earlier run proved.
    """
    lines: list[str] = []
    names = [shown(candidate.id) for candidate in candidates if candidate.id not in certificates]
    for candidate in candidates:
        certificate = certificates.get(candidate.id)
        if certificate is None:
            continue
        when = "by an earlier run" if candidate.id in kept else f"in {certificate.computation.seconds:.1f} s"
        lines.append(f"{shown(certificate.id)}: {certificate.verdict} {when}")
        for text in _found(certificate, candidate):
            lines += filled(text, terminal_width(), "  ", "    ")
    unfinished = names if len(names) <= _NAMED else [f"{len(names)} candidates"]
    lines += [f"{each}: not finished" for each in unfinished]
    return "\n".join(lines)


def _found(certificate: Certificate, candidate: BoxClaim) -> Iterator[str]:
    """What a certificate proves, or why it proves nothing; then about which box, if that is another than was given."""
    yield ", ".join(filter(None, (certificate.claimed, certificate.on_side)))
    if certificate.parameter is not None:
        yield f"{certificate.parameter_name} = {certain_digits(certificate.parameter, _SHOWN_DIGITS)}"
    if certificate.proved:
        yield from kind_of(candidate).besides(candidate, certificate.results)
    orbit = certificate.orbit or certificate.periodic
    if orbit is not None and orbit.level is not None and orbit.level_name != certificate.parameter_name:
        yield f"{orbit.level_name} = {certain_digits(orbit.level, _SHOWN_DIGITS)}"
    if certificate.point:
        places = (f"{name} = {certain_digits(ball, _DIGITS_OF_A_POINT)}" for name, ball in certificate.point.items())
        yield f"at {', '.join(places)}"
    if certificate.orbit is not None and certificate.orbit.least is not None:
        nearest = certain_digits(certificate.orbit.least.distance, _DIGITS_OF_A_POINT)
        yield f"least distance from {certificate.orbit.distance_name} = {nearest}"
    about_the_box = remark(certificate)
    if about_the_box is not None:
        yield about_the_box
    if certificate.reason is not None:
        remedy = as_options(certificate.reason.remedy, timeout="--row-timeout")
        yield f"{certificate.reason.condition}: {certificate.reason.message}; {remedy}"


def verdicts_as_json(candidates: Sequence[BoxClaim], certificates: Mapping[str, Certificate]) -> list[dict[str, Any]]:
    """What is proved, for programs: the fields of the certificates that say what is proved."""
    done = (certificates[each.id] for each in candidates if each.id in certificates)
    rows = []
    for certificate in done:
        entry = certificate.to_json()
        row = {"id": certificate.id, "kind": certificate.kind, "k": certificate.k, "verdict": certificate.verdict}
        rows.append(row | {name: entry[name] for name in ("results", "reason", "computation")})
    return rows


def rechecks_as_json(names: Sequence[str], rechecks: Mapping[str, Recheck]) -> list[dict[str, Any]]:
    """What checking certificates again has shown, for programs; those that are not finished are left out."""
    return [
        {
            "id": check.id,
            "verdict": check.verdict,
            "check": check.word,
            "stands": check.stands,
            "level": int(check.passed),
            "hypotheses": check.hypotheses,
            "bits": check.precision or None,
            "findings": [{"place": entry.place, "message": entry.message} for entry in check.findings],
            "remarks": [as_options(text) for text in (check.obstacle, check.open_place, *check.notes) if text],
        }
        for check in map(rechecks.get, names)
        if check is not None
    ]


def recheck_table(names: Sequence[str], rechecks: Mapping[str, Recheck]) -> str:
    """What checking certificates again has shown, as plain text; then every finding, or the first ones.

    Last, for the levels that were climbed, what was checked, how, and what remains to be believed.
    """
    rows: list[tuple[str, ...]] = [("certificate", "verdict", "check", "level", "hypotheses", "integrated")]
    remarks: list[str] = []
    for each in names:
        name, result = shown(each), rechecks.get(each)
        if result is None:
            rows.append((name, "", "not finished", "", "", ""))
            continue
        integrated = f"{result.precision} bits" if result.precision else "no"
        level = f"{result.passed:d} {result.passed.name.lower()}"
        rows.append((name, result.verdict, result.word, level, str(result.hypotheses), integrated))
        remarks += [f"{name}: {entry.place}: {entry.message}" for entry in result.findings[:_SHOWN_FINDINGS]]
        further = len(result.findings) - _SHOWN_FINDINGS
        remarks += [f"{name}: and {further} more"] if further > 0 else []
        remarks += [
            f"{name}: {as_options(text)}" for text in (result.obstacle, result.open_place, *result.notes) if text
        ]
    if not any(result.precision for result in rechecks.values()):
        rows = [row[:-1] for row in rows]
    # Remarks quote what files say, and are not broken: no line begins with words of a file.
    tables = [fitted(rows), remarks, _levels_table(rechecks)]
    return "\n\n".join("\n".join(lines) for lines in tables if lines)


def _levels_table(rechecks: Mapping[str, Recheck]) -> list[str]:
    """What the levels mean that certificates have passed, up to the highest; nothing if none has."""
    highest = max((result.passed for result in rechecks.values()), default=Level.NONE)
    if highest is Level.NONE:
        return []
    rows = [("level", "what was checked", "how", "what remains to be believed")]
    for level in list(Level)[1 : highest + 1]:
        meaning = MEANINGS[level]
        rows.append((f"{level:d} {level.name.lower()}", meaning.checked, meaning.how, meaning.remains))
    return fitted(rows)


_SHOWN_FINDINGS = 5
