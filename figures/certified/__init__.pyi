from .box import CertifiedCurves as CertifiedCurves
from .curve import CertifiedPoint as CertifiedPoint
from .curve import Curve as Curve
from .curve import Stretch as Stretch
from .heading import heading_of as heading_of
from .stability import CertifiedStability as CertifiedStability
from .stability import ListedPoint as ListedPoint
