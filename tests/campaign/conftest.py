"""Campaigns with an engine that wears by a law."""

from dataclasses import replace
from typing import Any

import pytest

from campaign.fake_engine import Campaign, FakeEngine, Seen, Use
from presswear.campaign.campaign import run_campaign
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.scene.scene import Scene


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Use:
    """Return a function that puts a fake engine in place of any."""

    def replace_all(engine: FakeEngine) -> None:
        for kind in (ExudynTree, ExudynJoints, InHouse):
            monkeypatch.setattr(kind, "simulate", lambda self, *given: engine(*given))

    return replace_all


@pytest.fixture
def campaign(use: Use) -> Campaign:
    """Return a function that runs a campaign with a fake engine."""

    def run_with(scene: Scene, engine: FakeEngine, **settings: Any) -> Seen:
        use(engine)
        seen = Seen()
        seen.status, seen.message, _ = run_campaign(replace(scene, **settings), [seen])
        return seen

    return run_with
