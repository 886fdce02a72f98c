"""Exact checks of the coordinates of a candidate (section 7.1)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from flint import fmpq, fmpq_mat

from orbitproof.shared.formats import Candidate
from orbitproof.verify.claim.symmetry import signs_on
from orbitproof.verify.evidence import Checklist

_ADAPT = "write the candidate with frames adapted to the symmetry (p_1 and q_1 odd, the others even)"


def determinant(matrix: Sequence[Sequence[Fraction]]) -> Fraction:
    """Exact determinant."""
    return _fraction(_rational(matrix).det())


def inverse(matrix: Sequence[Sequence[Fraction]]) -> list[list[Fraction]] | None:
    """Exact inverse; `None` if the matrix is singular."""
    rows = _rational(matrix)
    return [[_fraction(value) for value in row] for row in rows.inv().tolist()] if rows.det() else None


def _rational(matrix: Sequence[Sequence[Fraction]]) -> fmpq_mat:
    return fmpq_mat([[fmpq(value.numerator, value.denominator) for value in row] for row in matrix])


def _fraction(value: fmpq) -> Fraction:
    return Fraction(int(value.p), int(value.q))


def is_adapted(matrix: Sequence[Sequence[Fraction]], signs: Sequence[int], odd: int) -> bool:
    """Whether a symmetry that acts on the rows by `signs` negates column `odd` and fixes the others, exactly."""
    return all(
        value == 0
        for row, sign in zip(matrix, signs, strict=True)
        for column, value in enumerate(row)
        if sign != (-1 if column == odd else 1)
    )


def check_frames(checklist: Checklist, candidate: Candidate) -> None:
    """Both frames are regular; with a family parameter, p_0 is the parameter minus its centre."""
    with checklist.hypothesis(
        "frames", "7.1", "the frames of p and q are regular matrices", "choose linearly independent directions"
    ) as evidence:
        evidence.require(determinant(candidate.frame) != 0, "the determinant of frame is 0")
        evidence.require(determinant(candidate.kernel_frame) != 0, "the determinant of kernel_frame is 0")
        if candidate.is_family_of_maps:
            row = candidate.frame[0]
            evidence.require(
                row[0] == 1 and not any(row[1:]),
                f"row 0 of frame has to be (1, 0, .., 0), so that p_0 is {candidate.titles[0]}",
            )


def check_adapted_frames(checklist: Checklist, candidate: Candidate) -> None:
    """A symmetry S is used: it maps (p_0, p_1, p_2) to (p_0, -p_1, p_2) and (q_1, q_2) to (-q_1, q_2), exactly."""
    statement = "a symmetry S is named, it fixes the centre, negates p_1 and q_1 and fixes the other coordinates"
    with checklist.hypothesis("adapted-frames", "8.6", statement, _ADAPT) as evidence:
        system = candidate.system
        otherwise = "; without one a claim with k = 3 is touch_and_go" if candidate.k == 3 else ""
        evidence.require(candidate.symmetry is not None, f"the candidate names no symmetry{otherwise}")
        if candidate.symmetry is None:
            return
        signs = system.symmetries[candidate.symmetry]
        p_signs = signs_on(system, candidate.symmetry, candidate.coordinates)
        if candidate.uses_level and system.level_coordinate is not None:
            evidence.require(
                signs[system.state.index(system.level_coordinate)] == 1,
                f"S does not fix {system.level_coordinate}, the coordinate that follows from the first integral",
            )
        q_signs = tuple(signs[i] for i in system.kernel_coordinates)
        evidence.require(
            all(value == 0 for value, sign in zip(candidate.centre, p_signs, strict=True) if sign == -1),
            "the centre is not fixed by S",
        )
        evidence.require(
            is_adapted(candidate.frame, p_signs, 1), "a column of frame is neither even nor odd as it should be"
        )
        evidence.require(
            is_adapted(tuple(zip(*candidate.kernel_frame, strict=True)), q_signs, 0),
            "a row of kernel_frame is neither even nor odd as it should be",
        )
