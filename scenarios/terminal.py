"""What commands print to, and the exit statuses that they end with."""

import sys

import typer
from rich.console import Console

from sot.errors import InputError

DONE, FELL, BAD_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130
PIPE_WIDTH_COLUMNS = 200
"""Columns of tables that are not printed on a terminal, where nobody can make the window wider."""
output, messages = Console(width=None if sys.stdout.isatty() else PIPE_WIDTH_COLUMNS), Console(stderr=True)


def run_app(app: typer.Typer) -> int:
    """Run the command line of a module and return its exit status; what the user did wrong is one line on stderr."""
    try:
        app(standalone_mode=False)
    except InputError as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    return DONE
