"""What commands print to, and the exit statuses that they end with."""

import sys

from rich.console import Console

DONE, FELL, BAD_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130
PIPE_WIDTH_COLUMNS = 200
"""Columns of tables that are not printed on a terminal, where nobody can make the window wider."""
output, messages = Console(width=None if sys.stdout.isatty() else PIPE_WIDTH_COLUMNS), Console(stderr=True)
