"""Linkages of many kinds: the open tree beside Lagrange multipliers, up to the tenth touchdown."""

import math
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from four_bar_linkage import FOUR_BAR
from numpy.testing import assert_allclose
from runs import residual, run_scene
from slotted import driven_rod, shaper, skew_quick_return
from sub_chains import ARM, PUMP, STEPHENSON

from presswear.engines.base import Run
from presswear.engines.settings import ExudynTree, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.drives import Drive
from presswear.linkage.joints import Pin
from presswear.linkage.linkage import assemble
from presswear.linkage.load_laws import Harmonics, OverPosition, OverTime
from presswear.linkage.loads import Force, Load, Moment
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.points import Attachment
from presswear.linkage.spring import Spring
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import clearance_c
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.validation.cases import contacts_of

TIGHT = Bearing(clearance=0.3e-3, friction=0.05)

PRESS = clearance_c().mechanism.linkage()
UP = 0.5 * math.pi
LOADED = PRESS.changed(
    loads=[
        Force(
            "slider 6", UP, OverPosition([(-0.6, 5.0), (-0.47, 1.0)], outside="hold")
        ),
        Force(
            "slider 6",
            UP,
            OverPosition(
                [(-0.6, 40.0), (-0.57, 20.0), (-0.565, 0.0)], "against", "hold"
            ),
        ),
        Force(
            "slider 6",
            UP,
            OverPosition([(-0.58, 0.0), (-0.57, -30.0)], "along", release=True),
        ),
        Force("plate 4", 0.3, Harmonics(1.0, 40.0, [(2.0, 1.0)])),
        Force("rod 5", 0.3, OverTime([(0.0, 1.0), (0.02, 3.0), (0.03, -2.0)], 0.04)),
        Moment("crank 7", Harmonics(0.0, 1.5, [(0.0, 0.5)])),
    ]
)
SPRUNG = PUMP.changed(
    springs=[
        Spring(
            "s",
            Attachment("rod", 0.0, 0.0),
            Attachment("rocker", 0.0, 0.0),
            200.0,
            0.1,
            0.5,
        )
    ],
    loads=[Load("slider", 3.0, -2.0), Load("rod", 0.0, 1.0, 0.2)],
)
LOOSE = Bearing(clearance=0.8e-3)
_scene = partial(
    Scene,
    engine="exudyn",
    conventions=CONVENTIONS["paper"],
    bearings=TIGHT,
    wear_updates=0,
)
# Linkages, and a time between the tenth touch and the one behind it, s
SCENES = {
    "press, loads of all kinds": (
        _scene(LOADED, joints="A,C", bearings=LOOSE),
        0.01972,
    ),
    "slider, springs and loads": (
        _scene(SPRUNG, joints="D"),
        0.03607,
    ),
    "driven forearm": (
        _scene(ARM, joints="K"),
        0.04774,
    ),
    "loose rocker": (
        _scene(FOUR_BAR, joints="BP"),
        0.01038,
    ),
    "loose pair": (
        _scene(STEPHENSON, joints="CQ"),
        0.03702,
    ),
    "quick return, pivot of the rocker": (
        _scene(skew_quick_return(), joints="O4"),
        0.07725,
    ),
    "shaper, crank and ram": (
        _scene(shaper(), joints="A,C"),
        0.01241,
    ),
    "driven rod in a swinging block": (
        _scene(driven_rod(), joints="B"),
        0.06576,
    ),
}
TOUCHES = 10


def touchdowns(run: Run, joints: int) -> list[float]:
    """Times of all touches, s, in order."""
    return sorted(
        time
        for k in range(joints)
        for time in contacts_of(run, k)["touchdown"].tolist()
    )


@pytest.mark.parametrize("name", SCENES)
def test_engines_agree_over_ten_touches_and_keep_the_energy(name):
    """1e-8 m and s, 1e-6 of the torques, 1e-7 of the energy that drives exchange."""
    scene, duration = SCENES[name]
    fine = InHouse(integration_tolerance=1e-12, coordinates="all")
    joints = len(scene.clearance_joints)
    assert isinstance(scene.solver, ExudynTree)
    engines = fine, ExudynTree(tree_tolerance=1e-11)
    reference, ours = (run_scene(scene, engine, duration) for engine in engines)
    one, other = (touchdowns(run, joints)[: TOUCHES - 1] for run in (reference, ours))
    assert len(one) == TOUCHES - 1  # the last contact may not have ended
    assert_allclose(one, other, atol=1e-8)
    assert np.abs(ours.end.position - reference.end.position).max() < 1e-8
    exchanged = float(reference.diagnostics["drive_exchange_J"])
    assert max(residual(reference), residual(ours)) < 1e-7
    torques = reference.recorder.records.torque
    assert_allclose(ours.recorder.records.torque, torques, rtol=1e-6)
    for work in ("drive_work_J", "load_work_J"):
        expected = pytest.approx(
            float(reference.diagnostics[work]), abs=1e-7 * exchanged
        )
        assert ours.diagnostics[work] == expected


def test_clearance_on_the_frame_runs_in_every_engine():
    """The rocker's pivot on the frame is loose: its bearing stands still."""
    scene, _ = SCENES["loose rocker"]
    solvers = [replace(scene, engine=word).solver for word in ("exudyn-joints", "dae")]
    ends = [
        run_scene(scene, solver, 0.02).end.position
        for solver in (*solvers, scene.solver)
    ]
    assert np.abs(ends[0] - ends[1]).max() < 1e-5
    assert np.abs(ends[1] - ends[2]).max() < 1e-5


@pytest.mark.parametrize(
    "word", ["exudyn-tree", "exudyn-joints", "dae", "dae in all coordinates"]
)
def test_a_slider_without_inertia_moves_as_one_with_inertia(word):
    """The guide keeps the slider from turning, so that its inertia has no effect."""
    crank = SliderCrank(slide_angle=0.0).linkage()
    ends = []
    for inertia in (0.0, 1e-3):
        slider = replace(crank.bodies[2], inertia=inertia)
        scene = Scene(crank.changed(bodies=[*crank.bodies[:2], slider]), joints="B")
        engine = {own.word: own for own in vars(scene.numerics).values()}[
            word.split()[0]
        ]
        if word.endswith("coordinates"):
            engine = replace(engine, coordinates="all")
        run = run_scene(scene, engine, 0.08 * crank.period)
        assert len(run.recorder.stored_contacts(0)) > 0
        ends.append(np.array([run.end.position, run.end.velocity]))
    assert_allclose(ends[0], ends[1], rtol=1e-9, atol=1e-9)


def test_a_body_that_can_turn_needs_inertia():
    bodies = [*FOUR_BAR.bodies[:2], replace(FOUR_BAR.bodies[2], inertia=0.0)]
    with pytest.raises(
        InputError, match=r"inertia of rocker = 0 kg m\^2: must be 1e-18"
    ) as refusal:
        FOUR_BAR.changed(bodies=bodies)
    assert len(str(refusal.value).splitlines()) == 1
    crank = [Body("crank", 1.0)], [Pin("O", (0.0, 0.0), "crank.centre")]
    with pytest.raises(
        InputError, match=r"inertia of crank = 0 kg m\^2: must be 1e-18"
    ):
        assemble(*crank, [Drive("crank", 1.0)])
    assert assemble(*crank, [Drive("crank")], cycle=1.0).bodies[0].inertia == 0.0
