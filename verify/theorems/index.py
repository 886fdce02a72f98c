"""The Conley-Zehnder index along a proved curve (section 35)."""

from __future__ import annotations

from orbitproof.verify.branches import index
from orbitproof.verify.branches.its_curve import its_curve
from orbitproof.verify.certificate.kind import Kind
from orbitproof.verify.certificate.kinds import INDEX

KIND = Kind(
    names=(INDEX,),
    schema=index.SCHEMA,
    part=INDEX,
    titles={INDEX: "The index of orbits of a curve"},
    said=lambda k, kind: "index along a curve",
    levels=(index.form, index.conclusion, index.integration),
    called="of the index of {}",
    rests_on=its_curve,
    more=index.SAID,
    extent=index.extent_of,
    one_a_line=(("orbits",),),
)
