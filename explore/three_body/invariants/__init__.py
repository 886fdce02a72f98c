"""What surrounds a periodic orbit: invariant tori of elliptic ones, stable and unstable manifolds. Numerics only."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
