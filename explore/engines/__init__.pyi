from .processes import Job as Job
from .processes import Lost as Lost
from .processes import Progress as Progress
from .processes import run_all as run_all
from .progress import Reporter as Reporter
