"""Proved curves of equilibria and of periodic orbits joined into a graph (section 39)."""

from orbitproof.verify.life.arc import Birth, LifeCurve
from orbitproof.verify.life.joints import Birthplace, joint_shown
from orbitproof.verify.life.proved_life import LifeTheorem, ProvedLife, conclude_life
