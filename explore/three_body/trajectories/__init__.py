"""Trajectories: states of an orbit over time, from what any file says about it, as CSV and as an ephemeris message."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
