"""A pin that turns in a bushing under a load: steady motion and wear, without chaos.

A crank turns about its tail, which is the pin. The bushing hangs on it, loose, kept
from turning by a very long arm, pressed on by a load and slowed by two dampers. Or
bushing and pin change places.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.linkage.materials import Materials
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.options import Numerics
from presswear.tools.arrays import Array

CLEARANCE = 1e-3
WIDTH = 0.02
FRICTION = 0.05
COEFFICIENT = 1e-15
SPEED = 100.0 * math.pi
CYCLE = 2.0 * math.pi / SPEED
ENGINES: dict[str, Any] = {
    "dae": pw.engines.InHouse(
        integrator="dopri5", integration_tolerance=1e-6, free_step=CYCLE / 40
    ),
    "exudyn-tree": pw.engines.ExudynTree(tree_tolerance=1e-5, free_step=CYCLE / 40),
    "exudyn-joints": pw.engines.ExudynJoints(
        steps_per_contact=20, free_step=CYCLE / 40
    ),
}
ARM = 20.0


def bush(
    radius: float = 0.02,
    load: float = 100.0,
    stiffness: float = 1e9,
    share: float = 1.0,
    angles: int = 120,
    turns: Literal["pin", "bush", "load"] = "pin",
    **settings: Any,
) -> pw.Scene:
    """Return the scene, with radius, m, load, N, stiffness, N/m^1.5, and wear share of the bushing.

    The pin turns in the bushing or the bushing about the pin, while the load presses
    the loose part down; or the load turns with the pin.
    """
    loads: list[pw.Load | pw.Force] = [pw.Load("arm", y=-load)]
    damping = 100.0
    if turns == "load":
        # The load runs ahead of the bushing by a constant angle, after a short time.
        damping = 1000.0
        loads = [
            pw.Force("arm.bore", 0.0, pw.Harmonics(0.0, SPEED, ((load, 0.0),))),
            pw.Force(
                "arm.bore", 0.5 * math.pi, pw.Harmonics(0.0, SPEED, ((0.0, load),))
            ),
        ]
    shoe = 0.1
    ends = ("crank.tail", "arm.bore") if turns == "bush" else ("arm.bore", "crank.tail")
    linkage = pw.assemble(
        # The arm and the shoe are as heavy along as across.
        bodies=[
            pw.Bar("crank", length=0.1, mass=0.1),
            pw.Body("arm", 1.0, shoe * ARM**2, {"bore": (0.0, 0.0), "far": (ARM, 0.0)}),
            pw.Body("shoe", mass=shoe, inertia=1e-3),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("B", *ends),
            pw.Pin("S", "arm.far", "shoe.centre"),
            pw.Guide("G", "shoe"),
        ],
        drives=[pw.Drive("crank", speed=SPEED)],
        guess={"arm": 0.0},
        gravity=0.0,
        springs=[
            pw.Spring("across", "arm.bore", (-50.0, 0.0), 0.0, 50.0, damping),
            pw.Spring("along", "arm.bore", (0.0, -50.0), 0.0, 50.0, damping),
        ],
        loads=loads,
        output="shoe.centre",
    )
    bearing = pw.Bearing(
        clearance=CLEARANCE,
        bearing_radius=radius,
        width=WIDTH,
        materials=Materials(wear_coefficient=COEFFICIENT, bearing_share=share),
        contact_stiffness=stiffness,
        friction=FRICTION,
        normal_law="kelvin-voigt",
        viscous_damping=1e4,
        angles=angles,
    )
    numerics = Numerics(
        *(ENGINES[name] for name in ("exudyn-tree", "exudyn-joints", "dae"))
    )
    settings.setdefault("conventions", CONVENTIONS["refined"])
    settings = {"engine": "dae", "replicates": 1, **settings}
    return pw.Scene(linkage, bearings={"B": bearing}, numerics=numerics, **settings)


@dataclass
class History(Observer):
    """Depth of both surfaces after each cycle behind those at the start."""

    depth: list[Array] = field(default_factory=list)

    def on_cycle(self, recorder: Recorder, state: Callable[[], Any]) -> bool:
        if len(recorder.cycles) > STARTUP_CYCLES:
            self.depth.append(recorder.surface_depth[0].copy())
        return False


@dataclass(frozen=True)
class Worn:
    """Run of a bushing."""

    run: Run
    bush: Array  # (cycles, bins), depth after each cycle, m
    pin: Array
    # (cycles,), normal force times sliding distance in each cycle, N m
    load_distance: Array
    strokes: Array  # (cycles,), real cycles that each cycle stands for
    area: float  # of a bin, m^2


def worn(
    scene: pw.Scene, volume: float, cycles: int, power: float = 1.0, recorded: int = 1
) -> Worn:
    """Run until about a volume, m^3, is worn, which grows as a power of the cycles."""
    joint = scene.linkage().clearances[0]
    loads = [abs(part.y) for part in scene.linkage().loads if isinstance(part, pw.Load)]
    whole = volume / (
        COEFFICIENT * (loads or [100.0])[0] * 2.0 * math.pi * joint.pin_radius
    )
    ends = whole * (np.arange(cycles + 1) / cycles) ** power
    strokes = np.diff(ends)
    history = History()

    def wear(done: int, added: Array, depth: Array) -> Array:
        cycle = done - STARTUP_CYCLES
        return added * (strokes[cycle - 1] if cycle > 0 else 0.0)

    count = cycles + STARTUP_CYCLES
    plan = Plan(CYCLE, count, recorded, torques=False, observers=(history,), wear=wear)
    run = scene.solver.simulate(scene.linkage(), start_of(scene), plan)
    assert run.status == "completed", run.message
    bearing, pin = np.array(history.depth).swapaxes(0, 1)
    load_distance = run.recorder.each_cycle("load_distance", 0)[STARTUP_CYCLES:]
    area = WIDTH * joint.bearing_radius * 2.0 * math.pi / joint.bins
    return Worn(run, bearing, pin, load_distance, strokes, area)
