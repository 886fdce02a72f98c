"""Certificates of curves and surfaces, proved in pieces, and of what rests on them, written down and checked again."""

from orbitproof.verify.branches.catalogue import WITHIN, certified_rows, check_title
from orbitproof.verify.branches.catalogue_table import certified_table, rows_of_curve
from orbitproof.verify.branches.certificate import SCHEMA, Lines, atlas_of, make_atlas_certificate
from orbitproof.verify.branches.conclusion import Watch, conclusion_of
from orbitproof.verify.branches.index import certified_index, indexed_atlas
from orbitproof.verify.branches.kinds import kind_of
from orbitproof.verify.branches.places import Placed, places_on, recheck_place
from orbitproof.verify.branches.recheck import Means, ProvedBefore, order_of
from orbitproof.verify.branches.rests_on import RestingError, claiming_indices, resting
from orbitproof.verify.branches.results import Result, Settings, condition_of, covers, results_from_json
from orbitproof.verify.branches.web import StoredArc, StoredVertex, certified_web
