"""How linearised functions stand in certificates of periodic orbits and of their bifurcations (section 10.2)."""

from __future__ import annotations

from typing import Annotated

from orbitproof.shared.stored import rules
from orbitproof.verify.certificate.stored_balls import register
from orbitproof.verify.certificate.tables import ball_from_text, ball_to_text
from orbitproof.verify.evidence import Briefs
from orbitproof.verify.periodic import Linearised


def _to_json(function: Linearised) -> list[str]:
    return [ball_to_text(ball) for ball in function.balls]


def _from_json(texts: list[str]) -> Linearised:
    centre, *slopes = map(ball_from_text, texts)
    return Linearised(centre, tuple(slopes))


register(Linearised, _to_json, _from_json, Annotated[Briefs, rules(minItems=2)])
