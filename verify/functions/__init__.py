"""Functions on an interval of a piece, with bounds of what is not known (section 22)."""

from orbitproof.verify.functions.functions import (
    REACH,
    BoundedFunction,
    bounded,
    determinant,
    error_of,
    finite,
    function,
    function_from_json,
    function_to_json,
    inverse,
    known_part,
    norm_of,
    restricted,
    slope,
)
