"""Flows and Poincare maps of any system on sets of initial values, and their fixed points (section 23)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
