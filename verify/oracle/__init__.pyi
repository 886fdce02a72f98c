from .approximations import IN_FRAMES as IN_FRAMES
from .approximations import ORACLE as ORACLE
from .return_times import relative_return_times as relative_return_times
from .steps import steps_about as steps_about
