"""The open tree in Exudyn beside Lagrange multipliers over the first ten touches of a scene."""

import numpy as np

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import ExudynTree, InHouse
from presswear.scene.scene import Scene
from presswear.validation.cases import contacts_of

TOUCHES = 10


def run_until(scene: Scene, engine: ExudynTree | InHouse, duration: float) -> Run:
    """Run a scene for a time, s."""
    plan = Plan(duration, 1, recorded_cycles=1)
    run = engine.for_cycle(scene.mechanism.period).simulate(scene.linkage(), start_of(scene), plan)
    assert run.status == "completed", run.message
    return run


def touchdowns(run: Run, joints: int) -> list[float]:
    """Times of all touches, s, in order."""
    return sorted(time for k in range(joints) for time in contacts_of(run, k)["touchdown"].tolist())


def agreed_over_ten_touches(scene: Scene, within: float) -> tuple[Run, Run]:
    """The runs in-house and in the tree up to behind the tenth touch, both fine.

    They agree on the touches within a time, s, on all places to 1e-8 m, and each keeps its energy
    to 1e-7 of what the drives exchange.
    """
    joints = len(scene.clearance_joints)
    fine = InHouse(integration_tolerance=1e-12)
    times = touchdowns(run_until(scene, fine, 0.5 * scene.mechanism.period), joints)
    assert len(times) > TOUCHES
    duration = 0.5 * (times[TOUCHES - 1] + times[TOUCHES])
    reference = run_until(scene, fine, duration)
    ours = run_until(scene, ExudynTree(tree_tolerance=1e-11), duration)
    one, other = (np.array(touchdowns(run, joints))[: TOUCHES - 1] for run in (reference, ours))
    np.testing.assert_allclose(one, other, atol=within)
    assert np.abs(ours.end.position - reference.end.position).max() < 1e-8
    for run in (reference, ours):
        residual = abs(float(run.diagnostics["energy_residual_J"]))
        assert residual < 1e-7 * float(run.diagnostics["drive_exchange_J"])
    return reference, ours
