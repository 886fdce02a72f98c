"""Systems: vector field, symmetries, section, parameters, as values and as straight-line programs."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
