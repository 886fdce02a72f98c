"""Reports: what certificates prove, as one document to read, to print and to cite."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
