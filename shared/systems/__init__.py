"""Systems: vector field, symmetries, section, parameters, as values and as straight-line programs."""

from orbitproof.shared.systems.completion import completed, functions_in_floats, level_root
from orbitproof.shared.systems.defined_coordinates import with_functions
from orbitproof.shared.systems.described_functions import DescriptionError, program_function
from orbitproof.shared.systems.description import KEYS, describe, described, described_plainly, is_title
from orbitproof.shared.systems.examination import fault
from orbitproof.shared.systems.formulas import FormulaError, evaluate_formula
from orbitproof.shared.systems.hill import HILL, HILL_AXIAL, IN_HILL_UNITS
from orbitproof.shared.systems.known import FALKNER_SKAN, MASS_PARAMETERS, SYSTEMS
from orbitproof.shared.systems.libration import (
    AROUND,
    BRANCH_SYSTEMS,
    OVER_MASSES,
    SIDES,
    UNLISTED,
    VERTICAL,
    mass_of_distance,
)
from orbitproof.shared.systems.lifted import LIFTED
from orbitproof.shared.systems.names import (
    ID,
    ID_IN_WORDS,
    IDENTIFIER,
    LEVEL_NAME,
    LINE,
    PIECE,
    PIECE_IN_WORDS,
    fits,
    own_name,
)
from orbitproof.shared.systems.parity import has_parities, parities
from orbitproof.shared.systems.parity_of_functions import signs_with_functions
from orbitproof.shared.systems.program import Program, Variable, record
from orbitproof.shared.systems.program_text import program_from_text
from orbitproof.shared.systems.regularised import REGULARISATIONS, Regularisation
from orbitproof.shared.systems.slopes import with_slope
from orbitproof.shared.systems.system import (
    Defined,
    DerivedParameter,
    FixedLevel,
    ParameterRange,
    ReversibleSystem,
    System,
)
from orbitproof.shared.systems.three_body import AXIAL, CR3BP, CR3BP_AXIAL, CR3BP_PLANAR, THREE_BODY
from orbitproof.shared.systems.titles import SYSTEM, TITLE, shown
from orbitproof.shared.systems.units import UNITS, SystemUnits
from orbitproof.shared.systems.varied import HILL_VARIED
