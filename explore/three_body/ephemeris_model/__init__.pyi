from .carrying import NotCarried as NotCarried
from .carrying import RealOrbit as RealOrbit
from .carrying import carry_over as carry_over
from .carrying import real_ephemeris as real_ephemeris
from .kernels import Bodies as Bodies
from .kernels import bodies_named as bodies_named
from .kernels import kernels_loaded as kernels_loaded
