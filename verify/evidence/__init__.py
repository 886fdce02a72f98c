"""What counts as shown: comparisons of balls, hypotheses with their enclosures, outcomes."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
