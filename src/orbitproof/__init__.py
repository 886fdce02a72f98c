"""Finds bifurcations of symmetric periodic orbits of reversible systems, and proves them.

`orbitproof.shared` states systems and claims, `orbitproof.explore` searches (not trusted), `orbitproof.verify` proves,
`orbitproof.figures` draws. The command is ``orbitproof``; ``python -m orbitproof.verify`` and so on do the same.
"""

__version__ = "0.3.0"
