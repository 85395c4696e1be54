"""Reference problems from the literature: linkages, initial states, values and their source."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad

from presswear.engines.base import Start
from presswear.linkage.elements import (
    GROUND,
    Attachment,
    Body,
    ClearanceJoint,
    OutputPoint,
    Revolute,
)
from presswear.linkage.laws import (
    DAMPINGS,
    FrictionLaw,
    NormalLaw,
    delivered_restitution,
    greatest_penetration,
    lankarani_nikravesh_damping,
)
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.loads import Load, Spring

Array = NDArray[np.float64]

# Andrews' squeezer: IVP test set (andrews.f, Mazzia and Magherini, University of Bari),
# after Giles 1978 and Manning 1981; IFToMM library of benchmarks A03.  Angles in the
# order beta, Theta, gamma, Phi, delta, Omega, epsilon.
ANDREWS_DURATION = 0.03  # s
ANDREWS_START = (  # rad, at rest
    -0.0617138900142764496,
    0.0,
    0.455279819163070380,
    0.222668390165885885,
    0.487364979543842550,
    -0.222668390165885885,
    1.23054744454982119,
)
ANDREWS_ANGLES = (  # rad at 0.03 s, PSIDE in double precision
    15.81077119629904,
    -15.75637105984298,
    0.04082224013073101,
    -0.5347301163226948,
    0.5244099658805304,
    0.5347301163226948,
    1.048080741042263,
)
ANDREWS_RATES = (  # rad/s at 0.03 s
    1139.920302151208,
    -1424.379294994111,
    11.03291221937134,
    19.29337464421385,
    0.5735699284790808,
    -19.29337464421385,
    0.3231791658026955,
)

# Lengths of andrews.f, m, with its names.
_D, _DA, _E, _EA = 28e-3, 115e-4, 2e-2, 1421e-5
_RR, _RA, _SS, _SA, _SB, _SC, _SD = 7e-3, 92e-5, 35e-3, 1874e-5, 1043e-5, 18e-3, 2e-2
_TA, _TB, _U, _UA, _UB = 2308e-5, 916e-5, 4e-2, 1228e-5, 449e-5
_ZF, _ZT, _FA = 2e-2, 4e-2, 1421e-5
_A, _B, _C = (-0.06934, -0.00227), (-0.03635, 0.03273), (0.014, 0.072)
_C0, _L0, _MOMENT = 4530.0, 7785e-5, 33e-3

# Pins of each body in the frame of the body, whose x axis has the angle of _TURNS.
_PINS = {
    "K1": {"O": (-_RA, 0.0), "P": (_RR - _RA, 0.0)},
    "K2": {"P": (_DA, 0.0), "Q": (_DA - _D, 0.0)},
    "K3": {"B": (-_SB, _SA), "Q": (-_SB, _SA - _SS), "D": (_SD - _SB, _SA - _SC)},
    "K4": {"Q": (0.0, -_EA), "E": (0.0, _E - _EA)},
    "K5": {"A": (-_TA, _TB), "E": (_ZT - _TA, _TB)},
    "K6": {"Q": (_FA, 0.0), "H": (_FA - _ZF, 0.0)},
    "K7": {"A": (_UB, _UA), "H": (_UB, _UA - _U)},
}

# A pin of each body whose position the frame or the bodies before it determine.
_PARENT_PIN = {"K1": "O", "K2": "P", "K3": "B", "K5": "A", "K7": "A", "K4": "E", "K6": "H"}

# Angles of the seven bodies from the seven angles of the reference.
_TURNS = np.array(
    [
        [1, 0, 0, 0, 0, 0, 0],
        [1, 1, 0, 0, 0, 0, 0],
        [0, 0, 1, 0, 0, 0, 0],
        [0, 0, 0, 1, 1, 0, 0],
        [0, 0, 0, 0, 1, 0, 0],
        [0, 0, 0, 0, 0, 1, 1],
        [0, 0, 0, 0, 0, 0, 1],
    ],
    dtype=float,
)


def free_bodies(
    name: str,
    bodies: tuple[Body, ...],
    joints: tuple[ClearanceJoint, ...],
    probe: str,
    direction: float = 0.0,
    gravity: float = 0.0,
    loads: tuple[Load, ...] = (),
) -> Linkage:
    """Return bodies that are connected by clearance joints only.

    Parameters
    ----------
    probe, direction : str, float
        Body whose motion is recorded, along a direction, rad.
    """
    watch = OutputPoint(probe, direction)
    return assemble(
        bodies, output=watch, name=name, gravity=gravity, loads=loads, clearances=joints
    )


def andrews() -> Linkage:
    """Return Andrews' squeezer: seven bodies, ten pins, one spring, one moment, no gravity."""

    def pin(body: str, name: str) -> Attachment:
        return Attachment(body, *_PINS[body][name])

    def on_frame(place: tuple[float, float]) -> Attachment:
        return Attachment(GROUND, *place)

    return assemble(
        name="Andrews' squeezer",
        bodies=(
            Body("K1", 0.04325, 2.194e-6),
            Body("K2", 0.00365, 4.410e-7),
            Body("K3", 0.02373, 5.255e-6),
            Body("K4", 0.00706, 5.667e-7),
            Body("K5", 0.07050, 1.169e-5),
            Body("K6", 0.00706, 5.667e-7),
            Body("K7", 0.05498, 1.912e-5),
        ),
        joints=(
            Revolute("O", pin("K1", "O"), on_frame((0.0, 0.0))),
            Revolute("P", pin("K1", "P"), pin("K2", "P")),
            Revolute("Q 3", pin("K2", "Q"), pin("K3", "Q")),
            Revolute("Q 4", pin("K2", "Q"), pin("K4", "Q")),
            Revolute("Q 6", pin("K2", "Q"), pin("K6", "Q")),
            Revolute("B", pin("K3", "B"), on_frame(_B)),
            Revolute("A 5", pin("K5", "A"), on_frame(_A)),
            Revolute("A 7", pin("K7", "A"), on_frame(_A)),
            Revolute("E", pin("K4", "E"), pin("K5", "E")),
            Revolute("H", pin("K6", "H"), pin("K7", "H")),
        ),
        output=OutputPoint("K3", 0.0),
        gravity=0.0,
        springs=(Spring("spring", pin("K3", "D"), on_frame(_C), _C0, _L0),),
        loads=(Load("K1", moment=_MOMENT),),
    )


