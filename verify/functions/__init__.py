"""Functions on an interval of a piece, with bounds of what is not known (section 22)."""

from orbitproof.verify.functions.functions import (
    REACH,
    BoundedFunction,
    StoredFunction,
    bounded,
    determinant,
    error_of,
    finite,
    function,
    inverse,
    known_part,
    norm_of,
    restricted,
    slope,
)
