"""Rigorous verification of bifurcations of symmetric periodic orbits.

Each room is a chapter of the method, its README.md: what is shown, its proof, and the module that computes it. They
read from `evidence` to `atlas`, as imports run. "Section 8.4" here and in certificates is found through the table of
docs/method.md.
"""
