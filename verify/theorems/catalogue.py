"""Rows of a catalogue, certified by the proved curve that they lie near (section 32.4)."""

from __future__ import annotations

from orbitproof.verify.branches import catalogue
from orbitproof.verify.branches.its_curve import its_curve
from orbitproof.verify.certificate.kind import Kind
from orbitproof.verify.certificate.kinds import CATALOGUE

KIND = Kind(
    names=(CATALOGUE,),
    schema=catalogue.SCHEMA,
    part=CATALOGUE,
    titles={CATALOGUE: "Rows of a catalogue as orbits of a curve"},
    said=lambda k, kind: "rows of a catalogue",
    levels=(catalogue.form, catalogue.conclusion, catalogue.integration),
    rests_on=its_curve,
    more=catalogue.SAID,
    extent=catalogue.certified_of,
    one_a_line=(("rows",),),
)
