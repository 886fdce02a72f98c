"""Certified bifurcations as files that the kernel of Coq checks (README.md). Nothing here is trusted."""
