from .file import write_catalogue_csv as write_catalogue_csv
from .file import write_catalogue_json as write_catalogue_json
from .orbits import catalogue_of as catalogue_of
from .orbits import libration_places as libration_places
from .start import CatalogueStart as CatalogueStart
from .start import catalogue_start as catalogue_start
