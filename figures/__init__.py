"""Pictures of families of symmetric periodic orbits, with what is certified and what is only numerical.

`make_data` makes the data files that are missing, each by its own command. `draw_family`, `draw_resonances`,
`draw_atlases`, `draw_distances`, `draw_tori`, `draw_web` and `draw_all` draw, `tables_of` and `write_tables` set
tables, `write_page` makes a page to be turned, `write_report` tells what certificates prove. All read files, as the
command line does, and say which files they wrote. Matplotlib is loaded when something is drawn.
"""

from orbitproof.shared.extras import missing_extra
from orbitproof.shared.faces import face

_attribute, __dir__, __all__ = face(__name__, __file__)


def __getattr__(name: str) -> object:
    if name not in __all__:
        raise AttributeError(f"orbitproof.figures has no {name!r}; it has {', '.join(__all__)}")
    try:
        return _attribute(name)
    except ModuleNotFoundError as error:
        line = missing_extra(error)
        if line is None:
            raise
        raise ModuleNotFoundError(line, name=error.name) from None
