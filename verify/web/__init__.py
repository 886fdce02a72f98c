"""Proved curves of periodic orbits joined into a graph (section 33)."""

from orbitproof.verify.web.arc import Arc, level_at, libration_vertex
from orbitproof.verify.web.indices import IndexOnArc, Indices
from orbitproof.verify.web.meetings import Incidence, meeting_shown
from orbitproof.verify.web.proved_web import KnownArc, ProvedWeb, Switch, Vertex, WebTheorem, conclude_web
