"""Whether a new integration confirms stored functions (section 29.4)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import fields

from flint import ctx

from orbitproof.verify.evidence import NotKnown
from orbitproof.verify.functions import StoredFunction
from orbitproof.verify.lasting.stored import TwistFunctions
from orbitproof.verify.stability import PRECISION

Known = TwistFunctions | NotKnown | None


def unconfirmed_twist(stored: Known, fresh: Known) -> Iterator[str]:
    """What is stored of the twist on an interval and is not contained in what a new integration finds, in words."""
    if not isinstance(stored, TwistFunctions):
        return
    if not isinstance(fresh, TwistFunctions):
        why = "it is missing" if fresh is None else fresh.reason.message
        yield f"the twist is not enclosed again: {why}"
        return
    if stored.odd is not fresh.odd:
        yield "that a symmetry fixes the orbits of an interval, or none, is not confirmed"
        return
    with ctx.workprec(PRECISION):
        for field in fields(TwistFunctions):
            old, new = (getattr(each, field.name) for each in (stored, fresh))
            if isinstance(old, StoredFunction) and not old.enclosed.contains(new.enclosed.as_found):
                yield f"the stored bounds of the function {field.name} of the twist are not confirmed"
