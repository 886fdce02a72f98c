from .latex import to_latex as to_latex
from .published import default_published as default_published
from .published import read_published as read_published
from .rows import read_rows as read_rows
from .tables import build_tables as build_tables
from .text import to_csv as to_csv
from .text import to_markdown as to_markdown
from .text import to_text as to_text