def andrews_start() -> Start:
    """Return the bodies at rest at the angles ``ANDREWS_START``."""
    angles = _TURNS @ np.array(ANDREWS_START)
    places: dict[str, tuple[float, float]] = {"O": (0.0, 0.0), "A": _A, "B": _B}
    position = np.zeros(21)
    for body, pin in _PARENT_PIN.items():
        i = int(body[1]) - 1
        c, s = math.cos(angles[i]), math.sin(angles[i])
        turned = {
            name: np.array([c * x - s * y, s * x + c * y]) for name, (x, y) in _PINS[body].items()
        }
        centre = np.array(places[pin]) - turned[pin]
        for name, point in turned.items():
            x, y = centre + point
            places.setdefault(name, (float(x), float(y)))
        position[3 * i : 3 * i + 3] = centre[0], centre[1], angles[i]
    return Start(position, np.zeros(21))


def andrews_angles(coordinates: Array) -> Array:
    """Return the seven angles, or their rates, from the coordinates of all bodies, shape (21,)."""
    return np.linalg.solve(_TURNS, np.asarray(coordinates)[2::3])


# Free impact: F = K delta^n (1 + chi delta_dot / v); see ``presswear.linkage.laws``.
# Duration of an elastic Hertz impact over delta_max / v: 0.8 B(2/5, 1/2).
HERTZ_DURATION = 2.9432751843
# Delivered restitution by law and nominal value: the root e' of
# (1 + e') chi = ln((1 + chi) / (1 - chi e')) with the damping factor chi of the law.
DELIVERED = {
    "lankarani-nikravesh": {0.9: 0.9131766778, 0.8: 0.8471022798, 0.5: 0.7252411140},
    "hunt-crossley": {0.9: 0.9090157413, 0.8: 0.8328697923, 0.5: 0.6629622000},
    "flores": {0.9: 0.8939206927, 0.8: 0.78853913, 0.5: 0.47044478},
    "gonthier": {0.9: 0.8764354239, 0.8: 0.7679997891, 0.5: 0.48774126},
}


REDUCED_MASS = 0.3 * 0.1 / (0.3 + 0.1)  # kg, of ring and shaft


