"""Andrews' squeezer: linkage, published angles, and checks of the engines."""

import math
from collections.abc import Iterator

import numpy as np

from presswear.engines.base import Plan, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.joints import Revolute
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.loads import Load
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.linkage.spring import Spring
from presswear.tools.arrays import Array
from presswear.validation.cases import (
    Check,
    finished,
    order_of,
    read,
    worst_of,
)

_ANDREWS = read("reference_problems.toml")["andrews"]
ANDREWS_DURATION: float = _ANDREWS["duration"]  # s
ANDREWS_START, ANDREWS_ANGLES, ANDREWS_RATES = np.array(_ANDREWS["angles"]).T
ANDREWS_STEPS = (1e-5, 5e-6, 2.5e-6)  # steps of Exudyn, s
# Tolerance of Exudyn on smooth motion; 1e-9 and above hide the order of the integrator
NEWTON = 1e-12
# Angles of the bodies K1 to K7 from the seven angles of the reference, beta, Theta, gamma,
# Phi, delta, Omega, epsilon: the angles of K2, K4 and K6 are sums of two of them.
_TURNS: Array = np.eye(7)
_TURNS[1, 0] = 1.0  # K2: beta + Theta
_TURNS[3, 4] = 1.0  # K4: Phi + delta
_TURNS[5, 6] = 1.0  # K6: Omega + epsilon


def andrews() -> Linkage:
    """Return Andrews' squeezer: seven bodies, ten pins, one spring, one moment, no gravity."""
    bodies = _ANDREWS["bodies"]
    spring = _ANDREWS["spring"]

    def pin(body: str, name: str) -> Attachment:
        pins = _ANDREWS["frame"] if body == GROUND else bodies[body]["pins"]
        return Attachment(body, *pins[name])

    ends = pin(spring["body"], spring["pin"]), Attachment(GROUND, *spring["frame"])
    joints = []
    for name, first, second in _ANDREWS["joints"]:
        point = name[0]  # the joints at a point have its name with a number
        joints.append(Revolute(name, pin(first, point), pin(second, point)))
    moving = []
    for name in sorted(bodies):
        moving.append(Body(name, bodies[name]["mass"], bodies[name]["inertia"]))
    return assemble(
        name="Andrews' squeezer",
        bodies=moving,
        joints=joints,
        output=OutputPoint("K3", 0.0),
        gravity=0.0,
        springs=(Spring("spring", *ends, spring["stiffness"], spring["length"]),),
        loads=(Load("K1", moment=_ANDREWS["moment"]),),
    )


def andrews_start() -> Start:
    """Return the bodies at rest at the angles ``ANDREWS_START``."""
    angles = _TURNS @ ANDREWS_START
    places = {name: np.array(place) for name, place in _ANDREWS["frame"].items()}
    position = np.zeros(21)
    for body, data in _ANDREWS["bodies"].items():
        i = int(body[1]) - 1
        c = math.cos(angles[i])
        s = math.sin(angles[i])
        pin_offsets = {}  # pins relative to the mass centre, m
        for name, (x, y) in data["pins"].items():
            pin_offsets[name] = np.array([c * x - s * y, s * x + c * y])
        first = next(iter(pin_offsets))  # a pin whose place is known
        centre = places[first] - pin_offsets[first]
        for name, offset in pin_offsets.items():
            places.setdefault(name, centre + offset)
        position[3 * i : 3 * i + 3] = centre[0], centre[1], angles[i]
    return Start(position, np.zeros(21))


def andrews_angles(coordinates: Array) -> Array:
    """Return the seven angles, or their rates, from the coordinates of all bodies, shape (21,)."""
    return np.asarray(
        np.linalg.solve(_TURNS, np.asarray(coordinates)[2::3]), np.float64
    )


def andrews_checks() -> Iterator[Check]:
    """Check the angles and rates of Andrews' squeezer at t = 0.03 s, and the order of Exudyn."""
    problem = andrews(), andrews_start(), Plan(ANDREWS_DURATION, 1, recorded_cycles=1)
    end = finished(InHouse().simulate(*problem)).end
    angles = andrews_angles(end.position)
    rates = andrews_angles(end.velocity)
    yield worst_of("Andrews, dae: worst angle (rad)", ANDREWS_ANGLES, angles, 1e-8)
    yield worst_of("Andrews, dae: worst rate (rad/s)", ANDREWS_RATES, rates, 1e-5)
    errors = []
    for step in ANDREWS_STEPS:
        # A step one part in 1e9 shorter keeps round-off from removing a step.
        engine = ExudynJoints(50, 10, free_step=step * (1.0 - 1e-9), newton=NEWTON)
        angles = andrews_angles(finished(engine.simulate(*problem)).end.position)
        errors.append(float(np.abs(angles - ANDREWS_ANGLES).max()))
    name = f"Andrews, Exudyn, {1e6 * ANDREWS_STEPS[-1]:g} us: worst angle (rad)"
    yield worst_of(name, ANDREWS_ANGLES, angles, 1e-5)
    yield Check.against(
        "Andrews, Exudyn: order", 2.0, order_of(ANDREWS_STEPS, errors), 0.1
    )
