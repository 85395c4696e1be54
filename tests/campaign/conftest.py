"""Campaigns with an engine that wears by a law."""

from dataclasses import replace
from typing import Any

import pytest

from campaign.fake_engine import FakeEngine, Seen
from presswear.campaign import runner
from presswear.campaign.campaign import run_campaign
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.scene.scene import Scene


@pytest.fixture(scope="module")
def unwatched():
    """Begin a life without 50 cycles that show whether the motion settles."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "WATCHED_CYCLES", 1)
        yield


@pytest.fixture
def use(monkeypatch):
    """Return a function that puts a fake engine in place of any."""

    def replace_all(engine: FakeEngine) -> None:
        for kind in (ExudynTree, ExudynJoints, InHouse):
            monkeypatch.setattr(kind, "simulate", lambda self, *given: engine(*given))

    return replace_all


@pytest.fixture
def campaign(use):
    """Return a function that runs a campaign with a fake engine."""

    def run_with(scene: Scene, engine: FakeEngine, **settings: Any) -> Seen:
        use(engine)
        seen = Seen()
        seen.status, seen.message, _ = run_campaign(replace(scene, **settings), [seen])
        return seen

    return run_with
