"""Hundreds of claims made from true ones by chance: whatever is proved is true, and every proof encloses the truth.

What is true is decided without the verifier: the bifurcation points are known to fifty digits from the search
side, how they move with the mass parameter from one more refinement, whether the other point of an orbit
on Fix(R) is resonant from an independent integrator, and on which side of the bifurcation the new orbits are
from counting them there.
"""

from __future__ import annotations

import random
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from typing import Any

import pytest
from support.claims import (
    ACCURACY,
    EARTH_MOON,
    NAMES,
    SUN_JUPITER,
    coordinates_in_box,
    distances,
    known,
    shifted,
    verdict_of,
)
from support.flow_checks import initial_state, kernel_values, orbits
from support.new_orbits import side_of

from orbitproof.explore.refinement import refine
from orbitproof.shared.claims import KINDS, ONCE, Candidate
from orbitproof.shared.numbers import round_dyadic
from orbitproof.verify.attempt import Limits
from orbitproof.verify.certificate import Certificate, certify
from orbitproof.verify.claim import determinant
from orbitproof.verify.run.rows import certify_all

OTHER_POINT = "point on Fix(R)"
LIMITS = Limits(max_precision=224, timeout=30.0)
Point = tuple[Fraction, ...]


@dataclass(frozen=True)
class Trial:
    """A claim, what was done to the true one, and the bifurcation point that it may be about.

    Attributes:
        point: the true point of this system and mass, kind and k; `None` if there is none near by.
        accuracy: how well it is known.
        name: the row that the claim was made from.
    """

    change: str
    claim: Candidate
    point: Point | None
    accuracy: Fraction = ACCURACY
    name: str = ""

    @property
    def is_true(self) -> bool:
        """Whether frames are regular and the point lies in the box."""
        if self.point is None or not determinant(self.claim.frame) or not determinant(self.claim.kernel_frame):
            return False
        p = coordinates_in_box(self.claim, self.point)
        return all(abs(value) <= radius for value, radius in zip(p, self.claim.radii, strict=True))


def log_uniform(source: random.Random, low: int, high: int) -> Fraction:
    """A dyadic number of either sign with size between 2^low and 2^high."""
    size = round_dyadic(Fraction(1 + source.random()) * Fraction(2) ** source.randint(low, high - 1), 30)
    return size * source.choice((-1, 1))


def perturbed_centre(name: str, source: random.Random) -> Trial:
    claim = known(name)
    free = [j for j in range(len(claim.radii)) if claim.k > 1 or j != 1 or source.random() < 0.2]
    reach = source.choice((-1, 0, 4, 30))
    p = [radius * log_uniform(source, -8, reach) if j in free else Fraction(0) for j, radius in enumerate(claim.radii)]
    return Trial("centre", shifted(claim, tuple(p)), claim.centre)


def perturbed_matrix(source: random.Random, matrix: Sequence[Sequence[Fraction]], keep_first: bool) -> Any:
    """Entries changed a little or much, columns scaled, exchanged or made dependent; zeros often kept."""
    rows = [list(row) for row in matrix]
    size = len(rows)
    for i in range(int(keep_first and source.random() < 0.8), size):
        for j in range(size):
            if rows[i][j] or source.random() < 0.3:
                rows[i][j] += log_uniform(source, -200, -1) * (source.random() < 0.5)
    match source.randrange(6):
        case 0:
            i, j = source.randrange(size), source.randrange(size)
            for row in rows:
                row[i] = row[j]
        case 1:
            rows[0], rows[-1] = rows[-1], rows[0]
        case 2:
            factor = log_uniform(source, -60, 60)
            rows[-1] = [value * factor for value in rows[-1]]
    return tuple(tuple(round_dyadic(value, 400) for value in row) for row in rows)


def perturbed_frame(name: str, source: random.Random) -> Trial:
    claim = known(name)
    frame = perturbed_matrix(source, claim.frame, claim.is_family_of_maps)
    return Trial("frame", replace(claim, frame=frame), claim.centre)


def perturbed_kernel_frame(name: str, source: random.Random) -> Trial:
    claim = known(name)
    frame = perturbed_matrix(source, claim.kernel_frame, False)
    return Trial("kernel frame", replace(claim, kernel_frame=frame), claim.centre)


def perturbed_radii(name: str, source: random.Random) -> Trial:
    claim = known(name)
    spread = source.choice((1, 4, 20, 60))
    radii = tuple(radius * abs(log_uniform(source, -spread, spread)) for radius in claim.radii)
    return Trial("radii", replace(claim, radii=radii), claim.centre)


def relabelled(claim: Candidate, k: int, kind: str) -> Candidate:
    """Another multiplicity and kind, with the radii of a true claim like it."""
    model = {1: "em1", 2: "em2", 3: "em3", 4: "em4"} if claim.parameters else {2: "fs2", 3: "fs3", 4: "fs4", 5: "fs5"}
    radii = known(model[k]).radii if k in model else claim.radii
    return replace(claim, k=k, kind=kind, radii=radii)


