"""JSON formats: claims and other documents, read, checked against their schema, and written."""

from orbitproof.shared.arguments import ArgumentError, about, as_options, refused
from orbitproof.shared.claims import (
    ACROSS_KINDS,
    COORDINATE,
    DOUBLE_RESONANCE,
    EQUILIBRIUM,
    EQUILIBRIUM_CURVES,
    FOLD,
    HALF_PERIOD,
    HOPF,
    INVARIANT_TORI,
    KINDS,
    KREIN_COLLISION,
    LEADING_POWERS,
    LEVEL,
    ONCE,
    ORBIT,
    ORBIT_KINDS,
    PERIODIC,
    PERIODIC_BIFURCATIONS,
    PERIODIC_CURVES,
    PERIODIC_DOUBLING,
    PERIODIC_FOLD,
    PERIODIC_PITCHFORK,
    PERIODIC_TORUS,
    QUANTITIES,
    REVERSOR_BREAKING,
    STABLE_ORBIT,
    SURFACE,
    AnyAtlas,
    AnyPiece,
    Atlas,
    BirthPiece,
    BoxClaim,
    Candidate,
    Claim,
    Covers,
    Equation,
    Equilibrium,
    EquilibriumAtlas,
    EquilibriumCurveClaim,
    HopfPoint,
    InSection,
    LibrationPiece,
    PeriodicAtlas,
    PeriodicBifurcation,
    PeriodicCurveClaim,
    PeriodicOrbit,
    Piece,
    SurfacePiece,
    WithoutReversor,
    evaluate,
    is_regular,
)
from orbitproof.shared.errors import InputError
from orbitproof.shared.formats.atlas import atlas_from_json, atlas_to_json, read_atlas, write_atlas
from orbitproof.shared.formats.candidates import (
    candidate_from_json,
    candidate_to_json,
    claim_from_json,
    read_candidates,
    read_claims,
    read_system,
    write_candidates,
)
from orbitproof.shared.formats.catalogue import FIELDS, HEADER, MASS_RATIO, CatalogueRows, read_catalogue_rows
from orbitproof.shared.formats.catalogue_table import FORMS, CatalogueTable, decimal_text, table_form
from orbitproof.shared.formats.documents import (
    json_text,
    read_document,
    stated_format,
    validate_document,
    write_document,
)
from orbitproof.shared.formats.periodic_curve import (
    atlas_without_symmetry,
    curve_claim_from_json,
    system_without_symmetry,
)
from orbitproof.shared.formats.pieces import periodic_piece_from_json, piece_from_json
from orbitproof.shared.formats.selection import select_ids
from orbitproof.shared.formats.systems import define_system, load_system, under_reversor
from orbitproof.shared.output import check_writable, write_bytes, write_text
