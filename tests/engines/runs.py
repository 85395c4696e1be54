"""Runs and linkages that tests of engines share."""

import math
from typing import Any

import numpy as np

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.dae.dynamics import System, system_of
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT
from presswear.physics.equations.function import model_of
from presswear.physics.equations.writer import write_body_forces
from presswear.physics.packed import pack
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
        float(run.diagnostics[f"{name}_J"])
        for name in ("energy_residual", "drive_exchange")
    )
    return abs(missing) / exchanged


def step_response(omega: float, ratio: float, time: float) -> float:
    """Return the place of a damped oscillator that is let go at 1 from rest."""
    damped = omega * math.sqrt(1.0 - ratio**2)
    phase = damped * time
    decay = math.exp(-ratio * omega * time)
    return decay * (math.cos(phase) + ratio * omega / damped * math.sin(phase))


def in_all_coordinates(
    linkage: Linkage, alpha: float = 0.0, beta: float = 0.0
) -> System:
    """Return the equations of a linkage with multipliers; coefficients of Baumgarte in 1/s."""
    packed = pack(linkage)
    count = len(linkage.clearances)
    forces = write_body_forces(linkage, packed)
    model = model_of(linkage, forces, packed, np.zeros(count), np.zeros(count, CONTACT))
    return system_of(packed, forces, model, constraints_of(linkage), alpha, beta)
