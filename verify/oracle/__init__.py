"""Approximations (section 3): whatever comes from this room, nothing false follows."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
