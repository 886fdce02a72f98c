from .file import read_portraits as read_portraits
from .file import write_portraits as write_portraits
from .planar_map import QUADRUPLING as QUADRUPLING
from .planar_map import TOUCH_AND_GO as TOUCH_AND_GO
from .planar_map import Portrait as Portrait
from .planar_map import portrait as portrait
