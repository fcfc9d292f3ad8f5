"""The one error that a user's input can cause, and those of its kinds that carry something more."""


class InputError(Exception):
    """Bad input: one line that says what is wrong, where, and what to do.

    The command line prints it without a traceback and exits with status 2.
    """


class UnknownSkeletonError(InputError):
    """Joints of a clip under names that nobody knows.

    Attributes:
        lacking: what is missing, and what may be meant, in words.
        mapping: text of a mapping file (TOML), to be completed.
    """

    def __init__(self, lacking: str, mapping: str):
        super().__init__(f"{lacking}; complete the mapping that `sot` prints, and give it to --mapping")
        self.lacking, self.mapping = lacking, mapping


class InvalidRowsError(InputError):
    """Rows of a task that cannot be used: of a wrong shape or type, or with a value that is not finite."""
