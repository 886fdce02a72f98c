from .request import check as check
from .run import search as search
