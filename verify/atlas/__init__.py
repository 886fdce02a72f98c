"""Certificates of atlases: what is proved of curves and surfaces in pieces, written down and checked again."""

from orbitproof.verify.atlas.catalogue import (
    WITHIN,
    CatalogueCertificate,
    certified_rows,
    check_title,
    read_catalogue_certificate,
    recheck_catalogue,
    write_catalogue_certificate,
)
from orbitproof.verify.atlas.catalogue_table import certified_table, rows_of_curve
from orbitproof.verify.atlas.certificate import (
    SCHEMA,
    AtlasCertificate,
    Lines,
    make_atlas_certificate,
    read_atlas_certificate,
    write_atlas_certificate,
)
from orbitproof.verify.atlas.conclusion import Watch, conclusion_of
from orbitproof.verify.atlas.index import (
    IndexCertificate,
    certified_index,
    checked_index,
    indexed_atlas,
    read_index_certificate,
    write_index_certificate,
)
from orbitproof.verify.atlas.kinds import kind_of
from orbitproof.verify.atlas.places import Placed, check_of_conclusion, places_on, recheck_place
from orbitproof.verify.atlas.recheck import Means, ProvedBefore, atlas_of, order_of, recheck_atlas
from orbitproof.verify.atlas.rests_on import Key, Resting, RestingError, claiming_indices, key_of, resting
from orbitproof.verify.atlas.results import Result, Settings, condition_of, covers, results_from_json
from orbitproof.verify.atlas.sealed import Sealed
from orbitproof.verify.atlas.web import (
    StoredArc,
    StoredVertex,
    WebCertificate,
    certified_web,
    read_web_certificate,
    recheck_web,
    write_web_certificate,
)
