from .file import Birth as Birth
from .file import BranchOrbit as BranchOrbit
from .file import BranchRecord as BranchRecord
from .file import read_branches as read_branches
from .file import write_branches as write_branches
from .following import follow as follow
from .start import NoBranch as NoBranch
from .start import branch_point as branch_point
