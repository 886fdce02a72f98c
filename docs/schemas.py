"""Write the schemas of all formats whose values are read by `shared.codec`, from the types that describe them.

python docs/schemas.py
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Annotated, Any

from orbitproof.explore.periodic import LifeRecord, PeriodicFamilyRecord
from orbitproof.shared.claims import BoxClaim, StoredAtlas
from orbitproof.shared.claims.life import Life
from orbitproof.shared.claims.web import Web
from orbitproof.shared.formats.schemas import document_schema, schema_text
from orbitproof.shared.stored import rules
from orbitproof.verify.branches.catalogue import CatalogueDocument
from orbitproof.verify.branches.document import BranchDocument
from orbitproof.verify.branches.index import IndexDocument
from orbitproof.verify.branches.life import LifeDocument
from orbitproof.verify.branches.web import WebDocument
from orbitproof.verify.certificate.document import Software
from orbitproof.verify.certificate.entry import StoredCertificate

COORDINATES = (
    "the family parameter of the system, if it has one, then the state coordinates fixed by R, in the system's order."
)


@dataclass(frozen=True)
class Candidates:
    candidates: Annotated[tuple[BoxClaim, ...], rules(minItems=1, maxItems=100000)]


@dataclass(frozen=True)
class Certificates:
    """A file of certificates of candidates.

    Attributes:
        software: names and versions of what last wrote the file: orbitproof, python, python-flint, FLINT, numpy.
    """

    software: Software
    certificates: Annotated[tuple[StoredCertificate, ...], rules(minItems=1)]


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas by the names of their formats."""
    words = {
        "candidates": "Boxes that are claimed to contain a bifurcation of symmetric periodic orbits, or one orbit. "
        f"Coordinates: {COORDINATES[:-1]}; of a periodic orbit without symmetry the state coordinates.",
        "certificates": "What was claimed, every hypothesis with its enclosure, and the verdict.",
        "atlas": "A curve of symmetric periodic orbits, or a surface of them over the mass parameter, as pieces in "
        f"order along it; or a curve of periodic orbits without symmetry. Coordinates of a point: {COORDINATES[:-1]}; "
        "of a curve without symmetry the parameter that varies, if there is one, then the state coordinates but for "
        "that which follows from the others on the section.",
        "atlas-certificate": "What was claimed of a curve or surface, what is proved on each interval of each piece, "
        "and what follows.",
        "catalogue-certificate": "Rows of a catalogue, and what a proved curve says of the orbits that start near "
        "them, in the units of the CR3BP.",
        "web": "Which proved curves of periodic orbits meet which certified orbits, and how, as it is claimed.",
        "web-certificate": "A graph of proved curves of periodic orbits that meet in certified ones.",
        "life-claim": "Which proved curves of equilibria and of periodic orbits are joined, and how, as it is claimed.",
        "life-certificate": "A graph of proved curves of equilibria and of the periodic orbits that are born on them.",
        "index-certificate": "The Conley-Zehnder index of the orbits of a proved curve.",
        "periodic-family": "A family of periodic orbits without symmetry in a parameter, or over the levels of a first "
        "integral, from double precision, in the units of its system. Nothing is proved.",
        "life": "A curve of equilibria in a parameter, and the families of periodic orbits that are born on it, from "
        "double precision, in the units of its system. Nothing is proved.",
    }
    kinds = (
        *(Candidates, Certificates, StoredAtlas, BranchDocument, CatalogueDocument),
        *(Web, WebDocument, Life, LifeDocument, IndexDocument, PeriodicFamilyRecord, LifeRecord),
    )
    return {
        # The parameters of a surface stand in its pieces.
        name: document_schema(name, words[name], kind, ["parameters"] if kind is StoredAtlas else [])
        for name, kind in zip(words, kinds, strict=True)
    }


if __name__ == "__main__":
    folder = Path(str(resources.files("orbitproof.shared").joinpath("schemas")))
    for name, schema in schemas().items():
        folder.joinpath(f"{name}.schema.json").write_text(schema_text(schema), "utf-8")
