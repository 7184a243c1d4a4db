"""The few kinds of error that flowtree raises on purpose.

A message says the thing, the rule, what came and what to do, in one line; ``check`` words it.
"""


class FlowtreeError(Exception):
    """Everything flowtree raises on purpose; the command line prints it as one line and exits with 1."""


class InputError(FlowtreeError, ValueError):
    """A file, picture, array or parameter that breaks a rule."""


class OutputError(FlowtreeError, OSError):
    """Something that could not be written; what stood there before is untouched."""


class CancelledError(FlowtreeError):
    """The caller asked a running job to stop."""
