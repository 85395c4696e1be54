"""Settings and a fixture shared by all tests."""

import shlex
import signal
from collections.abc import Callable

import pytest
from hypothesis import settings

# The first call of a kernel compiles it, which no deadline allows for.  Examples are
# the same in every run; `--hypothesis-profile=explore` looks further.
settings.register_profile("repeatable", deadline=None, derandomize=True, max_examples=60)
settings.register_profile("explore", deadline=None, max_examples=3000)
settings.load_profile("repeatable")

# A shell's background jobs have it ignored, and so would the programs that tests interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., str]:
    """Return a function that runs a command line and returns its output; a refusal is one line."""
    from presswear.__main__ import main

    def run(line: str, code: int = 0) -> str:
        capsys.readouterr()
        assert main(shlex.split(line)) == code
        out, err = capsys.readouterr()
        assert code != 2 or (err.startswith("presswear: ") and err.count("\n") == 1)
        return out + err

    return run


def pytest_addoption(parser: pytest.Parser) -> None:
    """The length of trials, and the processes of those of coverage."""
    parser.addoption(
        "--quick", action="store_true", help="of endurance and coverage: a few of each"
    )
    parser.addoption("--jobs", help="of pytest -m coverage: runs at a time")
