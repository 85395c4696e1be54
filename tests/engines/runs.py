"""Runs and linkages that tests of engines share."""

from typing import Any

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.scene.scene import Scene


def run_scene(
    scene: Scene,
    engine: Engine,
    duration: float | None = None,
    linkage: Linkage | None = None,
    **plan: Any,
) -> Run:
    """Run a scene, by default for a cycle and on its own linkage, to the end."""
    period = scene.mechanism.period
    run = engine.for_cycle(period).simulate(
        linkage or scene.linkage(), start_of(scene), Plan(duration or period, 1, **plan)
    )
    assert run.status == "completed", run.message
    return run


def residual(run: Run) -> float:
    """Residual of the energy balance over what the drives exchanged."""
    missing, exchanged = (
        float(run.diagnostics[f"{name}_J"]) for name in ("energy_residual", "drive_exchange")
    )
    return abs(missing) / exchanged
