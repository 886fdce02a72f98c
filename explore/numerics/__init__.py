"""Zeros, steps along a curve, Newton's method in double precision and with many digits."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
