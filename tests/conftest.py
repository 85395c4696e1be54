"""Settings and a fixture shared by all tests."""

import gc
import shlex
import signal
from collections.abc import Callable

import pytest
from hypothesis import settings

# The first call of a kernel compiles it, which no deadline allows for.  Examples are
# the same in every run; `--hypothesis-profile=explore` looks further.
settings.register_profile(
    "repeatable", deadline=None, derandomize=True, max_examples=60
)
settings.register_profile("explore", deadline=None, max_examples=3000)
settings.load_profile("repeatable")

# A shell's background jobs have it ignored, and so would the programs that tests
# interrupt.
signal.signal(signal.SIGINT, signal.default_int_handler)


# Files of more than 10 s of CPU time. They begin first, so that all processes end
# together.
LONGEST = """
test_report test_life test_figures test_command_line test_scenarios test_pages test_sweep
test_friction_without_clearance test_loads test_cases test_settled_motions test_laws_in_scenes
test_soundness test_rounds test_replay_command test_runner test_export test_sensitivity
test_growth test_growing_life test_tonnage test_worn_walls test_slots_with_clearance test_folder
test_bifurcation test_motion test_equations test_kernel_cache test_workers test_worn_bush
test_terminal test_untrusted_laws test_browser test_initial_surfaces test_ensemble
test_benchmark test_processes test_campaign test_heavy_press test_engines_agree
"""


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Begin with the longest files."""
    rank = {name: k for k, name in enumerate(LONGEST.split())}
    items.sort(key=lambda item: rank.get(item.path.stem, len(rank)))


def pytest_collection_finish() -> None:
    """Leave what is collected out of every later garbage collection."""
    gc.freeze()


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
