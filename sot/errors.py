"""The one error that a user's input can cause."""


class InputError(Exception):
    """Bad input: one line that says what is wrong, where, and what to do.

    The command line prints it without a traceback and exits with status 2.
    """


class InvalidRowsError(InputError):
    """Rows of a task that cannot be used: of a wrong shape or type, or with a value that is not finite."""