def perturbed_multiplicity(name: str, source: random.Random) -> Trial:
    claim = known(name)
    k = source.choice([k for k in (2, 3, 4, 5, 6) if k != claim.k])
    return Trial("k", relabelled(claim, k, "touch_and_go" if k == 3 else "period_tupling"), None)


def perturbed_kind(name: str, source: random.Random) -> Trial:
    claim = known(name)
    kind = source.choice([kind for kind in KINDS if kind != claim.kind])
    k = 1 if kind in ONCE else source.choice((claim.k, claim.k, 3, 4)) if claim.k > 1 else 2
    same = kind == claim.kind and k == claim.k
    return Trial("kind", relabelled(claim, k, kind), claim.centre if same else None)


def perturbed_symmetry(name: str, source: random.Random) -> Trial:
    """The name of a symmetry matters for its breaking only."""
    claim = known(name)
    symmetry = None if claim.symmetry else source.choice([*claim.system.symmetries, None])
    return Trial("symmetry", replace(claim, symmetry=symmetry), None if claim.k == 1 else claim.centre)


@cache
def mass_sensitivity(name: str) -> Point:
    """Derivative of the bifurcation point in mu, to ten digits, from a refinement at another mass."""
    claim = known(name)
    change = Fraction(1, 2**80)
    guess = [float(value) for value in claim.centre]
    masses = {"mu": EARTH_MOON["mu"] + change}
    other = refine(claim.system, masses, claim.kind, claim.k, guess, digits=50, symmetry=claim.symmetry)
    return tuple((a - b) / change for a, b in zip(other.centre, claim.centre, strict=True))


def perturbed_mass(name: str, source: random.Random) -> Trial:
    claim = known(name)
    if source.random() < 0.2:
        return Trial("mass", replace(claim, parameters=SUN_JUPITER), None)
    change = log_uniform(source, -59, -58) if source.random() < 0.3 else log_uniform(source, -160, -20)
    parameters = {"mu": EARTH_MOON["mu"] + change}
    if abs(change) > Fraction(1, 2**70):
        # The point moves by about as much as the mass changes, which is far out of the box.
        return Trial("mass", replace(claim, parameters=parameters), None)
    moved = tuple(x + change * s for x, s in zip(claim.centre, mass_sensitivity(name), strict=True))
    accuracy = ACCURACY + abs(change) * Fraction(1, 10**10) + change * change * 10**8
    return Trial("mass", replace(claim, parameters=parameters), moved, accuracy)


def perturbed_system(name: str, source: random.Random) -> Trial:
    """The point of one bifurcation with everything else from another one of the same system."""
    claim = known(name)
    others = [other for other in NAMES if other[:2] == name[:2] and other != name]
    return Trial("point of another", replace(claim, centre=known(source.choice(others)).centre), None)


@cache
def other_symmetric_point(name: str) -> tuple[Point, Fraction, bool]:
    """P(x*) on Fix(R), the slope of the family there, and whether D_(p_1) pi_q P^k is singular (n = 1).

    From an independent integrator, with differences.
    """
    claim = known(name)
    flow = orbits(claim.system, 300)
    step = Fraction(1, 2**70)
    fixed = claim.system.fixed_coordinates[0]

    def images(start: Candidate, p: Point) -> tuple[Fraction, Fraction]:
        crossings = flow.crossings(*initial_state(start, p), claim.k)
        return crossings[0].state[fixed], kernel_values(start, crossings[-1].state)[0]

    zero = Fraction(0)
    left, middle, right = (images(claim, (p_0, zero))[0] for p_0 in (-step, zero, step))
    point = (claim.centre[0], round_dyadic(middle, 280))
    there = replace(claim, centre=point, frame=((Fraction(1), zero), (zero, Fraction(1))))
    up, down = (images(there, (zero, p_1))[1] for p_1 in (step, -step))
    slope = round_dyadic((right - left) / (2 * step), 100)
    return point, slope, abs(up - down) / (2 * step) < Fraction(1, 10**15)


@cache
def true_side(name: str, at_other_point: bool) -> str:
    """The side of the new orbits, which no small change moves; for even k those of the other point are other orbits."""
    claim = known(name)
    if at_other_point:
        point, slope, _ = other_symmetric_point(name)
        claim = replace(claim, centre=point, frame=(claim.frame[0], (slope, Fraction(1))))
    return side_of(claim)


def perturbed_symmetry_point(name: str, source: random.Random) -> Trial:
    claim = known(name)
    point, slope, resonant = other_symmetric_point(name)
    if source.random() < 0.3:
        slope += log_uniform(source, -40, -19)
    radii = tuple(radius * abs(log_uniform(source, -3, 3)) for radius in claim.radii)
    frame = (claim.frame[0], (slope, Fraction(1)))
    return Trial(OTHER_POINT, replace(claim, centre=point, frame=frame, radii=radii), point if resonant else None)


