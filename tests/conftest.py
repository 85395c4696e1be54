"""Settings shared by all tests."""

import signal
from pathlib import PurePosixPath

import pytest
from hypothesis import settings
from xdist.remote import Producer
from xdist.scheduler import LoadFileScheduling

# The first call of a kernel compiles it, which no deadline allows for.  Examples are
# the same in every run; `--hypothesis-profile=explore` looks further.
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=60)
settings.register_profile("explore", deadline=None, max_examples=3000)
settings.load_profile("repeatable")

# A shell's background jobs have it ignored, and so would the programs that tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


class LoadFixtures(LoadFileScheduling):
    """Hands out tests by file, and by folder where a whole one shares what it has measured."""

    def _split_scope(self, nodeid: str) -> str:
        file = PurePosixPath(super()._split_scope(nodeid))
        return str(file.parent if file.parent.name == "precision" else file)


def pytest_xdist_make_scheduler(config: pytest.Config, log: Producer) -> LoadFixtures:
    """Tests go to processes in these parts."""
    return LoadFixtures(config, log)


def pytest_addoption(parser: pytest.Parser) -> None:
    """The length of the trials of endurance."""
    parser.addoption("--quick", action="store_true", help="of pytest -m endurance: a few of each")
