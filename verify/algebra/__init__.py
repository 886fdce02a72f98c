"""Power series on the polydisc with one error bound per grade (section 2)."""

from orbitproof.verify.algebra.circle import Floats, Points, from_points, graded_power, to_points
from orbitproof.verify.algebra.grading import Exponents, Factors, Grading
from orbitproof.verify.algebra.norms import GradedNorm, convolve, float_above, fraction_above, geometric, inflate, total
from orbitproof.verify.algebra.polynomials import ball_polynomial, plus, recentred, values_around
from orbitproof.verify.algebra.programs import (
    Evaluation,
    PreparedProgram,
    Recurrence,
    enclose_nodes,
    evaluate,
    partial_derivatives,
    prepare,
)
from orbitproof.verify.algebra.series import Arithmetic, Series, correct_power, integer_part
from orbitproof.verify.algebra.wide import WideArithmetic
