"""JSON formats: candidates and atlases, read, checked against their schema, and written."""

from orbitproof.shared.formats.atlas import SURFACE, Atlas, Claim, Covers, atlas_from_json, read_atlas, write_atlas
from orbitproof.shared.formats.candidates import (
    COORDINATE,
    FOLD,
    HALF_PERIOD,
    KINDS,
    LEVEL,
    ONCE,
    ORBIT,
    QUANTITIES,
    Candidate,
    Equation,
    candidate_from_json,
    read_candidates,
    read_system,
    write_candidates,
)
from orbitproof.shared.formats.documents import (
    InputError,
    check_writable,
    read_document,
    stated_format,
    validate_document,
    write_bytes,
    write_text,
)
from orbitproof.shared.formats.pieces import (
    AnyPiece,
    LibrationPiece,
    Piece,
    SurfacePiece,
    evaluate,
    is_regular,
    piece_from_json,
)
from orbitproof.shared.formats.selection import select_ids
from orbitproof.shared.formats.systems import load_system
