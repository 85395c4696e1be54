"""Settings shared by all tests."""

import signal

import pytest
from hypothesis import settings

# The first call of a kernel compiles it, which no deadline allows for.  Examples are
# the same in every run; `--hypothesis-profile=explore` looks further.
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=60)
settings.register_profile("explore", deadline=None, max_examples=3000)
settings.load_profile("repeatable")

# A shell's background jobs have it ignored, and so would the programs that tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    """The length of the trials of endurance."""
    parser.addoption("--quick", action="store_true", help="of pytest -m endurance: a few of each")
