"""Certificates of atlases: what is proved of curves and surfaces in pieces, written down and checked again."""

from orbitproof.verify.atlas.catalogue import WITHIN, certified_rows, check_title
from orbitproof.verify.atlas.catalogue_table import certified_table, rows_of_curve
from orbitproof.verify.atlas.certificate import SCHEMA, Lines, atlas_of, make_atlas_certificate
from orbitproof.verify.atlas.conclusion import Watch, conclusion_of
from orbitproof.verify.atlas.index import certified_index, indexed_atlas
from orbitproof.verify.atlas.kinds import kind_of
from orbitproof.verify.atlas.places import Placed, places_on, recheck_place
from orbitproof.verify.atlas.recheck import Means, ProvedBefore, order_of
from orbitproof.verify.atlas.rests_on import RestingError, claiming_indices, resting
from orbitproof.verify.atlas.results import Result, Settings, condition_of, covers, results_from_json
from orbitproof.verify.atlas.web import StoredArc, StoredVertex, certified_web
