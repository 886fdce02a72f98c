from .request import check as check
from .run import run as run
