"""Rigorous verification of bifurcations of symmetric periodic orbits (docs/method.md).

The modules read in this order: `norms`, `grading`, `algebra`, `centre`, `solution`, `evaluation`,
`gronwall`, `step`, `section`, `crossing`, `derivatives`, `poincare`, `symmetry` (the Poincare map and its
derivatives); `balls`, `ball_text`, `frames`, `expansion`, `jets`, `interval_newton`, `reduction`,
`conditions`, `nondegeneracy`, `theorems`, `outcome` (what follows from them); `certify`, `certificate`,
`workers`, `report` (the command line ``orbitproof verify``).
"""
