"""Power series on the polydisc with one error bound per grade (section 2)."""

from orbitproof.verify.algebra.circle import Floats, Points, from_points, graded_power, pack, to_points, unpack
from orbitproof.verify.algebra.grading import Factors, Grading
from orbitproof.verify.algebra.norms import GradedNorm, float_above, fraction_above, inflate, total
from orbitproof.verify.algebra.polynomials import ball_polynomial, plus, recentred, values_around
from orbitproof.verify.algebra.programs import Evaluation, PreparedProgram, approximate_power, integer_part, prepare
from orbitproof.verify.algebra.series import Arithmetic, Series, correct_power
from orbitproof.verify.algebra.wide_powers import wide_power

__all__ = [
    "Arithmetic",
    "Evaluation",
    "Factors",
    "Floats",
    "GradedNorm",
    "Grading",
    "Points",
    "PreparedProgram",
    "Series",
    "approximate_power",
    "ball_polynomial",
    "correct_power",
    "float_above",
    "fraction_above",
    "from_points",
    "graded_power",
    "inflate",
    "integer_part",
    "pack",
    "plus",
    "prepare",
    "recentred",
    "to_points",
    "total",
    "unpack",
    "values_around",
    "wide_power",
]
