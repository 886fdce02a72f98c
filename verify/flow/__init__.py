"""The flow: defect of an approximation, existence and propagation of errors, step by step (sections 3 and 4)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
