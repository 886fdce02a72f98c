from .data_folder import DataFolder as DataFolder
from .data_folder import MissingData as MissingData
from .manifest import STEPS as STEPS
from .manifest import Step as Step
from .manifest import step_of as step_of
from .pictures import PICTURES as PICTURES
