"""The press of the reference values: it blanks with 100 kN at 60 strokes a minute."""

import math
from typing import Any

import numpy as np

import presswear as pw
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import Engine
from presswear.linkage.linkage import Linkage

UP = 0.5 * math.pi
SHEET = pw.Blanking(
    force=100e3, height=5e-3, thickness=3e-3, plateau=0.4, rise=2e-4, snap=1.5e-4
)
GUIDE = pw.Guide("guide", "slide", direction=UP)


def upright_crank(**more: Any) -> pw.SliderCrank:
    """Return the press as a slider-crank with more settings."""
    return pw.SliderCrank(
        crank_length=0.04,
        rod_length=0.6,
        crank_mass=60.0,
        rod_mass=50.0,
        slider_mass=300.0,
        speed=2.0 * math.pi,
        **more,
    )


def upright_press(
    motor: pw.Motor | None = None,
    frame: pw.Guide | None = None,
    crown: float = 600.0,
    guide: pw.Guide = GUIDE,
) -> Linkage:
    """Upright slider-crank whose crank turns on the ground, or in a crown on a frame.

    ``crown`` is the mass of the crown, kg.
    """
    bodies = [
        pw.Bar("crank", 0.04, 60.0, 0.5),
        pw.Bar("rod", 0.6, 50.0),
        pw.Body("slide", 300.0),
    ]
    joints = [
        pw.Pin("O", (0.0, 0.0), "crank.tail"),
        pw.Pin("A", "crank.head", "rod.tail"),
        pw.Pin("B", "rod.head", "slide"),
        guide,
    ]
    if frame is not None:
        bodies = [pw.Body("crown", crown), *bodies]
        joints = [frame, pw.Pin("O", "crown", "crank.tail"), *joints[1:]]
    drives = [pw.Drive("crank", 2.0 * math.pi, UP, motor=motor)]
    return pw.assemble(bodies, joints, drives, "slide", {"rod": -UP})


def from_the_top(engine: Engine, scene: pw.Scene, turns: float, cycles: int = 1) -> Run:
    """Run a scene from its ideal motion at the start, over cycles of so many turns."""
    motion = scene.ideal.at(np.zeros(1))
    start = Start(motion.position[0], motion.velocity[0])
    plan = Plan(turns, cycles)
    return engine.for_cycle(1.0).simulate(scene.linkage(), start, plan)


def blanked(
    engine: Engine, linkage: Linkage, turns: float, **bearings: pw.Bearing
) -> Run:
    """Run a press from the top at its nominal speed, until its crank has turned."""
    scene = pw.Scene(
        linkage, process=SHEET, bearings=bearings or pw.Bearing(), cycles=1
    )
    run = from_the_top(engine, scene, turns)
    assert run.status == "completed", run.message
    return run
