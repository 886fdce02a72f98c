"""Zeros, prediction along a curve, when Newton's method ends, and numbers with many digits."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
