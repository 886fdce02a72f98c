"""Approximations (section 3): whatever comes from this room, nothing false follows."""

from orbitproof.verify.oracle.approximations import ORACLE
from orbitproof.verify.oracle.steps import steps_about
