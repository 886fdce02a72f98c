"""Stability for ever, along proved curves (section 29)."""

from orbitproof.verify.lasting.confirmation import unconfirmed_twist
from orbitproof.verify.lasting.fates import (
    LEAST_ORDER,
    ExceptionalOrbit,
    Fate,
    LastingInterval,
    LastingList,
    lasting_list,
)
from orbitproof.verify.lasting.jets import FunctionJet, compose, exchanged, inverse_of_plane_map, solved
from orbitproof.verify.lasting.left_open import exceptions_to_sharpen, twist_open_on
from orbitproof.verify.lasting.proved_lasting import LastingTheorem, ProvedLasting, conclude_lasting
from orbitproof.verify.lasting.reversibility import Reversibility
from orbitproof.verify.lasting.stored import CurveIntervalResult, TwistFunctions, is_known_of, twist_of_piece
from orbitproof.verify.lasting.twist_function import NormalForm, normal_form
