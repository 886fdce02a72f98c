"""What is claimed, as values: boxes with a bifurcation or an orbit, curves and surfaces in pieces."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
