"""Orbits and families as values for scripts and notebooks: what they are, and what the command line does with them."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
