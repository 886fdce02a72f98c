"""Lyapunov-Schmidt reduction, conditions and theorems (sections 8, 9, 11)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
