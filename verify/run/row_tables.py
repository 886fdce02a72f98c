"""Tables of verdicts, for stdout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from orbitproof.shared.formats import BoxClaim, as_options
from orbitproof.shared.systems import shown
from orbitproof.verify.certificate import MEANINGS, Certificate, Level, Recheck
from orbitproof.verify.evidence import certain_digits
from orbitproof.verify.run import aligned
from orbitproof.verify.run.other_boxes import remark

_SHOWN_DIGITS = 34
_HEADERS = ("candidate", "k", "kind", "verdict", "side", "parameter", "time")


def verdict_table(
    candidates: Sequence[BoxClaim], certificates: Mapping[str, Certificate], kept: frozenset[str] = frozenset()
) -> str:
    """The verdicts in the order of the candidates, as plain text; then which boxes are others than
    were given, and why what is not proved is not.

    `kept` names the rows that an earlier run proved.
    """
    rows = [_HEADERS]
    reasons = []
    for candidate in candidates:
        certificate = certificates.get(candidate.id)
        if certificate is None:
            rows.append((shown(candidate.id), str(candidate.k), candidate.kind, "not finished", "", "", ""))
            continue
        parameter = ""
        if certificate.parameter is not None:
            parameter = f"{certificate.parameter_name} = {certain_digits(certificate.parameter, _SHOWN_DIGITS)}"
        elapsed = "kept" if candidate.id in kept else f"{certificate.computation.seconds:.1f} s"
        name, side = shown(certificate.id), certificate.side or ""
        rows.append((name, str(candidate.k), candidate.kind, certificate.verdict, side, parameter, elapsed))
        about_the_box = remark(certificate)
        if about_the_box is not None:
            reasons.append(f"{name}: {about_the_box}")
        reason = certificate.reason
        if reason is not None:
            remedy = as_options(reason.remedy, timeout="--row-timeout")
            reasons.append(f"{name}: not proved, {reason.condition}: {reason.message}; {remedy}")
    return "\n".join([*aligned(rows), *([""] if reasons else []), *reasons])


def recheck_table(names: Sequence[str], rechecks: Mapping[str, Recheck]) -> str:
    """What checking certificates again has shown, as plain text; then every finding, or the first ones.

    Last, for the levels that were climbed, what was checked, how, and what remains to be believed.
    """
    rows = [("certificate", "verdict", "check", "level passed", "hypotheses", "integrated again")]
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
    tables = [aligned(rows), remarks, _levels_table(rechecks)]
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
    return aligned(rows)


_SHOWN_FINDINGS = 5
