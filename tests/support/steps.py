"""Steps of second proofs, each made once: tests of what is concluded from the same orbit follow it together."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from typing import Any
from unittest import mock

from flint import arb
from support.once import exact

from orbitproof.verify.second_proof import crossing, flow, full_return, halves, legs, newton, periodic
from orbitproof.verify.second_proof.jets import Jet


@contextmanager
def made_once() -> Iterator[None]:
    """A step of the same field from the same jets, with the same bits, is not made again."""
    make, made = flow.take_step, dict[Any, Any]()

    def step(field: Any, state: Sequence[Jet], guess: arb, bits: int) -> Any:
        jets = tuple((jet.degree, *((a, *exact(c)) for a, c in jet.items())) for jet in state)
        key = repr(field), jets, exact(guess), bits
        if key not in made:
            made[key] = make(field, state, guess, bits)
        return made[key]

    with ExitStack() as patched:
        for module in (crossing, legs, halves, full_return):
            patched.enter_context(mock.patch.object(module, "take_step", step))
        yield


@contextmanager
def few_bits(known: int = 56) -> Iterator[None]:
    """Derivatives are known to fewer bits than those of users' proofs, where a test needs no more.

    Then discs are most of the work, and coarser ones, for steps that are a little shorter, take half as long.
    """
    discs = mock.patch.multiple(flow, SECTORS=8, STAGES=24, LEAST_STAGES=6)
    with mock.patch.object(newton, "KNOWN", known), mock.patch.object(periodic, "KNOWN", known), discs:
        yield
