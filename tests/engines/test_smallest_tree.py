"""Open trees that hang from moving bodies or from nothing, against the in-house solver.

The in-house solver knows of no prescribed body: it solves for all of them.
"""

from dataclasses import replace

import numpy as np
import pytest
from sub_chains import ARM, PUMP, STEPHENSON
from ten_touches import agreed_over_ten_touches

from presswear.engines.settings import ExudynTree
from presswear.linkage.elements import Attachment
from presswear.linkage.loads import Load, Spring
from presswear.linkage.mechanisms import FOUR_BAR
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import clearance_c, slider_crank
from presswear.scene.scene import Scene

TIGHT = Bearing(clearance=0.3e-3, friction=0.05)

PRESS = clearance_c().mechanism.linkage()
UNEVEN = PRESS.changed(
    drives=[
        replace(PRESS.drives[0], harmonics=[(0.1, 0.3), (0.0, -0.05)]),
        replace(PRESS.drives[1], harmonics=[(0.0, 0.1)]),
    ],
)
SPRUNG = PUMP.changed(
    springs=[
        Spring("s", Attachment("rod", 0.0, 0.0), Attachment("rocker", 0.0, 0.0), 200.0, 0.1, 0.5)
    ],
    loads=[Load("slider", 3.0, -2.0), Load("rod", 0.0, 1.0, 0.2)],
)
SCENES = {
    "press, C": clearance_c(),
    "press, C, drives uneven": Scene(mechanism=UNEVEN, joints="C", wear_updates=0),
    "slider-crank, A and B": slider_crank(
        joints="AB", **{"A.clearance": "0.2 mm", "B.friction": 0.05, "B.normal_law": "flores"}
    ),
    "slider, springs and loads": Scene(
        mechanism=SPRUNG, joints="D", bearings=TIGHT, wear_updates=0
    ),
    "driven forearm": Scene(mechanism=ARM, joints="K", bearings=TIGHT, wear_updates=0),
    "coupler of a six-bar": Scene(mechanism=STEPHENSON, joints="C", bearings=TIGHT, wear_updates=0),
    "loose rocker": Scene(mechanism=FOUR_BAR, joints="BP", bearings=TIGHT, wear_updates=0),
    "loose pair": Scene(mechanism=STEPHENSON, joints="CQ", bearings=TIGHT, wear_updates=0),
}


@pytest.mark.parametrize("name", SCENES)
def test_tree_and_in_house_solver_agree_over_ten_touches(name: str) -> None:
    """1e-8 m, 1e-6 of the torques, and 1e-7 of the energy that drives exchange."""
    scene = SCENES[name]
    assert isinstance(scene.solver, ExudynTree)
    reference, ours = agreed_over_ten_touches(scene, within=1e-8)
    torques = reference.recorder.records.torque
    assert np.abs(torques).min() > 0.0
    np.testing.assert_allclose(ours.recorder.records.torque, torques, rtol=1e-6)
    exchanged = float(reference.diagnostics["drive_exchange_J"])
    work = float(reference.diagnostics["drive_work_J"])
    assert ours.diagnostics["drive_work_J"] == pytest.approx(work, abs=1e-7 * exchanged)
