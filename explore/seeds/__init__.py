"""First approximations of orbits: libration points with their linear orbits, the limit of Falkner-Skan's."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
