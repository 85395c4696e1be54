"""Frames and guides with a spring: closed forms, a press on an elastic frame, bad input.

The press is an upright slider-crank that blanks with 100 kN at 60 strokes a minute. Its
reference values are those of an independent simulator with located events.
"""

from dataclasses import replace

import numpy as np
import pytest
from runs import energy_residual
from upright_press import SHEET, UP, blanked, from_the_top, upright_press

import presswear as pw
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.statics import total_clearance

FINE = InHouse(integrator="dop853", integration_tolerance=1e-12)


def press(
    stiffness: float | None, crown: float = 600.0, damping: float = 0.02
) -> Linkage:
    """Press whose crank turns in a crown on an elastic frame, or a rigid one."""
    if stiffness is None:
        return upright_press()
    frame = pw.Guide(
        "frame", "crown", direction=UP, stiffness=stiffness, damping=damping
    )
    return upright_press(frame=frame, crown=crown)


def test_fracture_on_an_elastic_frame():
    """Reference values of a frame of 50 GN/m; the fracture ends 1.55 mm deep."""
    after = blanked(FINE, press(50e9), 0.44).end.position[1]
    assert after == pytest.approx(-3.003100266e-7, rel=1e-8)
    end = blanked(FINE, press(50e9), 0.435472999210).end
    late = (end.position[10] - (-0.64 + 5e-3 - 1.55e-3)) / end.velocity[10]
    assert abs(late) < 1e-12


def test_a_frame_of_112_hz_in_bodies_and_joints():
    """Steps are a hundredth of the shortest period or less."""
    exact, run = (
        blanked(engine, press(0.5e9), 0.45) for engine in (FINE, ExudynJoints())
    )
    swing = 100e3 / 0.5e9
    assert abs(run.end.position[1] - exact.end.position[1]) < 5e-3 * swing
    assert energy_residual(run) < 0.02  # of 137 J of work
    solver = str(run.diagnostics["solver"])
    assert solver.endswith(
        "no open tree, because drive of crank turns a body that is free to move"
    )


def test_work_that_falls_faster_than_the_frame_is_stiff():
    """The punch snaps through 0.15 mm: 0.67 GN/m against a frame of 0.5 GN/m."""
    coarse, fine = (
        blanked(
            InHouse(integrator="dop853", integration_tolerance=tol), press(0.5e9), 0.45
        )
        for tol in (1e-10, 1e-12)
    )
    off = np.abs(fine.end.position - coarse.end.position)
    assert off.max() < 1e-9
    assert energy_residual(fine) < 1e-9


def test_a_punch_that_turns_back_inside_the_work():
    """A frame of 0.1 GN/m lets the punch in by 1.13 mm, where the sheet breaks at 1.4 mm.

    The work is the area of the law up to there, less that of the elastic line back.
    """
    frame = pw.Guide("frame", "crown", direction=UP, stiffness=1e8, damping=0.0)
    scene = pw.Scene(
        upright_press(frame=frame), process=replace(SHEET, height=2e-3), cycles=1
    )
    run = from_the_top(InHouse(integration_tolerance=1e-10), scene, 1.0)
    assert run.status == "completed", run.message
    lowest = -0.56 + run.recorder.series("displacement").min()
    depth = scene.bottom + 2e-3 - lowest
    assert 1.1e-3 < depth < 1.4e-3
    area = 100e3 * (depth - 0.5 * SHEET.rise)
    back = 0.5 * 100e3 * SHEET.rise
    work = float(run.diagnostics["load_work_J"])
    assert work == pytest.approx(back - area, rel=1e-9)


def test_clearance_and_a_frame_stretch_in_series():
    scene = pw.Scene(press(0.5e9), bearings={"B": pw.Bearing(1e-4, 0.04)})
    loose = total_clearance(scene.linkage(), 100e3)
    stiff = pw.Scene(press(None), bearings={"B": pw.Bearing(1e-4, 0.04)})
    joint = total_clearance(stiff.linkage(), 100e3)
    assert loose == pytest.approx(joint + 4e-4, rel=1e-6)


def test_a_crank_is_driven_on_an_elastic_frame():
    """With clearance the linkage is an open tree with a driven link; Exudyn's has none."""
    linkage = press(0.5e9)
    bearing = pw.Bearing(1e-4, 0.04)
    scene = pw.Scene(linkage, bearings={"B": bearing}, engine="exudyn")
    assert isinstance(scene.solver, ExudynJoints)
    with pytest.raises(pw.InputError, match="crank turns a body that is free to move"):
        replace(scene, engine="exudyn-tree").check()
    fewest, every = (
        blanked(replace(FINE, coordinates=word), linkage, 0.1, B=bearing)
        for word in ("fewest", "all")
    )
    assert "open tree" in str(fewest.diagnostics["model"])
    np.testing.assert_allclose(fewest.end.position, every.end.position, atol=1e-8)
    for name in ("drive_work_J", "load_work_J"):
        pair = (float(run.diagnostics[name]) for run in (fewest, every))
        assert next(pair) == pytest.approx(next(pair), abs=1e-6)


def test_bad_guides_are_refused():
    with pytest.raises(
        pw.InputError, match="stiffness of frame = 0 N/m: allowed is 1000"
    ):
        pw.Guide("frame", "crown", stiffness=0.0)
    with pytest.raises(pw.InputError, match="damping of frame = 2: allowed is 0 to 1"):
        pw.Guide("frame", "crown", stiffness=1e9, damping=2.0)
