"""Traced families as files hold them; reading them needs neither JAX nor diffrax."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
