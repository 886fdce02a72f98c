"""What is raised where there is no family; it loads without JAX."""

from __future__ import annotations


class FamilyFailure(Exception):
    """The family's first orbit could not be found; one line says why."""
