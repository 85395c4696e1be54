"""Drives along a guide: closed forms, units of results, and messages."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose
from slotted import SPEED, cylinder, loose_scene, with_wheel

import presswear as pw
from presswear.linkage.bodies import Body
from presswear.linkage.drives import Drive, LinearDrive
from presswear.linkage.joints import Guide
from presswear.linkage.linkage import Linkage, assemble
from presswear.physics.ideal import ideal_motion
from presswear.physics.inverse_dynamics import needed_torques
from presswear.results.export import table_of, unit_of
from presswear.show.report import render_report
from presswear.tools.errors import InputError


def lift(direction: float) -> Linkage:
    """Return a slide of 300 kg that a cylinder moves along a line."""
    drive = LinearDrive(
        "slide", along="ways", position=0.2, frequency=6.0, harmonics=[(0.0, 0.04)]
    )
    return assemble(
        bodies=[Body("slide", 300.0)],
        joints=[Guide("ways", "slide", x=0.1, y=0.3, direction=direction, angle=0.4)],
        drives=[drive],
    )


@pytest.mark.parametrize("direction", [0.0, 0.5 * math.pi, 2.5])
def test_force_on_a_slide(direction):
    """s = s_0 + b sin w t; the force is m (g sin(direction) - w^2 b sin w t)."""
    linkage = lift(direction)
    ideal = ideal_motion(linkage, linkage.period)
    time = np.linspace(0.0, linkage.period, 37)
    motion = ideal.at(time)
    place = 0.2 + 0.04 * np.sin(6.0 * time)
    expected = [0.1 + math.cos(direction) * place, 0.3 + math.sin(direction) * place]
    assert_allclose(motion.position[:, :2].T, expected, atol=1e-15)
    force = needed_torques(linkage, ideal, time)[:, 0]
    inertia = -0.04 * 6.0**2 * np.sin(6.0 * time)
    weight = linkage.gravity * math.sin(direction)
    assert_allclose(force, 300.0 * (inertia + weight), atol=1e-9)


def test_results_have_the_units_of_a_force(tmp_path):
    scene = loose_scene(cylinder(), joints="C", cycles=2, replicates=1)
    scene = pw.changed(scene, {"drive_torque": "on", "engine": "dae"})
    result = pw.run(scene, tmp_path / "result")
    table = table_of(result, 0)
    units = {"distance": "m", "velocity": "m/s", "drive_force": "N", "power": "W"}
    for name, unit in units.items():
        assert unit_of(f"piston_{name}") == unit
    power = table["piston_drive_force"] * table["piston_velocity"]
    assert_allclose(table["piston_power"], power)
    phase = SPEED * table["time"]
    place = 0.1 + 0.01 * (np.cos(phase) - 1.0) + 0.04 * np.sin(phase)
    place += 0.004 * np.sin(2.0 * phase)
    assert_allclose(table["piston_distance"], place, atol=1e-12)
    report = render_report(result)
    assert "Peak drive force" in report
    assert "force, largest (kN)" in report
    assert "Peak drive torque" not in report


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"along": "bor"}, "unknown guide in drive of piston 'bor'.*bore"),
        ({"along": "ways"}, "drive of piston: along = ways: this guide is of ram"),
        ({"speed": 3.0}, "speed of piston: a drive along a guide has none; its motion"),
        ({"motor": pw.Motor(stiffness=1e5)}, "motor of piston: a drive along a guide"),
        ({"torque_limit": 5.0}, "torque_limit of piston: a drive along a guide has no"),
        ({"frequency": 0.0}, "frequency of piston = 0 rad/s: with harmonics"),
        ({"harmonics": [("1 deg", "0")]}, "harmonics.*'1 deg'.*mm"),
        (
            {"harmonics": (), "rises": [pw.Rise(0.0, 2.0, 0.1)]},
            "drive of piston along bore: it ends 0.1 m from where it begins",
        ),
    ],
)
def test_wrong_drives_are_refused_by_name(changes, message):
    linkage = cylinder()
    (drive,) = linkage.drives
    values = {name: getattr(drive, name) for name in ("body", "along", "position")}
    values |= {"frequency": SPEED, "harmonics": [(0.0, 0.04)]} | changes
    with pytest.raises(InputError, match=message):
        linkage.changed(drives=[LinearDrive(**values)])


def test_cycle_includes_a_drive_along_a_guide():
    linkage = cylinder()
    both = with_wheel(linkage, *linkage.drives, Drive("wheel", 1.5 * SPEED))
    assert both.period == pytest.approx(2.0 * linkage.period)
