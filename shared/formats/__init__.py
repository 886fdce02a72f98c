"""JSON formats: candidates and atlases, read, checked against their schema, and written."""

from orbitproof.shared.formats.atlas import SURFACE, Atlas, Claim, Covers, atlas_from_json, read_atlas, write_atlas
from orbitproof.shared.formats.candidates import (
    FOLD,
    KINDS,
    ONCE,
    Candidate,
    InputError,
    candidate_from_json,
    check_writable,
    read_candidates,
    read_document,
    read_system,
    validate_document,
    write_bytes,
    write_candidates,
    write_text,
)
from orbitproof.shared.formats.pieces import Piece, SurfacePiece, evaluate, is_regular, piece_from_json
from orbitproof.shared.formats.systems import load_system

__all__ = [
    "FOLD",
    "KINDS",
    "ONCE",
    "SURFACE",
    "Atlas",
    "Candidate",
    "Claim",
    "Covers",
    "InputError",
    "Piece",
    "SurfacePiece",
    "atlas_from_json",
    "candidate_from_json",
    "check_writable",
    "evaluate",
    "is_regular",
    "load_system",
    "piece_from_json",
    "read_atlas",
    "read_candidates",
    "read_document",
    "read_system",
    "validate_document",
    "write_atlas",
    "write_bytes",
    "write_candidates",
    "write_text",
]
