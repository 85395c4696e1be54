"""Exudyn's own hollow-sphere contact in C++ against our connector under the same law.

With restitution 1 - (1 - e^2)/2 its Hunt-Crossley law is Lankarani and Nikravesh's
at e, and its friction ramp is ours with v0 = 0.
"""

import exudyn as exu
import numpy as np
import pytest
from numpy.typing import NDArray
from runs import free_pair

from presswear.engines.base import Plan, Start
from presswear.engines.exudyn import add, quiet
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.laws import FrictionLaw
from presswear.linkage.linkage import Linkage

NOMINAL = 0.9
DURATION = 1e-3


def pair(friction: float) -> Linkage:
    """Two free bodies that meet off their mass centres."""
    return free_pair(NOMINAL, FrictionLaw(friction, 0.0, 1e-3), (0.1, 0.02), (-0.05, 0.03))


START = Start(
    np.array([0.0, 0.0, 0.0, 0.15, -0.01, 0.0]), np.array([0.0, 0.0, 2.0, 0.3, 0.4, -30.0])
)


def native(linkage: Linkage, step: float) -> NDArray[np.float64]:
    """Final velocities of both bodies with ``ObjectContactSphereSphere``."""
    joint = linkage.clearances[0]
    container = exu.SystemContainer()
    system = container.AddSystem()
    markers = {}
    for i, body in enumerate(linkage.bodies):
        place = slice(3 * i, 3 * i + 3)
        node = add(
            system,
            "Node",
            "RigidBody2D",
            referenceCoordinates=[0.0, 0.0, 0.0],
            initialCoordinates=list(START.position[place]),
            initialVelocities=list(START.velocity[place]),
        )
        rigid = add(
            system, "Object", "RigidBody2D", mass=body.mass, inertia=body.inertia, nodeNumber=node
        )
        point = joint.bearing if joint.bearing.body == body.name else joint.pin
        local = [point.x, point.y, 0.0]
        markers[body.name] = add(
            system, "Marker", "BodyRigid", bodyNumber=rigid, localPosition=local
        )
    initial = [joint.clearance, 0.0, 0.0, 0.0]
    add(
        system,
        "Object",
        "ContactSphereSphere",
        markerNumbers=[markers[joint.pin.body], markers[joint.bearing.body]],
        nodeNumber=add(
            system, "Node", "GenericData", numberOfDataCoordinates=4, initialCoordinates=initial
        ),
        spheresRadii=[joint.pin_radius, joint.bearing_radius],
        isHollowSphere1=True,
        contactStiffness=joint.normal.stiffness,
        contactStiffnessExponent=joint.normal.exponent,
        contactDamping=0.0,
        impactModel=1,
        restitutionCoefficient=1.0 - 0.5 * (1.0 - NOMINAL**2),
        minimumImpactVelocity=0.0,
        dynamicFriction=joint.friction.coefficient,
        frictionProportionalZone=joint.friction.upper,
    )
    system.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    integration = settings.timeIntegration
    integration.verboseMode = 0
    integration.endTime = DURATION
    integration.numberOfSteps = round(DURATION / step)
    integration.adaptiveStep = True
    integration.minimumStepSize = 1e-14
    integration.newton.relativeTolerance = integration.newton.absoluteTolerance = 1e-12
    integration.newton.useModifiedNewton = True
    with quiet():
        system.SolveDynamic(settings, solverType=exu.DynamicSolverType.TrapezoidalIndex2)
    end = np.array(system.systemData.GetODE2Coordinates_t())
    container.Reset()
    return end


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_native_contact_agrees_with_the_connector(friction: float) -> None:
    """Velocities after one impact of two spinning bodies, relative to the change it makes.

    The native contact's error falls with the square of its step: 2.5e-5, 5e-6 and
    1e-6 at 4e-7, 2e-7 and 1e-7 s; the connector's is 2e-7 at 800 steps per contact.
    """
    linkage = pair(friction)
    plan = Plan(DURATION, 1)
    run = ExudynJoints(800, 10, free_step=2e-5, newton=1e-12).simulate(linkage, START, plan)
    assert run.recorder.records.counters["contacts"][0] == 1
    theirs = native(linkage, 1e-7)
    change = np.abs(run.end.velocity - START.velocity)
    assert change.max() > 1.0
    assert np.abs(theirs - run.end.velocity).max() < 3e-6 * change.max()
    exact = InHouse(integration_tolerance=1e-11).simulate(linkage, START, plan).end.velocity
    assert np.abs(theirs - exact).max() < 3e-6 * change.max()
