"""Refusals of bad input."""

from contextlib import AbstractContextManager
from typing import Any

import pytest

from presswear.tools.errors import InputError


def refused(words: str) -> AbstractContextManager[Any]:
    """Expect an ``InputError`` whose message matches a pattern."""
    return pytest.raises(InputError, match=words)
