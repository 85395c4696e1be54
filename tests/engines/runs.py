"""Runs and linkages that tests of engines share."""

from typing import Any

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import Engine
from presswear.linkage.elements import Attachment, Body, ClearanceJoint, OutputPoint
from presswear.linkage.laws import FrictionLaw, NormalLaw, lankarani_nikravesh_damping
from presswear.linkage.linkage import Linkage, assemble
from presswear.scene.scene import Scene

CLEARANCE = 0.8e-3
FRICTIONLESS = FrictionLaw(0.0)
STIFFNESS = 1.25e10


def run_scene(
    scene: Scene,
    engine: Engine,
    duration: float | None = None,
    linkage: Linkage | None = None,
    **plan: Any,
) -> Run:
    """Run a scene, by default for a cycle and on its own linkage, to the end."""
    period = scene.mechanism.period
    run = engine.for_cycle(period).simulate(
        linkage or scene.linkage(), start_of(scene), Plan(duration or period, 1, **plan)
    )
    assert run.status == "completed", run.message
    return run


def residual(run: Run) -> float:
    """Residual of the energy balance over what the drives exchanged."""
    missing, exchanged = (
        float(run.diagnostics[f"{name}_J"]) for name in ("energy_residual", "drive_exchange")
    )
    return abs(missing) / exchanged


def free_pair(
    restitution: float = 0.9,
    friction: FrictionLaw = FRICTIONLESS,
    bearing: tuple[float, float] = (0.0, 0.0),
    pin: tuple[float, float] = (0.0, 0.0),
    exponent: float = 1.5,
) -> Linkage:
    """Two free bodies, one with a bearing, the other with a pin in it."""
    joint = ClearanceJoint(
        "J",
        Attachment("ring", *bearing),
        Attachment("shaft", *pin),
        bearing_radius=0.015,
        clearance=CLEARANCE,
        width=0.02,
        normal=NormalLaw(STIFFNESS, exponent, lankarani_nikravesh_damping(restitution)),
        friction=friction,
    )
    return assemble(
        (Body("ring", 0.3, 4e-4), Body("shaft", 0.1, 1e-4)),
        output=OutputPoint("shaft"),
        gravity=0.0,
        clearances=(joint,),
    )
