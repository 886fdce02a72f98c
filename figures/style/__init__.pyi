from .style import CURVE as CURVE
from .style import INK as INK
from .style import SECOND_CURVE as SECOND_CURVE
from .style import close as close
from .style import label_of as label_of
from .style import level_label as level_label
from .style import marker_of as marker_of
from .style import use_style as use_style
