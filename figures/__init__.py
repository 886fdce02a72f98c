"""Pictures of families of symmetric periodic orbits, with what is certified and what is only numerical."""
