"""Certificates: statement, hypotheses, verdict and computation, as JSON (section 10)."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from textwrap import indent
from typing import Any

from orbitproof.shared.formats import Candidate, InputError, read_document, validate_document, write_text
from orbitproof.verify.bifurcation import level_form, theorem_of
from orbitproof.verify.certificate.tables import tables_to_json
from orbitproof.verify.claim import level_program, quadratic_coefficient
from orbitproof.verify.evidence import (
    Outcome,
    Proved,
    Theorem,
    ball_to_json,
    balls_to_json,
    hypothesis_to_json,
    software,
)
from orbitproof.verify.poincare import Enclosures

Certificate = dict[str, Any]
"""A JSON object that fits the definition ``certificate`` of shared/schemas/certificates.schema.json."""


def statement(candidate: Candidate, form: Candidate | None = None) -> dict[str, Any]:
    """The claim in full: the candidate without provenance, and the system that it is about.

    `form` is the candidate rewritten with the level of the first integral as parameter, if its box and
    coordinates are those that the hypotheses are about.
    """
    system = candidate.system
    integral = system.first_integral_program
    claim: dict[str, Any] = {
        "candidate": candidate.to_json(provenance=False),
        "vector_field": system.program.text(),
        "first_integral": None if integral is None else integral.text(),
        "reversing_symmetry": list(system.reversing_symmetry),
        "symmetry": None if candidate.symmetry is None else list(system.symmetries[candidate.symmetry]),
        "section": system.section,
    }
    if form is not None:
        claim["level_form"] = form.to_json(provenance=False)
    sign = (form or candidate).level_sign
    if sign is not None and quadratic_coefficient(system):
        claim["level_coordinate"] = level_program(system, sign).text()
    return claim


def make_certificate(
    candidate: Candidate,
    outcome: Outcome,
    computation: Mapping[str, Any],
    enclosures: Enclosures | None = None,
    form: Candidate | None = None,
) -> Certificate:
    """The certificate of one candidate; `computation` is the object of that name in the schema.

    `enclosures` are what the conditions were evaluated from, if it came to that; `form` as in `statement`.
    """
    claim = statement(candidate, form)
    hypotheses = [hypothesis_to_json(hypothesis) for hypothesis in outcome.hypotheses]
    verdict: dict[str, Any]
    if isinstance(outcome, Proved):
        results = outcome.results
        verdict = {
            "statement": {**claim, "theorem": outcome.theorem.statement},
            "verdict": "proved",
            "reason": None,
            "hypotheses": hypotheses,
            "results": {
                "point": balls_to_json(results.point),
                "parameter_name": results.parameter_name,
                "parameter": ball_to_json(results.parameter),
                "side": results.side,
                "normal_form": balls_to_json(results.normal_form),
            },
        }
    else:
        reason = outcome.reason
        verdict = {
            "statement": claim,
            "verdict": "not proved",
            "reason": {"condition": reason.condition, "message": reason.message, "remedy": reason.remedy},
            "hypotheses": hypotheses,
            "results": None,
        }
    certificate = {
        "id": candidate.id,
        **verdict,
        "enclosures": None if enclosures is None else tables_to_json(enclosures),
        "computation": dict(computation),
        "software": software(),
    }
    return {**certificate, "digest": digest(certificate)}


def digest(certificate: Mapping[str, Any]) -> str:
    """SHA-256 of the canonical JSON (sorted keys, no spaces, ASCII) of a certificate without its digest."""
    content = {key: value for key, value in certificate.items() if key != "digest"}
    text = json.dumps(content, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False)
    return f"sha256:{hashlib.sha256(text.encode()).hexdigest()}"


def is_proof_of(certificate: Mapping[str, Any], candidate: Candidate) -> bool:
    """Whether a stored certificate proves exactly this candidate, by exactly this software."""
    form = level_form(candidate) if "level_form" in certificate["statement"] else None
    theorem = theorem_of(form or candidate)
    return (
        isinstance(theorem, Theorem)
        and certificate["verdict"] == "proved"
        and certificate.get("digest") == digest(certificate)
        and certificate["statement"] == {**statement(candidate, form), "theorem": theorem.statement}
        and certificate.get("software") == software()
        and tuple(hypothesis["name"] for hypothesis in certificate["hypotheses"]) == theorem.hypotheses
        and all(hypothesis["holds"] is True for hypothesis in certificate["hypotheses"])
    )


def read_certificates(path: Path) -> dict[str, Certificate]:
    """The certificates of a file by candidate id. Raises `InputError` for anything else."""
    entries: Sequence[Certificate] = read_document(path, "certificates")["certificates"]
    result = {entry["id"]: entry for entry in entries}
    if len(result) != len(entries):
        raise InputError(f"{path}: field certificates: an id appears twice; write the file again with --fresh")
    return result


def write_certificates(path: Path, certificates: Iterable[Certificate]) -> None:
    """Write a certificates file, whole or not at all. Raises `InputError` if it cannot be written."""
    head = json.dumps(_document([]), indent=1).removesuffix("[]\n}")
    entries = ",\n".join(_text(certificate) for certificate in certificates)
    write_text(path, f"{head}[\n{entries}\n ]\n}}\n" if entries else f"{head}[]\n}}\n")


def _document(certificates: Sequence[Certificate]) -> dict[str, Any]:
    return {
        "format": "orbitproof-certificates",
        "version": 1,
        "software": software(),
        "certificates": list(certificates),
    }


_texts: dict[str, str] = {}
"""What was validated and written before, by content: a run writes its file again for every row."""


def _text(certificate: Certificate) -> str:
    key = f"{digest(certificate)} {certificate.get('digest')}"
    if key not in _texts:
        validate_document(_document([certificate]), "certificates", "certificates to be written")
        _texts[key] = indent(json.dumps(certificate, indent=1, allow_nan=False), "  ")
    return _texts[key]
