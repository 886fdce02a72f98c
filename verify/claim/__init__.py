"""What a candidate claims: symmetries, frames, the level of the first integral as parameter (sections 1, 12)."""

from orbitproof.verify.claim.divergence import is_free_of_divergence
from orbitproof.verify.claim.first_integral import derivative_terms, is_first_integral
from orbitproof.verify.claim.fixed_level import LevelEquation, is_in, on_box
from orbitproof.verify.claim.frames import check_adapted_frames, check_frames, determinant, inverse, is_adapted
from orbitproof.verify.claim.level import (
    check_level,
    level_program,
    point_on_fixed_set,
    quadratic_coefficient,
)
from orbitproof.verify.claim.linear_symmetry import is_respected
from orbitproof.verify.claim.symmetry import check_symmetries, is_left_alone, parities, signs_on
from orbitproof.verify.claim.wording import (
    atlas_in_words,
    claim_in_words,
    keyed_in_words,
    names_in_words,
    sheet_in_words,
    system_in_words,
)
