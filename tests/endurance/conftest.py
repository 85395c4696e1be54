"""Fixtures of the trials."""

import time
from collections.abc import Callable, Iterator
from functools import cache

import pytest

from endurance.subject import Alone, Subject, Trial


@pytest.fixture
def trial(record_property: Callable[[str, object], None]) -> Iterator[Trial]:
    trial = Trial()
    yield trial
    for name in ("attempts", "passes", "note"):
        record_property(name, getattr(trial, name))


@pytest.fixture
def is_quick(request: pytest.FixtureRequest) -> bool:
    return bool(request.config.getoption("--quick"))


@pytest.fixture(scope="session")
def alone(tmp_path_factory: pytest.TempPathFactory) -> Callable[[Subject], Alone]:
    """Return a function that runs a subject undisturbed, once."""

    @cache
    def run(subject: Subject) -> Alone:
        folder = tmp_path_factory.mktemp("alone") / "out"
        started = time.monotonic()
        answer = subject.finish(folder)
        assert answer.code == 0, answer.problem
        return Alone(folder, time.monotonic() - started)

    return run
