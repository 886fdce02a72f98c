"""Imported once by the process of which workers of the tests are copies: what each of them would make anew."""

from __future__ import annotations

import gc
from pathlib import Path

from orbitproof.shared.formats import read_candidates
from orbitproof.shared.formats.documents import validator
from orbitproof.verify.certificate import Limits, certify, recheck

claim = read_candidates(Path(__file__).parents[1] / "data" / "known-bifurcations.json")[0]
recheck(certify(claim, Limits(max_precision=64)))
for format in ("atlas", "atlas-certificate"):
    validator(format)
gc.freeze()
gc.set_threshold(200_000)
