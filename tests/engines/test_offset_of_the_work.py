"""Work beside the middle of a slide: the force tilts the slide, and two corners bear it."""

import math

import numpy as np
import pytest
from marks import slow
from runs import simulated
from upright_press import UP, upright_press

import presswear as pw
from presswear.engines.base import Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.point_position import point_position
from presswear.scene.catalog import scene_named
from presswear.scene.settings import changed

L, W, C = 0.4, 0.3, 0.05e-3  # of the slide and its guide, m
FORCE, OFFSET = 100e3, 0.06  # N, m
CORNER = 15_002.813  # normal force of a corner, N; FORCE * OFFSET / L without tilt
HEIGHT = 1e-3  # of the stop, m
STOP = FORCE / HEIGHT  # its stiffness, N/m
STIFFNESS = 1e12  # of a corner, N/m
ENGINES: list[Engine] = [
    InHouse(integration_tolerance=1e-9),
    ExudynTree(tree_tolerance=1e-9),
    ExudynJoints(),
]
# Time in which the slide settles in its corners, s
SETTLED = 0.02


def press_on_a_stop() -> pw.Scene:
    """Upright press that nearly stands at bottom dead centre, on a stop that bears 100 kN."""
    guide = pw.Guide("guide", "slide", direction=UP, length=L, width=W)
    linkage = upright_press(guide=guide)
    linkage = linkage.changed(drives=[pw.Drive("crank", 1e-2, -UP)])
    bearing = pw.Bearing(
        clearance=C,
        contact_stiffness=STIFFNESS,
        exponent=1.0,
        restitution=0.1,
        friction=0.0,
    )
    stop = pw.Coining(stiffness=STOP, height=HEIGHT, offset=OFFSET)
    return pw.Scene(linkage, bearings={"guide": bearing}, process=stop)


@pytest.mark.parametrize(
    "engine",
    [ENGINES[0], slow(ENGINES[1]), ENGINES[2]],
)
def test_two_opposite_corners_bear_a_force_beside_the_middle(engine: Engine):
    scene = press_on_a_stop()
    linkage = scene.linkage()
    motion = scene.ideal.at(np.zeros(1))
    start = Start(motion.position[0], motion.velocity[0])
    run = simulated(engine, linkage, start, SETTLED)
    corners = np.sort(run.recorder.records.contacts["normal"])
    assert corners[:2].tolist() == [0.0, 0.0]
    _, y, tilt = run.end.position[6:9]
    reach = 0.5 * L * math.sin(tilt) - 0.5 * W * (1.0 - math.cos(tilt))
    normal = float(corners[2:].mean())
    assert reach == pytest.approx(C + normal / STIFFNESS, abs=1e-13)
    # The punch stands higher than the middle of the slide.
    force = STOP * (scene.bottom + HEIGHT - y - OFFSET * math.sin(tilt))
    assert FORCE * normal / force == pytest.approx(CORNER, rel=3e-6)


@pytest.mark.parametrize("bottom", ["lowest", "highest"])
def test_a_positive_offset_lies_to_the_right_with_the_work_below(
    bottom,
):
    press = pw.Press(guide_length=0.1, guide_width=0.05)
    stop = pw.Coining(offset=0.02, bottom=bottom)
    scene = pw.Scene(press, joints="guide", process=stop, cycles=1)
    linkage = scene.linkage()
    (work,) = linkage.loads_with_law
    assert isinstance(work, pw.Force)
    position = scene.ideal.at(np.zeros(1)).position[0]
    middle = point_position(linkage, linkage.output.attachment, position)
    right = 0.02 if bottom == "lowest" else -0.02
    expected = (middle[0] + right, middle[1])
    assert point_position(linkage, work.attachment, position) == pytest.approx(expected)


def test_an_offset_where_nothing_can_tilt():
    scene = changed(scene_named("press-blanking"), {"process.offset": "60 mm"})
    fault = "process.offset = 60 mm: allowed is 0, because the slider cannot tilt"
    with pytest.raises(pw.InputError, match=fault):
        scene.check()
    keys = {"joints": "A, C, guide", "guide_length": "0.1 m", "guide_width": "50 mm"}
    loose = changed(scene, {**keys, "guide.clearance": "0.05 mm"})
    loose.check()
    # The friction of corners does not enter the torques of the ideal motion.
    assert {joint.name for joint in loose.linkage().bushings} == {"A", "C"}
