"""Orbits among bodies that move as kernels for SPICE say: carried over from the restricted problem. Not rigorous."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
