"""From a candidate to its certificate, and checking a certificate again (sections 10 and 13)."""

from orbitproof.verify.attempt.precision import LEVELS, Limits
from orbitproof.verify.certificate.certificate import (
    Certificate,
    digest,
    is_proof_of,
    make_certificate,
    repeated,
    schema_of,
    sealed,
)
from orbitproof.verify.certificate.certifying import Integrator, certify, not_proved
from orbitproof.verify.certificate.document import Computation
from orbitproof.verify.certificate.earlier import taken_names
from orbitproof.verify.certificate.files import (
    ROWS,
    SCHEMAS,
    read_any,
    read_certificate,
    read_certificates,
    write_certificate,
    write_certificates,
)
from orbitproof.verify.certificate.kind import Given, Key, Kind
from orbitproof.verify.certificate.kinds import contradictions, numbers, tables_from_json, tables_to_json
from orbitproof.verify.certificate.levels import (
    MEANINGS,
    REWORDED,
    CannotBeCheckedError,
    Examination,
    Finding,
    Level,
    NothingToCheckError,
    Recheck,
    climb,
    confirmed,
    decimals,
    differences,
    in_all_data,
    not_checked,
    other_hypotheses,
    other_software,
    overlap,
    unknown_reason,
)
from orbitproof.verify.certificate.own_box import broken_off
from orbitproof.verify.certificate.rechecking import (
    NOT_INTEGRATED,
    UNCHECKED_REASON,
    UNKNOWN,
    digest_findings,
    recheck,
)
from orbitproof.verify.certificate.stated_system import named_as, stated, stated_functions, systems_with
