"""Proving an atlas: ``orbitproof verify atlas``."""

from orbitproof.verify.atlas.certificate import AtlasCertificate, read_atlas_certificate

__all__ = [
    "AtlasCertificate",
    "read_atlas_certificate",
]
