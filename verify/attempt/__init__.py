"""What to try next about a claim, with how many bits, on which box (section 10.3); nothing is proved by it."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
