"""Parameters of tests that run with ``-m slow`` alone."""

from collections.abc import Container, Iterable
from functools import partial
from typing import Any

import pytest

slow = partial(pytest.param, marks=pytest.mark.slow)


def slow_in(chosen: Container[Any], values: Iterable[Any]) -> list[Any]:
    """Return values as parameters of a test, slow those that are chosen."""
    return [slow(value) if value in chosen else value for value in values]
