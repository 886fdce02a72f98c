"""The Poincare map and its derivatives on a box: section, crossings, returns (sections 5, 6, 14)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
