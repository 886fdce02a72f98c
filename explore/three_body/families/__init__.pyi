from .hemispheres import branch_at as branch_at
from .hemispheres import branch_of as branch_of
from .hemispheres import mirrored as mirrored
from .hemispheres import on_side as on_side
from .named import by_name as by_name
from .named import trace_family as trace_family
from .named import trace_reaching as trace_reaching
