"""What a candidate claims: symmetries, frames, the level of the first integral as parameter (sections 1, 12)."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
