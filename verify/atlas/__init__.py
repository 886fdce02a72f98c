"""Proving an atlas: ``orbitproof verify atlas``."""

from orbitproof.verify.atlas.certificate import SCHEMA, AtlasCertificate, read_atlas_certificate
from orbitproof.verify.atlas.conclusion import conclusion_of
from orbitproof.verify.atlas.places import check_of_conclusion, places_on, recheck_places
from orbitproof.verify.atlas.recheck import Means, atlas_of, order_of, recheck_atlas

__all__ = [
    "SCHEMA",
    "AtlasCertificate",
    "Means",
    "atlas_of",
    "check_of_conclusion",
    "conclusion_of",
    "order_of",
    "places_on",
    "read_atlas_certificate",
    "recheck_atlas",
    "recheck_places",
]