Perturbation = Callable[[str, random.Random], Trial]
EVERYWHERE: tuple[Perturbation, ...] = (
    perturbed_centre,
    perturbed_frame,
    perturbed_kernel_frame,
    perturbed_radii,
    perturbed_multiplicity,
    perturbed_kind,
    perturbed_system,
)
THREE_BODY = (*EVERYWHERE, perturbed_symmetry, perturbed_mass)
PLAN: tuple[tuple[str, tuple[Perturbation, ...], int], ...] = (
    ("fs2", (*EVERYWHERE, perturbed_symmetry_point), 12),
    ("fs3", (*EVERYWHERE, perturbed_symmetry_point), 10),
    ("fs4", (*EVERYWHERE, perturbed_symmetry_point), 6),
    ("fs5", EVERYWHERE, 2),
    ("em1", THREE_BODY, 10),
    ("em2", THREE_BODY, 2),
)
"""Row, perturbations, and the number of claims for each."""


def trials(seed: int) -> list[Trial]:
    """The claims of the campaign."""
    source = random.Random(seed)
    result = [(name, make(name, source)) for name, makers, count in PLAN for make in makers for _ in range(count)]
    return [
        replace(trial, name=name, claim=replace(trial.claim, id=f"{number} {trial.claim.id}"))
        for number, (name, trial) in enumerate(result)
    ]


def objection(trial: Trial, certificate: Certificate) -> str | None:
    """What is wrong with a verdict: a proof of something false, or enclosures that miss the truth."""
    if not certificate.proved:
        return None
    if not trial.is_true:
        return "proved, but the point is not in the box, or it is not such a point"
    assert trial.point is not None
    if max(distances(certificate, trial.point)) > trial.accuracy:
        return "proved, but its enclosures miss the bifurcation point"
    stated, side = certificate.side, true_side(trial.name, trial.change == OTHER_POINT)
    if stated != side:
        return f"proved, but the new orbits are stated {stated}, they are {side}"
    return None


def table(rows: Sequence[tuple[Trial, Certificate]]) -> str:
    """Outcomes by perturbation, with the conditions that stopped the false claims."""
    lines = [f"{'perturbation':18}{'claims':>7}{'proved':>8}{'true, not proved':>18}{'false, refused':>16}  refused by"]
    for change in dict.fromkeys(trial.change for trial, _ in rows):
        group = [(trial, verdict_of(certificate)) for trial, certificate in rows if trial.change == change]
        proved = sum(verdict == "proved" for _, verdict in group)
        missed = sum(verdict != "proved" and trial.is_true for trial, verdict in group)
        by = Counter(verdict for trial, verdict in group if verdict != "proved" and not trial.is_true)
        causes = ", ".join(f"{condition} {count}" for condition, count in by.most_common(6))
        lines.append(f"{change:18}{len(group):>7}{proved:>8}{missed:>18}{by.total():>16}  {causes}")
    return "\n".join(lines)


@pytest.mark.slow
def test_nothing_false_is_proved(capsys: pytest.CaptureFixture[str]) -> None:
    """Everything proved is still true, for one reason: the point, of that kind and k, has stayed in the regular box."""
    campaign = trials(20)
    certificates: dict[str, Certificate] = {}
    certify_all(
        [trial.claim for trial in campaign], LIMITS, 2, lambda *_: None,
        lambda certificate: certificates.update({certificate.id: certificate}),
    )  # fmt: skip
    rows = [(trial, certificates[trial.claim.id]) for trial in campaign]
    with capsys.disabled():
        print(f"\n{table(rows)}")
    wrong = [f"{trial.change}, {trial.claim.id}: {why}" for trial, c in rows if (why := objection(trial, c))]
    assert wrong == []
    assert not any(verdict_of(certificate) == "process" for _, certificate in rows)
    assert sum(not trial.is_true for trial, _ in rows) > 150
    assert sum(certificate.proved for _, certificate in rows) > 40


def test_the_campaign_would_notice_a_false_proof() -> None:
    """A proof beside a claim that it does not belong to or a point that it does not enclose, or with another side."""
    claim = known("fs2")
    certificate = certify(claim, LIMITS)
    true = Trial("none", claim, claim.centre, name="fs2")
    assert objection(true, certificate) is None
    for side in ("above", "both"):
        entry = certificate.to_json()
        entry["results"]["side"] = side
        assert "they are below" in str(objection(true, Certificate.from_json(entry)))
    away = tuple(Fraction(0) if j else 2 * claim.radii[0] for j in range(2))
    assert "not in the box" in str(objection(Trial("centre", shifted(claim, away), claim.centre), certificate))
    assert "not in the box" in str(objection(Trial("k", replace(claim, k=4), None), certificate))
    elsewhere = (claim.centre[0] + claim.radii[0] / 2, claim.centre[1])
    assert "miss" in str(objection(Trial("centre", claim, elsewhere), certificate))
