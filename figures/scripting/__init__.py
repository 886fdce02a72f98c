"""Pictures, tables and reports for scripts and notebooks; `orbitproof.figures` hands these names on.

Everything is read from files, as on the command line; nothing is computed here but what a picture takes, and data files
are made by the commands that search and prove. `told` is called with each file that is written, as soon as it is there.
All raise `InputError`, one line, for files that are not what they should be.
"""

from orbitproof.figures.scripting.data import Made, make_data, missing_steps
from orbitproof.figures.scripting.documents import (
    Report,
    draw_distances,
    tables_of,
    write_page,
    write_report,
    write_tables,
)
from orbitproof.figures.scripting.pictures import (
    Drawn,
    draw_all,
    draw_atlases,
    draw_branches,
    draw_catalogues,
    draw_family,
    draw_periodic,
    draw_resonances,
    draw_tori,
    draw_web,
)
from orbitproof.figures.scripting.written import print_path
