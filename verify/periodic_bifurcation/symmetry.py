"""A symmetry of the vector field that a claim names, and where it takes the point (sections 25.1 and 25.6)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import arb

from orbitproof.shared.formats import PeriodicBifurcation
from orbitproof.verify.claim import respects
from orbitproof.verify.evidence import Checklist, dot, enclose, excludes_zero
from orbitproof.verify.periodic import section_coordinates
from orbitproof.verify.periodic_bifurcation.extended_system import BifurcationPoint


def check_symmetry(checklist: Checklist, claim: PeriodicBifurcation) -> None:
    """S is an involution that the vector field, the first integral and the section are respected by (section 25.1)."""
    statement = "S S = 1, normal . S = normal, f(S x) = S f(x) identically, and H(S x) = H(x) if H is used"
    remedy = (
        "correct the matrix of the symmetry; a symmetry may be true and not be recognised: write divisors and roots of "
        "f and H so that S takes each to one that is there too"
    )
    with checklist.hypothesis("symmetry", "25.1", statement, remedy) as evidence:
        rows = claim.symmetry
        evidence.require(rows is not None, "the claim names no symmetry")
        if rows is None:
            return
        size = range(len(rows))
        squared = [[_product(row, column) for column in zip(*rows, strict=True)] for row in rows]
        evidence.require(squared == [[int(i == j) for j in size] for i in size], "S S is not 1")
        moved = [_product(claim.normal, column) for column in zip(*rows, strict=True)]
        evidence.require(moved == list(claim.normal), "S does not map the section to itself in its direction")
        field, integral = respects(claim.system, rows, with_integral=claim.level is not None)
        evidence.require(field, "f(S x) = S f(x) was not shown")
        evidence.require(integral, "H(S x) = H(x) was not shown")


def check_mirrored(checklist: Checklist, claim: PeriodicBifurcation, place: BifurcationPoint) -> bool:
    """S fixes the point and turns its eigenvector round, or moves the point; whether it fixes it (section 25.6)."""
    signs = signs_on_box(claim)
    if signs is None:
        statement, remedy = "S moves the point", "give a centre and a frame that S maps to themselves, or smaller radii"
    else:
        statement = "S maps the box to itself and turns the eigenvector round: the point is in Fix(S)"
        remedy = "claim a doubling, of orbits in Fix(S), or without the symmetry"
    with checklist.hypothesis("mirrored", "25.6", statement, remedy) as evidence:
        if signs is None:
            for position, (image, ball) in enumerate(zip(_image_of(claim, place), place.where, strict=False)):
                evidence.record(f"p_{position} of S x - x", image - ball)
            apart = map(excludes_zero, evidence.enclosures.values())
            message = "S may fix the point, and does not map the box to itself"
            evidence.require(any(apart), message, needs_precision=True)
        else:
            turned = [sign == -1 and excludes_zero(ball) for sign, ball in zip(signs, place.kernel, strict=True)]
            evidence.require(any(turned), "S may leave the eigenvector alone")
    return signs is not None


def signs_on_box(claim: PeriodicBifurcation) -> tuple[int, ...] | None:
    """The signs by which S acts on p, if it maps the centre and each column of the frame, up to its sign, to itself."""
    rows = claim.symmetry
    if rows is None or _image(rows, claim.centre) != claim.centre:
        return None
    signs = []
    for column in zip(*claim.frame, strict=True):
        image = _image(rows, column)
        if image not in (column, tuple(-value for value in column)):
            return None
        signs.append(1 if image == column else -1)
    return tuple(signs)


def _image(rows: Sequence[Sequence[Fraction]], vector: Sequence[Fraction]) -> tuple[Fraction, ...]:
    return tuple(_product(row, vector) for row in rows)


def _product(left: Sequence[Fraction], right: Sequence[Fraction]) -> Fraction:
    return sum((a * b for a, b in zip(left, right, strict=True)), Fraction(0))


def _image_of(claim: PeriodicBifurcation, place: BifurcationPoint) -> list[arb]:
    """The coordinates p of S x."""
    coordinates = section_coordinates(claim)
    assert claim.symmetry is not None
    assert coordinates is not None
    p = place.where[:-1]
    columns = list(zip(*claim.frame, strict=True))
    offsets = [a - b for a, b in zip(_image(claim.symmetry, claim.centre), claim.centre, strict=True)]
    moved = [_image(claim.symmetry, column) for column in columns]
    differences = [
        enclose(offset) + dot([enclose(column[i]) for column in moved], p) for i, offset in enumerate(offsets)
    ]  # fmt: skip
    return coordinates.of(differences)
