"""Interval Newton, Taylor forms and jets of implicit functions (section 7)."""

from orbitproof.verify.newton.interval_newton import ImplicitGraph, is_regular, newton_image
from orbitproof.verify.newton.isolated_zero import enclose_zero
from orbitproof.verify.newton.jets import Jet, compose, derivatives_of, implicit_jets
from orbitproof.verify.newton.nearly_singular import bordered, bordering, left_kernel
from orbitproof.verify.newton.taylor_forms import BoxFunction
