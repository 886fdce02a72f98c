"""What pictures of families are drawn from: sampled families, their marked points, their stability."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
