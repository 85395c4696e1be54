"""Runs and linkages that tests of engines share."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run, Start
from presswear.engines.dae.dynamics import System, system_of
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.linkage.topology import branches_of
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT
from presswear.physics.equations.function import model_of
from presswear.physics.equations.writer import write_body_forces
from presswear.physics.packed import mass_of, pack
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.validation.cases import finished

# Engines, and tolerances of places, m, in smooth motions
ENGINES: list[tuple[Engine, float]] = [
    (InHouse(integration_tolerance=1e-12, free_step=0.01), 1e-10),
    (InHouse("rk4", equal_step=0.77e-3), 1e-8),
    (ExudynTree(tree_tolerance=1e-11, free_step=0.01), 1e-9),
    (ExudynJoints(50, 10, free_step=3e-4, newton=1e-10), 2e-5),
]
in_every_engine = pytest.mark.parametrize(
    ("engine", "within"), ENGINES, ids=["dop853", "rk4", "exudyn-tree", "exudyn-joints"]
)


def run_scene(
    scene: Scene,
    engine: Engine,
    duration: float | None = None,
    linkage: Linkage | None = None,
    **plan: Any,
) -> Run:
    """Run a scene, by default for a cycle and on its own linkage, to the end."""
    period = scene.mechanism.period
    return finished(
        engine.for_cycle(period).simulate(
            linkage or scene.linkage(),
            start_of(scene),
            Plan(duration or period, 1, **plan),
        )
    )


def simulated(engine: Engine, linkage: Linkage, start: Start, duration: float) -> Run:
    """Run a linkage from a start for a duration, s, in one cycle, to the end."""
    return finished(
        engine.for_cycle(duration).simulate(linkage, start, Plan(duration, 1))
    )


def energy_residual(run: Run) -> float:
    """Return the residual of the energy balance, J."""
    return abs(float(run.diagnostics["energy_residual_J"]))


def residual(run: Run) -> float:
    """Return the residual of the energy balance over what the drives exchanged."""
    return energy_residual(run) / float(run.diagnostics["drive_exchange_J"])


def touches(run: Run) -> int:
    """Return the number of recorded contacts of all joints."""
    joints = len(run.recorder.records.memory)
    return sum(len(run.recorder.stored_contacts(k)) for k in range(joints))


def compare_engines(
    scene: Scene,
    duration: float,
    exudyn: ExudynJoints | None = None,
    energy: float = 1e-9,
    joints: tuple[float, float, float] = (3e-6, 1e-5, 3e-5),
) -> list[Run]:
    """Compare motion, torques, work and energy of all engines; return their runs.

    The reference, which is the first run, is the in-house engine with all coordinates.
    ``energy`` bounds the residual of all engines but the last one, ``exudyn``.
    ``joints`` bounds its positions, m or rad, its residual and the error of its work.
    The tree runs where no loop is left.
    """
    fine = InHouse(integration_tolerance=1e-11)
    engines: list[Engine] = [replace(fine, coordinates="all"), fine]
    if not isinstance(branches_of(scene.linkage()), str):
        engines.append(ExudynTree(tree_tolerance=1e-11))
    runs = [run_scene(scene, engine, duration) for engine in engines]
    reference = runs[0]
    torques = reference.recorder.records.torque
    for run in runs:
        assert np.abs(run.end.position - reference.end.position).max() < 1e-9
        assert residual(run) < energy
        found = run.recorder.records.torque
        assert_allclose(found, torques, 1e-6, 1e-9 * np.abs(torques).max())
    runs.append(run_scene(scene, exudyn or ExudynJoints(), duration))
    assert np.abs(runs[-1].end.position - reference.end.position).max() < joints[0]
    assert residual(runs[-1]) < joints[1]
    expected, work = (float(runs[k].diagnostics["drive_work_J"]) for k in (0, -1))
    assert work == pytest.approx(expected, rel=joints[2])
    return runs


def momenta(linkage: Linkage, state: Start) -> Array:
    """Return linear momentum (2) and angular momentum about the origin."""
    x, y, _ = state.position.reshape(-1, 3).T
    px, py, spin = (mass_of(linkage) * state.velocity).reshape(-1, 3).T
    return np.array([px.sum(), py.sum(), np.sum(x * py - y * px + spin)])


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
