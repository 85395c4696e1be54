"""What a person can be told in one line.

The command line turns these into one line and exit code 2 (bad input) or 1
(a run that failed); anything else is a defect and shows its traceback.
"""


class InputError(ValueError):
    """Input that names nothing, is out of range or does not fit together."""


class AssemblyError(InputError):
    """A linkage that cannot be put together in some position."""


class RunError(RuntimeError):
    """A run that had to stop: what happened, when, and what to do about it."""
