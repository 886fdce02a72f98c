"""Proving an atlas: ``orbitproof verify atlas``."""

from orbitproof.verify.atlas.apart import conclusion_apart, places_on_apart, recheck_places_apart
from orbitproof.verify.atlas.certificate import SCHEMA, AtlasCertificate, read_atlas_certificate
from orbitproof.verify.atlas.conclusion import conclusion_of
from orbitproof.verify.atlas.places import check_of_conclusion, places_on, recheck_places
from orbitproof.verify.atlas.recheck import Means, atlas_of, order_of, recheck_atlas
