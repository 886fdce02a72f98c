from .request import check as check
from .request import started as started
from .run import search as search
from .targets import Target as Target
from .targets import targets_of as targets_of
