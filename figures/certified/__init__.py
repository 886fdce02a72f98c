"""What certificates say, as it is drawn: boxes with their curves, proved curves, their stability."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
