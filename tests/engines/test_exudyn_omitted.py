"""Bodies and joints in Exudyn where prescribed bodies are left out, against the in-house solver."""

from dataclasses import replace

import numpy as np
import pytest

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.exudyn_joints.engine import left_out
from presswear.engines.settings import InHouse
from presswear.linkage.elements import Attachment
from presswear.linkage.loads import Spring
from presswear.scene.catalog import wear_times


def both(joints: str) -> tuple[Run, Run]:
    scene = replace(wear_times(), joints=joints)
    linkage, start, plan = scene.linkage(), start_of(scene), Plan(0.03, 1)
    accuracy = scene.numerics.joints.for_cycle(scene.mechanism.period)
    fine = replace(
        accuracy,
        steps_per_contact=200,
        steps_sustained=40,
        free_step=accuracy.longest(0.0) / 4,
        newton=1e-11,
    )
    return (
        fine.simulate(linkage, start, plan),
        InHouse(integration_tolerance=1e-11).simulate(linkage, start, plan),
    )


CHAIN = "crank 2, crank 7, plate 4 and rod 3"


@pytest.mark.parametrize(("joints", "omitted"), [("A", "crank 2"), ("AC", "crank 2"), ("C", CHAIN)])
def test_bodies_that_are_left_out_move_and_bear_the_same(joints: str, omitted: str) -> None:
    ours, reference = both(joints)
    assert f"drives, {omitted} prescribed;" in str(ours.diagnostics["model"])
    assert ours.recorder.records.counters["contacts"].sum() >= 2
    assert ours.end.position == pytest.approx(reference.end.position, abs=2e-7)
    assert ours.recorder.records.torque == pytest.approx(
        reference.recorder.records.torque, abs=2e-3
    )
    for name in ("drive_work_J", "contact_loss_J"):
        exchanged = float(reference.diagnostics["drive_exchange_J"])
        expected_work = float(reference.diagnostics[name])
        assert ours.diagnostics[name] == pytest.approx(expected_work, abs=5e-6 * exchanged)
    rows = ours.recorder.rows
    assert np.ptp(rows[:, -2]) > 0.01  # the torque of drive 2


def test_only_bodies_held_by_clearance_joints_are_left_out() -> None:
    linkage = replace(wear_times(), joints="A").linkage()
    assert left_out(linkage) == {"crank 2"}
    spring = Spring("s", Attachment("crank 2", 0, 0), Attachment("frame", 0, 0), 10.0, 0.1)
    assert left_out(replace(linkage, springs=(spring,))) == frozenset()
    assert left_out(replace(linkage, drives=linkage.drives[1:])) == frozenset()
    chain = replace(wear_times(), joints="C").linkage()
    assert left_out(chain) == {"crank 2", "crank 7", "plate 4", "rod 3"}
    # Exudyn needs the springs' ends, and with them what holds these.
    assert left_out(replace(chain, springs=(spring,))) == frozenset()
    assert left_out(replace(wear_times(), joints="none").linkage()) == frozenset()
