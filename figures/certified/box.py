"""The certified curves of a certificate, family and branch, as thin boxes over their whole interval.

Evaluated in balls from the tables of derivatives that the certificate carries, by the functions of the verifier:
over each part of P_0 an enclosure of p_1(p_0), over each part of P_1 one of p_0(p_1) (sections 8.1 and 8.4). A fold has
one curve, p_0(p_1) (section 9.6).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from flint import arb

from orbitproof.figures.orbits import Array
from orbitproof.shared.codec import from_json
from orbitproof.shared.formats import Candidate, InputError, candidate_from_json, validate_document
from orbitproof.shared.systems import SYSTEMS
from orbitproof.verify.bifurcation import (
    BifurcationFunction,
    DoublySymmetricFamily,
    Family,
    Problem,
    check_curve,
    check_enclosures,
    check_family,
    check_fold,
    check_reduction,
    level_form,
    locate,
    reduced_function,
)
from orbitproof.verify.certificate import Computation, systems_with, tables_from_json
from orbitproof.verify.evidence import Checklist, NotEstablishedError, ball_from_json, enclose, guarded, meet
from orbitproof.verify.poincare import Enclosures


@dataclass(frozen=True)
class CertifiedCurves:
    """What a certificate says about its box, in units of the radii R_0 and R_1.

    Attributes:
        claim: the candidate, in the form that the hypotheses are about.
        radii: R_0 and R_1.
        family: shape (M, 4), lower and upper end of p_0/R_0, then of p_1/R_1, along the family.
        branch: shape (M, 4), the same along the branch; at a fold M = 0.
        point: shape (4,), of the bifurcation point.
        side: on which side the new orbits are, or the two of a fold.
        parameter_name: the bifurcation parameter.
        beta: enclosure of the leading coefficient of the parameter along the branch, or the curve of a fold, or `None`.
    """

    claim: Candidate
    radii: tuple[Fraction, Fraction]
    family: Array
    branch: Array
    point: Array
    side: str
    parameter_name: str
    beta: arb | None

    @classmethod
    def of(cls, certificate: Mapping[str, Any], where: str, parts: int = 40) -> CertifiedCurves:
        """The curves of a certificate that says "proved", each in `parts` boxes.

        Raises `InputError` if the certificate does not carry what it takes, or does not prove what it says.
        """
        entry, computation, results = certificate["enclosures"], certificate["computation"], certificate["results"]
        if certificate["verdict"] != "proved" or entry is None or results is None:
            raise InputError(f"{where}: not proved, so there are no certified curves; choose another certificate")
        stated = certificate["statement"]["candidate"]
        document = {"format": "orbitproof-candidates", "version": 1, "candidates": [stated]}
        validate_document(document, "candidates", f"{where}.statement.candidate")
        known = systems_with(SYSTEMS, certificate["statement"], stated)
        candidate = candidate_from_json(stated, f"{where}.statement.candidate", known)
        if candidate.is_of_orbit:
            raise InputError(f"{where}: orbit: no curve is certified there; choose another certificate")
        if candidate.looks_across or candidate.resonances_meet:
            raise InputError(f"{where}: {candidate.kind}: no curve is enclosed there; choose another certificate")
        claim = level_form(candidate) if "level_form" in certificate["statement"] else candidate
        try:
            if claim is None:
                raise ValueError("there is no such level form")
            stored = tables_from_json(entry, claim, from_json(Computation, computation, "computation"))
            assert isinstance(stored, Enclosures)
            with guarded(computation["precision"]):
                checklist = Checklist()
                problem = check_enclosures(
                    checklist, claim, stored.iterates, stored.first_integral, stored.return_times
                )
                family, branch, point = (_at_fold if claim.is_fold else _crossing)(checklist, problem, parts)
                beta = results["normal_form"].get("beta")
                return cls(
                    claim=claim,
                    radii=(claim.radii[0], claim.radii[1]),
                    family=family,
                    branch=branch,
                    point=np.array([*_ends(point[0], claim.radii[0]), *_ends(point[1], claim.radii[1])]),
                    side=results["side"],
                    parameter_name=results["parameter_name"],
                    beta=None if beta is None else ball_from_json(beta),
                )
        except (ValueError, NotEstablishedError, ArithmeticError) as error:
            raise InputError(f"{where}.enclosures: {error}; verify the candidate again") from None


def _crossing(checklist: Checklist, problem: Problem, parts: int) -> tuple[Array, Array, Sequence[arb]]:
    """Family, branch, and the point where they cross."""
    start = check_family(checklist, problem) if problem.k > 1 else None
    reduction = check_reduction(checklist, problem, start)
    family: Family = start if start is not None else DoublySymmetricFamily(reduction)
    point = locate(checklist, problem, family, reduction).where
    return _family(problem, family, parts), _branch(problem, family, reduction, parts), point


def _at_fold(checklist: Checklist, problem: Problem, parts: int) -> tuple[Array, Array, Sequence[arb]]:
    """The curve, as boxes around (p_0(p_1), p_1), no branch, and the point where it turns back."""
    point, _ = check_fold(checklist, problem)
    curve = check_curve(Checklist(), problem)
    rows = [
        [*_ends(meet(problem.box[0], curve.over(ball)[0]), problem.radii[0]), low, high]
        for low, high, ball in _pieces(problem.radii[1], parts)
    ]
    return np.array(rows), np.empty((0, 4)), point


def _family(problem: Problem, family: Family, parts: int) -> Array:
    """Boxes around (p_0, p_1(p_0))."""
    rows = []
    for low, high, ball in _pieces(problem.radii[0], parts):
        rows.append([low, high, *_ends(family.over(ball)[1], problem.radii[1])])
    return np.array(rows)


def _branch(problem: Problem, family: Family, reduction: BifurcationFunction, parts: int) -> Array:
    """Boxes around (p_0(p_1), p_1), from the reduced function of section 8.4."""
    p_0, p_1 = problem.box[:2]
    reduced = reduced_function(p_0, p_1, family, reduction)
    rows = []
    for low, high, ball in _pieces(problem.radii[1], parts):
        rows.append([*_ends(meet(p_0, reduced.zero(ball)), problem.radii[0]), low, high])
    return np.array(rows)


def _pieces(radius: Fraction, parts: int) -> list[tuple[float, float, arb]]:
    """[-radius, radius] in equal parts: ends in units of the radius, and a ball around each."""
    pieces = []
    for i in range(parts):
        low, high = Fraction(2 * i, parts) - 1, Fraction(2 * i + 2, parts) - 1
        pieces.append((float(low), float(high), enclose(low * radius).union(enclose(high * radius))))
    return pieces


def _ends(ball: arb, radius: Fraction) -> tuple[float, float]:
    """Ends of a ball in units of the radius, in double precision for drawing."""
    scaled = ball / enclose(radius)
    return float(scaled.lower()), float(scaled.upper())
