from .folder import check_folder as check_folder
from .folder import file_name as file_name
from .saving import Files as Files
from .saving import add_file_options as add_file_options
from .saving import files_of as files_of
from .saving import save as save
from .saving import saved_as as saved_as
