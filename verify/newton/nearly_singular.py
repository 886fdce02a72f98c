"""Nearly singular matrices, bordered by a row and a column so that they are regular (section 7.5)."""

from __future__ import annotations

from collections.abc import Sequence

from flint import arb, arb_mat

Matrix = list[list[arb]]


def bordered(matrix: Matrix, column: int, row: Sequence[arb]) -> Matrix:
    """A matrix with a unit vector as a further column and a further row."""
    return [*([*entries, arb(int(i == column))] for i, entries in enumerate(matrix)), [*row, arb(0)]]


def bordering(matrix: Matrix, row: Sequence[arb]) -> int:
    """The unit vector that borders a nearly singular matrix best; nothing rests on the choice."""
    least, best = 0.0, 0
    for column in range(len(matrix)):
        try:
            covector = left_kernel(matrix, column, row)
        except ZeroDivisionError:
            continue
        largest = max(float(abs(ball.mid())) for ball in covector)
        if not least or largest < least:
            least, best = largest, column
    return best


def left_kernel(matrix: Matrix, column: int, row: Sequence[arb]) -> list[arb]:
    """The l with l_column = 1 and l D = 0, for each D in an interval matrix that is 0 on a vector not across `row`.

    Raises `ZeroDivisionError` unless every matrix that is bordered by the unit vector and the row is regular.
    """
    whole = arb_mat(bordered(matrix, column, row)).transpose()
    solution = whole.solve(arb_mat([[0]] * len(matrix) + [[1]]))
    return [solution[i, 0] for i in range(len(matrix))]
