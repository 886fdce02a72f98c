"""From a candidate to its certificate, and checking a certificate again (sections 10 and 13)."""

from orbitproof.verify.certificate.certificate import (
    Certificate,
    Computation,
    digest,
    is_proof_of,
    read_certificates,
    repeated,
    write_certificates,
)
from orbitproof.verify.certificate.levels import (
    MEANINGS,
    REWORDED,
    CannotBeCheckedError,
    Examination,
    Finding,
    Level,
    Recheck,
    climb,
    confirmed,
    decimals,
    differences,
    not_checked,
    other_hypotheses,
    other_software,
    overlap,
    unknown_reason,
)
from orbitproof.verify.certificate.precision import GREATEST_PRECISION, LEAST_PRECISION, LEVELS, Limits
from orbitproof.verify.certificate.rechecking import (
    UNCHECKED_REASON,
    UNKNOWN,
    digest_findings,
    recheck,
)
from orbitproof.verify.certificate.side_by_side import certify_all, expected_work, recheck_all
from orbitproof.verify.certificate.stated_system import named_as, system_names, systems_with
from orbitproof.verify.certificate.tables import tables_from_json
from orbitproof.verify.certificate.verdicts import recheck_table, verdict_table

__all__ = [
    "GREATEST_PRECISION",
    "LEAST_PRECISION",
    "LEVELS",
    "MEANINGS",
    "REWORDED",
    "UNCHECKED_REASON",
    "UNKNOWN",
    "CannotBeCheckedError",
    "Certificate",
    "Computation",
    "Examination",
    "Finding",
    "Level",
    "Limits",
    "Recheck",
    "certify_all",
    "climb",
    "confirmed",
    "decimals",
    "differences",
    "digest",
    "digest_findings",
    "expected_work",
    "is_proof_of",
    "named_as",
    "not_checked",
    "other_hypotheses",
    "other_software",
    "overlap",
    "read_certificates",
    "recheck",
    "recheck_all",
    "recheck_table",
    "repeated",
    "system_names",
    "systems_with",
    "tables_from_json",
    "unknown_reason",
    "verdict_table",
    "write_certificates",
]
