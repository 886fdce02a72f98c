"""The search in the restricted three-body problem, which the general search does not know."""
