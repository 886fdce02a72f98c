"""The data folder of the pictures: which files it holds, and the command that makes each of them."""

from __future__ import annotations

import shlex
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Step:
    """A command that makes files of the data folder.

    Attributes:
        products: names of the files that it writes.
        command: its words after ``orbitproof``; a product or a need stands for its path in the folder.
        needs: files of the folder that it reads.
        cost: roughly how long it takes on two processors, in words.
    """

    products: tuple[str, ...]
    command: tuple[str, ...]
    cost: str
    needs: tuple[str, ...] = ()

    def words(self, folder: Path) -> list[str]:
        """The words after ``orbitproof`` for a data folder."""
        names = {*self.products, *self.needs}
        return [str(folder / word) if word in names else word for word in self.command]

    def text(self, folder: Path) -> str:
        """The command as one types it."""
        return f"orbitproof {shlex.join(self.words(folder))}"


def _step(products: str, command: str, cost: str, needs: str = "") -> Step:
    return Step(tuple(products.split()), tuple(command.split()), cost, tuple(needs.split()))


def _proofs() -> tuple[Step, ...]:
    """Whole branches: an atlas and its certificate each, which names the certified bifurcations on the branch."""
    steps: list[Step] = []
    for preset, bifurcations in (
        ("falkner-skan", "falkner-skan-*"),
        ("l1-circle-earth-moon", "earth-moon-L1-*"),
        ("l1-circle-sun-jupiter", "sun-jupiter-L1-*"),
        ("l2-arc-earth-moon", "earth-moon-L2-*"),
        ("l2-arc-sun-jupiter", "sun-jupiter-L2-*"),
    ):
        atlas, certificate = f"atlas-{preset}.json", f"branch-{preset}.json"
        steps.append(_step(atlas, f"explore atlas --preset {preset} -o {atlas}", "a minute"))
        command = (
            f"verify atlas {atlas} -o {certificate} --bifurcations certificates.json --only {bifurcations} --jobs 2"
        )
        steps.append(_step(certificate, command, "5 minutes", f"{atlas} certificates.json"))
    return tuple(steps)


STEPS: tuple[Step, ...] = (
    _step("portraits.json", "explore portraits -o portraits.json", "a few seconds"),
    _step(
        "lyapunov.json",
        "explore family --system cr3bp --mass sun-jupiter --family L1-lyapunov --jacobi-min 3.0 -o lyapunov.json",
        "a few seconds",
    ),
    _step(
        "l3-halo.json",
        "explore family --system cr3bp --mass earth-moon --family L3-halo --vy-max 40 -o l3-halo.json",
        "a few seconds",
    ),
    _step(
        "mass-curve.json",
        "explore mass-curve --extrema L2 --digits 30 -o mass-curve.json",
        "a minute",
    ),
    _step(
        "families.json candidates.json",
        "explore candidates --preset tables --folds --append -o candidates.json --family-output families.json",
        "10 minutes",
    ),
    # Into the candidates of the step before: its certificates come from one file.
    _step(
        "falkner-skan.json",
        "explore candidates --system falkner-skan -k 2 3 4 --beta-min 1.001 --beta-max 100000 --append "
        "-o candidates.json --family-output falkner-skan.json",
        "20 seconds",
        "candidates.json",
    ),
    _step(
        "certificates.json",
        "verify candidates.json -o certificates.json --jobs 2 --row-timeout 1200",
        "5 minutes",
        "candidates.json",
    ),
    _step("branches.json", "explore branches certificates.json -o branches.json", "3 minutes", "certificates.json"),
    *_proofs(),
)
"""In the order in which they are run: a step needs products of earlier ones only."""


def step_of(product: str) -> Step:
    """The step that makes a file; raises `KeyError` for a name that no step makes."""
    for step in STEPS:
        if product in step.products:
            return step
    raise KeyError(product)