@dataclass(frozen=True)
class Impact:
    """Central impact of a free shaft on its free ring.

    Attributes
    ----------
    nominal : float
        Restitution in the law, whose name is one of ``DAMPINGS``.
    stiffness : float
        K, N/m^1.5.
    speed, clearance : float
        Closing speed, m/s, and clearance, m.
    """

    nominal: float
    stiffness: float = 1.25e10
    speed: float = 0.25
    clearance: float = 0.8e-3
    law: str = "lankarani-nikravesh"

    @property
    def damping(self) -> float:
        """Damping factor chi."""
        return DAMPINGS[self.law].factor(self.nominal)

    @property
    def linkage(self) -> Linkage:
        """Ring of 0.3 kg and shaft of 0.1 kg without constraint."""
        joint = ClearanceJoint(
            "J",
            Attachment("ring", 0.0, 0.0),
            Attachment("shaft", 0.0, 0.0),
            bearing_radius=0.015,
            clearance=self.clearance,
            width=0.02,
            normal=NormalLaw(self.stiffness, 1.5, self.damping),
        )
        bodies = (Body("ring", 0.3, 4e-4), Body("shaft", 0.1, 1e-4))
        return free_bodies("free impact", bodies, (joint,), "shaft")

    @property
    def start(self) -> Start:
        """Shaft in the middle of the ring, moving along x."""
        return Start(np.zeros(6), np.array([0.0, 0.0, 0.0, self.speed, 0.0, 0.0]))

    @property
    def deepest(self) -> float:
        """Greatest penetration, m."""
        return greatest_penetration(REDUCED_MASS, self.speed, self.stiffness, 1.5, self.damping)

    @property
    def elastic_duration(self) -> float:
        """Duration of the same impact without damping, s."""
        return HERTZ_DURATION * replace(self, nominal=1.0).deepest / self.speed

    def duration(self) -> tuple[float, float]:
        """Return the contact time for damping above 0 and its uncertainty, s.

        With u = delta_dot / v the motion has an integral, G(u) = K delta^(n+1) / ((n+1) m v^2).
        The contact time is the integral of m v du / (K delta(u)^n (1 + chi u)) from -e' to 1.
        delta^n goes with the distance from an end to the power n / (n + 1); a substitution by
        the power 1 / (n + 1) of that distance makes both integrands smooth.
        """
        chi, n = self.damping, 1.5
        restitution = delivered_restitution(chi)
        unit = (n + 1.0) * REDUCED_MASS * self.speed**2 / self.stiffness

        def time(integral: float, u: float, s: float) -> float:
            depth = (unit * integral) ** (1.0 / (n + 1.0))
            slowness = REDUCED_MASS * self.speed / (self.stiffness * depth**n * (1.0 + chi * u))
            return slowness * (n + 1.0) * s**n

        def loading(s: float) -> float:
            d = s ** (n + 1.0)
            return time(d / chi + math.log1p(-chi * d / (1.0 + chi)) / chi**2, 1.0 - d, s)

        def unloading(s: float) -> float:
            d = s ** (n + 1.0)
            integral = -d / chi + math.log1p(chi * d / (1.0 - chi * restitution)) / chi**2
            return time(integral, d - restitution, s)

        ends = (loading, 1.0), (unloading, restitution ** (1.0 / (n + 1.0)))
        parts = [quad(rate, 0.0, end, epsabs=0.0, epsrel=1e-13) for rate, end in ends]
        return sum(part[0] for part in parts), sum(part[1] for part in parts)


# Mass on a spring with dry friction: code_aster V5.01.100, test SDND100.
SDND100_EXTREMA = (0.85e-3, -0.65e-3, 0.45e-3, -0.25e-3, 0.05e-3)  # m
SDND100_INTERVAL = math.pi / 100.0  # s between two extrema
SDND100_STIFFNESS, SDND100_GRAVITY, SDND100_FRICTION = 1e4, 10.0, 0.1

_FLOOR_CLEARANCE = 1e4  # m
_FLOOR_STIFFNESS = 1e5  # N/m^1.5


def _floor(friction: FrictionLaw) -> ClearanceJoint:
    """Return a bearing of 10 km on the frame, whose slope changes by 1e-4 in a metre."""
    return ClearanceJoint(
        "floor",
        bearing=Attachment(GROUND, 0.0, _FLOOR_CLEARANCE),
        pin=Attachment("block", 0.0, 0.0),
        bearing_radius=_FLOOR_CLEARANCE + 0.01,
        clearance=_FLOOR_CLEARANCE,
        width=0.02,
        normal=NormalLaw(_FLOOR_STIFFNESS),
        friction=friction,
    )


