"""Interval Newton for implicit equations (section 7.4; Appendix A of the paper).

For f(x, y) with values in R^m, y in R^m: if every matrix in an interval matrix A that contains D_y f
on X x Y is regular, and -A^-1 f(X, 0) lies in the interior of the box Y (0 in Y), then for each x in X
there is exactly one zero y(x) in Y; it lies in that image and depends smoothly on x.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from flint import arb, arb_mat

from orbitproof.verify.evidence import all_finite, hull, is_below, is_positive, meet, total
from orbitproof.verify.newton.jets import Jet, implicit_jets
from orbitproof.verify.newton.taylor_forms import BoxFunction

Matrix = Sequence[Sequence[arb]]


def regularity_defect(matrix: Matrix) -> list[list[arb]]:
    """Entrywise upper bounds of |I - B A| over the interval matrix A, B an approximate inverse of its midpoint.

    Raises `ZeroDivisionError` if the midpoint is numerically singular.
    """
    ball_matrix = arb_mat([list(row) for row in matrix])
    approximate = ball_matrix.mid().inv().mid()
    product = approximate * ball_matrix
    size = len(matrix)
    return [[abs(int(i == j) - product[i, j]).upper() for j in range(size)] for i in range(size)]


def is_regular(matrix: Matrix) -> bool:
    """Whether every real matrix in the interval matrix is shown to be regular.

    With M >= |I - B A| entrywise, a vector v > 0 with M v < v shows that |I - B A| < 1 in the norm
    max |w_i| / v_i, hence that B A is regular. A good v is (I - M)^-2 (1, .., 1), the second factor
    for the scale of its components; any v will do.
    """
    try:
        bound = regularity_defect(matrix)
        size = len(bound)
        if not all_finite(entry for row in bound for entry in row):
            return False
        gap = arb_mat([[int(i == j) - bound[i][j] for j in range(size)] for i in range(size)])
        weights = gap.mid().solve(gap.mid().solve(arb_mat([[1]] * size)).mid()).mid()
    except ZeroDivisionError:
        return False
    v = [weights[i, 0] for i in range(size)]
    image = [total(entry * weight for entry, weight in zip(row, v, strict=True)) for row in bound]
    return all(is_positive(weight) for weight in v) and all(is_below(a, b) for a, b in zip(image, v, strict=True))


def newton_image(matrix: Matrix, residual: Sequence[arb]) -> list[arb]:
    """Enclosure of -A^-1 f for all matrices A and vectors f in the arguments.

    Raises `ZeroDivisionError` if some matrix may be singular.
    """
    if not residual:
        return []
    solution = arb_mat([list(row) for row in matrix]).solve(arb_mat([[-value] for value in residual]))
    return [solution[i, 0] for i in range(len(residual))]


@dataclass(frozen=True)
class ImplicitGraph:
    """The zeros of f(x, y) = 0 in the box, as a graph y(x) over x = (p_0, .., p_{independent-1}).

    Attributes:
        functions: the components of f, one for each coordinate of y.
        box: balls that contain the intervals P_i, all coordinates.
        independent: number of coordinates in x.
    """

    functions: tuple[BoxFunction, ...]
    box: tuple[arb, ...]
    independent: int

    def derivative_matrix(self, where: Sequence[arb]) -> list[list[arb]]:
        """Enclosure of D_y f at every point of the box with p in `where`."""
        return [function.gradient(where, self.independent) for function in self.functions]

    def is_regular(self) -> bool:
        """Whether every matrix in the interval hull of D_y f over the whole box is regular."""
        return not self.functions or is_regular(self.derivative_matrix(self.box))

    def image(self, x: Sequence[arb], within: Sequence[arb] | None = None) -> list[arb]:
        """The interval Newton image -[D_y f]^-1 f(x, 0), D_y f over x and `within` (default: all of Y).

        It contains y(x) whenever `within`, which has to contain 0, does.
        """
        y = list(self.box[self.independent :]) if within is None else list(within)
        zero = [arb(0)] * len(y)
        residual = [function.value([*x, *zero]) for function in self.functions]
        return newton_image(self.derivative_matrix([*x, *y]), residual)

    def over(self, x: Sequence[arb]) -> tuple[arb, ...]:
        """All coordinates of the points (x, y(x)) of the graph, x in the given balls.

        Valid once the graph is known to exist: y(x) lies in the box, then in the Newton image, and the
        image may be repeated with the matrix over the hull of 0 and what is known already.
        """
        first = self.image(x)
        y = [meet(known, new) for known, new in zip(self.box[self.independent :], first, strict=True)]
        second = self.image(x, [hull(arb(0), ball) for ball in y])
        return (*x, *(meet(known, new) for known, new in zip(y, second, strict=True)))

    def jets(self, where: Sequence[arb], order: int = 3) -> tuple[Jet, ...]:
        """Jets of all coordinates along the graph, as functions of x, at its points in `where`."""
        derivatives = [function.derivatives(where) for function in self.functions]
        return implicit_jets(derivatives, self.independent, order)
