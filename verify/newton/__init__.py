"""Interval Newton, Taylor forms and jets of implicit functions (section 7)."""

from orbitproof.verify.newton.interval_newton import ImplicitGraph, is_regular, newton_image
from orbitproof.verify.newton.jets import Jet, compose, implicit_jets
from orbitproof.verify.newton.taylor_forms import BoxFunction
