"""Tables of verdicts, for stdout."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from orbitproof.shared.formats import Candidate
from orbitproof.verify.certificate.certificate import Certificate
from orbitproof.verify.certificate.rechecking import Recheck
from orbitproof.verify.engines import aligned
from orbitproof.verify.evidence import certain_digits

_SHOWN_DIGITS = 34
_HEADERS = ("candidate", "k", "kind", "verdict", "side", "parameter", "time")


def verdict_table(
    candidates: Sequence[Candidate], certificates: Mapping[str, Certificate], kept: frozenset[str] = frozenset()
) -> str:
    """The verdicts in the order of the candidates, as plain text; then why what is not proved is not.

    `kept` names the rows that an earlier run proved.
    """
    rows = [_HEADERS]
    reasons = []
    for candidate in candidates:
        certificate = certificates.get(candidate.id)
        if certificate is None:
            rows.append((candidate.id, str(candidate.k), candidate.kind, "not finished", "", "", ""))
            continue
        parameter = ""
        if certificate.parameter is not None:
            parameter = f"{certificate.parameter_name} = {certain_digits(certificate.parameter, _SHOWN_DIGITS)}"
        elapsed = "kept" if candidate.id in kept else f"{certificate.computation.seconds:.1f} s"
        name, side = certificate.id, certificate.side or ""
        rows.append((name, str(candidate.k), candidate.kind, certificate.verdict, side, parameter, elapsed))
        reason = certificate.reason
        if reason is not None:
            reasons.append(f"{candidate.id}: not proved, {reason.condition}: {reason.message}; {reason.remedy}")
    return "\n".join([*aligned(rows), *([""] if reasons else []), *reasons])


def recheck_table(names: Sequence[str], rechecks: Mapping[str, Recheck]) -> str:
    """What checking certificates again has shown, as plain text; then every finding, or the first ones."""
    rows = [("certificate", "verdict", "check", "hypotheses", "integrated again")]
    findings = []
    for name in names:
        result = rechecks.get(name)
        if result is None:
            rows.append((name, "", "not finished", "", ""))
            continue
        integrated = f"{result.precision} bits" if result.precision else "no"
        word = "stands" if result.stands else "DOES NOT STAND"
        rows.append((name, result.verdict, word, str(result.hypotheses), integrated))
        findings += [f"{name}: {entry.place}: {entry.message}" for entry in result.findings[:_SHOWN_FINDINGS]]
        further = len(result.findings) - _SHOWN_FINDINGS
        findings += [f"{name}: and {further} more"] if further > 0 else []
    return "\n".join([*aligned(rows), *([""] if findings else []), *findings])


_SHOWN_FINDINGS = 5
