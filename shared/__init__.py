"""The statement both sides agree on: systems, symmetries, sections, parameters and JSON formats."""
