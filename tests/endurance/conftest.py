"""Fixtures of the trials, and the table at the end of ``pytest -m endurance``."""

import time
from collections.abc import Callable, Iterator
from functools import cache

import pytest
from rich.console import Console
from rich.markup import escape

from endurance.subject import Alone, Subject
from endurance.trial import Trial
from presswear.cli.terminal import print_table

TRIALS = pytest.StashKey[list[Trial]]()


@pytest.fixture
def trial(
    request: pytest.FixtureRequest, record_property: Callable[[str, object], None]
) -> Iterator[Trial]:
    """Return a new row of the table, which ``--junitxml`` writes too."""
    trial = Trial()
    request.config.stash.setdefault(TRIALS, []).append(trial)
    yield trial
    for name, cell in zip(
        ("title", "attempts", "passes", "verdict", "note"), trial.row, strict=True
    ):
        record_property(name, cell)


@pytest.fixture
def is_quick(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--quick"))


def pytest_terminal_summary(
    terminalreporter: pytest.TerminalReporter, config: pytest.Config
) -> None:
    trials = config.stash.get(TRIALS, [])
    if trials:
        terminalreporter.section("endurance")
        rows = [[escape(cell) for cell in trial.row] for trial in trials]
        print_table(Console(), ("trial",), ("attempts", "passes"), rows, ("", "note"))


@pytest.fixture(scope="session")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Subject], Alone]:
    """Return a function that runs a subject undisturbed, once."""

    @cache
    def run(subject: Subject) -> Alone:
        folder = tmp_path_factory.mktemp("alone") / "out"
        began = time.monotonic()
        answer = subject.finish(folder)
        assert answer.code == 0, answer.problem
        return Alone(folder, time.monotonic() - began)

    return run
