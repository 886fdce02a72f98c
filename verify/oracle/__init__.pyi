from .approximations import ORACLE as ORACLE
from .steps import steps_about as steps_about
