from .orbits import row_id as row_id
from .orbits import tasks_of_catalogue as tasks_of_catalogue
from .orbits import tasks_of_family as tasks_of_family
from .request import check as check
from .request import started as started
from .run import search as search
from .targets import Target as Target
from .targets import targets_of as targets_of
