"""From a candidate to its certificate, and checking a certificate again (sections 10 and 13)."""

from orbitproof.verify.certificate.certificate import (
    Certificate,
    Computation,
    digest,
    is_proof_of,
    read_certificates,
    write_certificates,
)
from orbitproof.verify.certificate.certify import (
    GREATEST_PRECISION,
    LEAST_PRECISION,
    LEVELS,
    Limits,
)
from orbitproof.verify.certificate.rechecking import Recheck, recheck
from orbitproof.verify.certificate.side_by_side import certify_all, recheck_all
from orbitproof.verify.certificate.tables import tables_from_json
from orbitproof.verify.certificate.verdicts import recheck_table, verdict_table

__all__ = [
    "GREATEST_PRECISION",
    "LEAST_PRECISION",
    "LEVELS",
    "Certificate",
    "Computation",
    "Limits",
    "Recheck",
    "certify_all",
    "digest",
    "is_proof_of",
    "read_certificates",
    "recheck",
    "recheck_all",
    "recheck_table",
    "tables_from_json",
    "verdict_table",
    "write_certificates",
]