def _block_at(x: float, weight: float) -> Array:
    """Return a block on the floor, at the penetration under its weight, N."""
    sunk = (weight / _FLOOR_STIFFNESS) ** (2.0 / 3.0)
    reach = _FLOOR_CLEARANCE + sunk
    # Only the difference of the two nearly equal terms counts.
    return np.array([x, x * x / (reach + math.sqrt(reach**2 - x * x)) - sunk, 0.0])


def block(pull: float, press: float, friction: FrictionLaw, speed: float) -> tuple[Linkage, Start]:
    """Return a block of 1 kg on a floor, which cannot turn, and its initial state at x = 0.

    Parameters
    ----------
    pull, press : float
        Constant forces along the floor and into it, N.
    speed : float
        Initial speed, m/s.
    """
    heavy, load = Body("block", 1.0, 1e12), Load("block", x=pull, y=-press)
    linkage = free_bodies("block on a floor", (heavy,), (_floor(friction),), "block", loads=(load,))
    return linkage, Start(_block_at(0.0, press), np.array([speed, 0.0, 0.0]))


def sdnd100(upper: float) -> tuple[Linkage, Start]:
    """Return a mass on a spring of 1 km, released; friction is full above ``upper``, m/s."""
    friction = FrictionLaw(SDND100_FRICTION, 0.0, upper)
    linkage, rest = block(0.0, SDND100_GRAVITY, friction, 0.0)
    spring = Spring(
        "spring",
        Attachment(GROUND, -1e3, float(rest.position[1])),
        Attachment("block", 0.0, 0.0),
        SDND100_STIFFNESS,
        1e3,
    )
    release = Start(_block_at(SDND100_EXTREMA[0], SDND100_GRAVITY), np.zeros(3))
    return replace(linkage, name="SDND100", springs=(spring,)), release


def creep_speed(friction: FrictionLaw, slope: float) -> float:
    """Return the speed, m/s, at which a block creeps down an incline of tangent ``slope``.

    The ramp gives mu c_d = tan(theta), so v = v0 + (v1 - v0) tan(theta) / mu.
    """
    return friction.lower + (friction.upper - friction.lower) * slope / friction.coefficient


def slowed_speed(friction: FrictionLaw, speed: float, gravity: float, time: float) -> float:
    """Return the speed, m/s, of a block that slows on the flat from above v1.

    V - mu g t down to v1, from there v0 + (v1 - v0) exp(-mu g t / (v1 - v0)).
    """
    slowing = friction.coefficient * gravity
    late = time - (speed - friction.upper) / slowing
    if late <= 0.0:
        return speed - slowing * time
    width = friction.upper - friction.lower
    return friction.lower + width * math.exp(-slowing * late / width)


@dataclass(frozen=True)
class Ball:
    """Ball that is thrown up from the floor of a large bearing on the frame.

    Attributes
    ----------
    nominal : float
        Restitution in the law of Lankarani and Nikravesh.
    stiffness : float
        K, N/m^1.5; the effect of gravity during contact falls with the contact time, K^(-2/5).
    speed : float
        Initial upward speed, m/s; the ball stays below the middle of the bearing.
    """

    nominal: float
    stiffness: float = 1e14
    speed: float = 3.0
    gravity: float = 9.81

    @property
    def linkage(self) -> Linkage:
        """Pin of 0.1 kg in a bearing with a clearance of 1 m."""
        joint = ClearanceJoint(
            "floor",
            bearing=Attachment(GROUND, 0.0, 0.0),
            pin=Attachment("ball", 0.0, 0.0),
            bearing_radius=1.05,
            clearance=1.0,
            width=0.02,
            normal=NormalLaw(self.stiffness, 1.5, lankarani_nikravesh_damping(self.nominal)),
        )
        bodies = (Body("ball", 0.1, 1e-4),)
        upwards = math.pi / 2.0
        return free_bodies("bouncing ball", bodies, (joint,), "ball", upwards, self.gravity)

    @property
    def start(self) -> Start:
        """Ball on the floor, moving up."""
        return Start(np.array([0.0, -1.0, 0.0]), np.array([0.0, self.speed, 0.0]))
