"""What the library logs, on standard error where that is asked for."""

import logging
import sys
from collections.abc import Iterator
from contextlib import contextmanager

_FORMAT = "%(asctime)s %(name)s: %(message)s"


class _Errors(logging.Handler):
    """Writes to what is standard error at the time: a progress bar takes its place for a while."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


@contextmanager
def logged(is_verbose: bool) -> Iterator[None]:
    """Show what is logged while this lasts; otherwise nothing, since remarks tell what matters."""
    logger = logging.getLogger("presswear")
    handler = _Errors() if is_verbose else logging.NullHandler()
    handler.setFormatter(logging.Formatter(_FORMAT, "%H:%M:%S"))
    before = logger.level
    logger.addHandler(handler)
    if is_verbose:
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.setLevel(before)
        logger.removeHandler(handler)
