"""Reference problems from the literature: linkages, published values, and checks of the engines."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.integrate import quad
from scipy.interpolate import CubicHermiteSpline

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.linkage import Linkage, assemble
from presswear.linkage.loads import Load
from presswear.linkage.normal_law import (
    DAMPINGS,
    NormalLaw,
    delivered_restitution,
    greatest_penetration,
    lankarani_nikravesh_damping,
)
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.linkage.spring import Spring
from presswear.recording.columns import SERIES, names_of
from presswear.tools.arrays import Array
from presswear.tools.errors import RunFailed
from presswear.validation.andrews import andrews_checks
from presswear.validation.cases import (
    Case,
    Check,
    contacts_of,
    finished,
    first_contact,
    read,
    worst_of,
)

# the default, 1e-9, leaves 2e-8 in the restitution
TIGHT = InHouse(integration_tolerance=1e-11)

_DATA = read("reference_problems.toml")


def free_bodies(
    name: str,
    bodies: Sequence[Body],
    joints: Sequence[ClearanceJoint],
    recorded: str,
    **options: Any,
) -> Linkage:
    """Return bodies that are connected by clearance joints only, without gravity.

    The motion of the body ``recorded`` along x is stored. ``options`` are other arguments
    of ``assemble``, or replace these.
    """
    default: dict[str, Any] = {"output": OutputPoint(recorded, 0.0), "gravity": 0.0}
    return assemble(
        tuple(bodies), name=name, clearances=tuple(joints), **default | options
    )


# Free impact: F = K delta^n (1 + chi delta_dot / v); see ``linkage.normal_law``.
# Duration of an elastic Hertz impact over delta_max / v: 0.8 B(2/5, 1/2).
HERTZ_DURATION = 2.9432751843
# Restitution of an impact by law of damping and nominal restitution
DELIVERED: dict[str, dict[float, float]] = {}
for _law, _values in _DATA["delivered"].items():
    DELIVERED[_law] = {float(nominal): value for nominal, value in _values.items()}
REDUCED_MASS = 0.3 * 0.1 / (0.3 + 0.1)  # reduced mass of ring and shaft, kg
# Steps by nominal restitution; at 0.8 and 0.5 the error of 50 steps is above 1e-4
EXUDYN_STEPS_PER_CONTACT = {0.9: 50, 0.8: 100, 0.5: 100}


# Indices of the x of ring and shaft in the position of ``Impact.linkage``
RING_X = 0
SHAFT_X = 3


@dataclass(frozen=True)
class Impact:
    """Central impact of a free shaft on its free ring."""

    nominal: float  # restitution in the law
    stiffness: float = 1.25e10  # K, N/m^1.5
    speed: float = 0.25  # closing speed, m/s
    clearance: float = 0.8e-3  # m
    law: str = "lankarani-nikravesh"  # key of DAMPINGS

    @property
    def damping(self) -> float:
        """Damping factor chi."""
        return DAMPINGS[self.law].factor(self.nominal)

    @property
    def linkage(self) -> Linkage:
        """Ring of 0.3 kg and shaft of 0.1 kg without constraint."""
        law = NormalLaw(self.stiffness, 1.5, self.damping)
        ends = Attachment("ring", 0.0, 0.0), Attachment("shaft", 0.0, 0.0)
        joint = ClearanceJoint("J", *ends, 0.015, self.clearance, 0.02, law)
        bodies = (Body("ring", 0.3, 4e-4), Body("shaft", 0.1, 1e-4))
        return free_bodies("free impact", bodies, (joint,), "shaft")

    @property
    def start(self) -> Start:
        """Shaft in the middle of the ring, moving along x."""
        return Start(np.zeros(6), np.array([0.0, 0.0, 0.0, self.speed, 0.0, 0.0]))

    @property
    def deepest(self) -> float:
        """Greatest penetration, m."""
        return greatest_penetration(
            REDUCED_MASS, self.speed, self.stiffness, 1.5, self.damping
        )

    @property
    def elastic_duration(self) -> float:
        """Duration of the same impact without damping, s."""
        return HERTZ_DURATION * replace(self, nominal=1.0).deepest / self.speed

    def duration(self) -> tuple[float, float]:
        """Return the contact time for damping above 0 and its uncertainty, s.

        It is the integral of m v du / (K delta^n (1 + chi u)) over u = delta_dot / v
        from -e' to 1, with delta^(n+1) = (n+1) m v^2 / K times a function of u. A
        substitution by the power 1 / (n + 1) of the distance from either end makes the
        integrand smooth.
        """
        chi = self.damping
        n = 1.5
        restitution = delivered_restitution(chi)
        unit = (n + 1.0) * REDUCED_MASS * self.speed**2 / self.stiffness

        def rate(s: float, end: float, sign: float) -> float:
            x = sign * s ** (n + 1.0)  # u - end
            integral = -x / chi + math.log1p(chi * x / (1.0 + chi * end)) / chi**2
            depth = (unit * integral) ** (1.0 / (n + 1.0))
            force = self.stiffness * depth**n * (1.0 + chi * (end + x))
            return REDUCED_MASS * self.speed / force * (n + 1.0) * s**n

        accuracy = {"epsabs": 0.0, "epsrel": 1e-13}
        # From either end to u = 0
        compression, error = quad(rate, 0.0, 1.0, (1.0, -1.0), **accuracy)
        s = restitution ** (1.0 / (n + 1.0))
        expansion, second_error = quad(rate, 0.0, s, (-restitution, 1.0), **accuracy)
        return compression + expansion, error + second_error


def delivered(run: Run, speed: float) -> float:
    """Return the restitution of the first contact of a run with a closing speed, m/s."""
    return -first_contact(run)["release_speed"] / speed


def impact_checks() -> Iterator[Check]:
    """Check restitution, penetration and duration of one free central impact."""
    for law, values in DELIVERED.items():
        for nominal, expected in values.items():
            yield from _restitution_checks(Impact(nominal, law=law), expected)
    impact = Impact(0.9, clearance=1e-5)
    run = TIGHT.simulate(impact.linkage, impact.start, Plan(2.2e-4, 1))
    series = finished(run).recorder.series
    velocity = series("velocity")
    # The momentum of ring, 0.3 kg, and shaft, 0.1 kg, is the initial one of the shaft.
    rate = velocity - (impact.speed - velocity) / 3.0
    curve = CubicHermiteSpline(series("time"), series("penetration", 0), rate)
    deepest = float(curve(curve.derivative().roots(extrapolate=False)).max())
    name = "penetration over closed form, dae"
    yield Check.against(name, 1.0, deepest / impact.deepest, 1e-8)
    impact = Impact(1.0)
    contact = first_contact(TIGHT.simulate(impact.linkage, impact.start, _IMPACT_PLAN))
    duration = contact["separation"] - contact["touchdown"]  # s
    relative = duration * impact.speed / impact.deepest
    name = "Hertz: duration (delta_max/v), dae"
    yield Check.against(name, HERTZ_DURATION, relative, 1e-8)


_IMPACT_PLAN = Plan(0.005, 1)


def _restitution_checks(impact: Impact, expected: float) -> Iterator[Check]:
    """Check the restitution in ``dae``, and in Exudyn with the default law."""
    nominal = impact.nominal
    is_default = impact.law == "lankarani-nikravesh"
    name = f"restitution, nominal {nominal}"
    if not is_default:
        name = f"restitution, {impact.law}, nominal {nominal}"
    run = TIGHT.simulate(impact.linkage, impact.start, _IMPACT_PLAN)
    restitution = delivered(run, impact.speed)
    yield Check.against(f"{name}, dae", expected, restitution, 1e-8)
    if is_default:
        steps = EXUDYN_STEPS_PER_CONTACT[nominal]
        joints = ExudynJoints(steps, 10, free_step=2e-5, newton=1e-10)
        run = joints.simulate(impact.linkage, impact.start, _IMPACT_PLAN)
        restitution = delivered(run, impact.speed)
        name = f"{name}, Exudyn, {steps} steps"
        yield Check.against(name, expected, restitution, 1e-4)


# Mass on a spring with dry friction: code_aster V5.01.100, test SDND100.
SDND100_EXTREMA = (0.85e-3, -0.65e-3, 0.45e-3, -0.25e-3, 0.05e-3)  # m
SDND100_INTERVAL = math.pi / 100.0  # s between two extrema
SDND100_STIFFNESS = 1e4  # N/m
SDND100_GRAVITY = 10.0  # m/s^2
SDND100_FRICTION = 0.1
SHARP = 1e-6  # m/s above which friction is full, 0.001 of the largest speed

# Friction of the block on an incline and on a flat
FRICTION = FrictionLaw(0.1, 1e-4, 1e-3)
GRAVITY = 9.81  # m/s^2
SLOPE = 0.05  # tangent of the incline
_FLOOR_CLEARANCE = 1e4  # m: the slope of the floor changes by 1e-4 in a metre
_FLOOR_STIFFNESS = 1e5  # N/m^1.5


def _block_at(x: float, weight: float) -> Array:
    """Return a block on the floor, at the penetration under its weight, N."""
    sunk = (weight / _FLOOR_STIFFNESS) ** (2.0 / 3.0)
    reach = _FLOOR_CLEARANCE + sunk
    # This is reach - sqrt(reach^2 - x^2), without the difference of nearly equal terms.
    rise = x * x / (reach + math.sqrt(reach**2 - x * x))
    return np.array([x, rise - sunk, 0.0])


def block(
    pull: float,
    press: float,
    friction: FrictionLaw,
    speed: float,
    damping: float = 0.0,
) -> tuple[Linkage, Start]:
    """Return a block of 1 kg that cannot turn on a floor, and its initial state at x = 0.

    The floor is a bearing of 10 km on the frame; ``pull`` and ``press`` are constant
    forces along and into it, N; the initial speed is in m/s.
    """
    ends = Attachment(GROUND, 0.0, _FLOOR_CLEARANCE), Attachment("block", 0.0, 0.0)
    size = _FLOOR_CLEARANCE + 0.01, _FLOOR_CLEARANCE, 0.02  # radius, clearance, width
    normal = NormalLaw(_FLOOR_STIFFNESS, 1.5, damping)
    floor = ClearanceJoint("floor", *ends, *size, normal, friction)
    heavy = Body("block", 1.0, 1e12)
    load = Load("block", x=pull, y=-press)
    linkage = free_bodies(
        "block on a floor", (heavy,), (floor,), "block", loads=(load,)
    )
    return linkage, Start(_block_at(0.0, press), np.array([speed, 0.0, 0.0]))


def on_incline(
    slope: float, speed: float, damping: float = 0.0
) -> tuple[Linkage, Start]:
    """Return a block on an incline with an initial speed, m/s; the damping is of its floor."""
    angle = math.atan(slope)
    pull = GRAVITY * math.sin(angle)
    press = GRAVITY * math.cos(angle)
    return block(pull, press, FRICTION, speed, damping)


def sdnd100(upper: float) -> tuple[Linkage, Start]:
    """Return a mass on a spring of 1 km, released; friction is full above ``upper``, m/s."""
    friction = FrictionLaw(SDND100_FRICTION, 0.0, upper)
    linkage, at_rest = block(0.0, SDND100_GRAVITY, friction, 0.0)
    _, height, _ = at_rest.position
    frame = Attachment(GROUND, -1e3, float(height))
    spring = Spring(
        "spring", frame, Attachment("block", 0.0, 0.0), SDND100_STIFFNESS, 1e3
    )
    release = Start(_block_at(SDND100_EXTREMA[0], SDND100_GRAVITY), np.zeros(3))
    return replace(linkage, name="SDND100", springs=(spring,)), release


def creep_speed(friction: FrictionLaw, slope: float) -> float:
    """Return the speed, m/s, at which a block creeps down an incline of tangent ``slope``.

    The ramp gives mu c_d = tan(theta), so v = v0 + (v1 - v0) tan(theta) / mu.
    """
    width = friction.upper - friction.lower
    return friction.lower + width * slope / friction.coefficient


def _run_of(problem: tuple[Linkage, Start], time: float) -> Run:
    """Return the run of a linkage from its start for a time, s."""
    return finished(TIGHT.simulate(*problem, Plan(time, 1, recorded_cycles=1)))


def friction_checks() -> Iterator[Check]:
    """Check turning points and sticking of SDND100, and the speeds of a sliding block."""
    run = _run_of(sdnd100(SHARP), 4.5 * SDND100_INTERVAL)
    released, *extrema = SDND100_EXTREMA
    # Each turn is extrapolated from the last row before it, because friction changes
    # sign there.
    velocity = run.recorder.series("velocity")
    before = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    if len(before) != len(extrema):
        raise RunFailed(
            f"SDND100: expected {len(extrema)} turning points, found {len(before)}"
        )
    t, x, v, a = (run.recorder.series(name)[before] for name in names_of(SERIES))
    time_to_turn = -v / a
    positions = released + x + time_to_turn * (v + 0.5 * a * time_to_turn)
    millimetres = [1e3 * x for x in extrema]
    name = "SDND100, dae: worst turning point (mm)"
    yield worst_of(name, millimetres, 1e3 * positions, 1e-5)
    expected = [SDND100_INTERVAL * (k + 1) for k in range(len(extrema))]
    yield worst_of("SDND100, dae: its time (s)", expected, t + time_to_turn, 1e-5)
    place = 1e3 * float(run.end.position[0])
    yield Check.against("SDND100, dae: sticks at (mm)", millimetres[-1], place, 1e-4)
    yield from _sliding_checks()


def _sliding_checks() -> Iterator[Check]:
    """Check the speeds of a block that creeps on an incline and of a block that slows."""
    # The approach decays with mu g cos(theta) / (v1 - v0), 1090 per second.
    creeping = creep_speed(FRICTION, SLOPE)
    speed = float(_run_of(on_incline(SLOPE, 0.005), 0.2).end.velocity[0])
    yield Check.against("creep on an incline (mm/s)", 1e3 * creeping, 1e3 * speed, 1e-6)
    # From 10 mm/s a block slows evenly down to v1, then as v0 + (v1 - v0) exp(-mu g t /
    # (v1 - v0)).
    slowing = FRICTION.coefficient * GRAVITY
    width = FRICTION.upper - FRICTION.lower
    for time in (0.005, 0.011):
        late = time - (0.01 - FRICTION.upper) / slowing
        expected_speed = 0.01 - slowing * time
        if late > 0.0:
            expected_speed = FRICTION.lower + width * math.exp(-slowing * late / width)
        speed = float(_run_of(on_incline(0.0, 0.01), time).end.velocity[0])
        name = f"slowing on the flat, {1e3 * time:g} ms (mm/s)"
        yield Check.against(name, 1e3 * expected_speed, 1e3 * speed, 1e-6)


# A ball that is thrown up from the floor of a bearing on the frame.
BALL_SPEED = 3.0  # m/s; the ball stays below the middle of the bearing
BALL_STIFFNESS = 1e13, 1e14  # K, N/m^1.5
BOUNCES = 20


def _bounces(stiffness: float) -> tuple[Array, Array]:
    """Run a ball for 6 s in ``dae``; return its flights, s, and the speeds of its rebounds, m/s."""
    law = NormalLaw(stiffness, 1.5, lankarani_nikravesh_damping(0.9))
    ends = Attachment(GROUND, 0.0, 0.0), Attachment("ball", 0.0, 0.0)
    joint = ClearanceJoint("floor", *ends, 1.05, 1.0, 0.02, law)
    bodies = (Body("ball", 0.1, 1e-4),)
    up = OutputPoint("ball", 0.5 * math.pi)
    options: dict[str, Any] = {"output": up, "gravity": GRAVITY}
    linkage = free_bodies("bouncing ball", bodies, (joint,), "ball", **options)
    start = Start(np.array([0.0, -1.0, 0.0]), np.array([0.0, BALL_SPEED, 0.0]))
    contacts = contacts_of(finished(TIGHT.simulate(linkage, start, Plan(6.0, 1, 1))))
    if len(contacts["touchdown"]) < BOUNCES:
        raise RunFailed(
            f"expected {BOUNCES} bounces, found {len(contacts['touchdown'])}"
        )
    take_off = np.concatenate([[0.0], contacts["separation"][:-1]])
    return contacts["touchdown"] - take_off, -contacts["release_speed"]


def bouncing_checks() -> Iterator[Check]:
    """Check twenty bounces of a ball and the total time, with the rest as a geometric series."""
    restitution = DELIVERED["lankarani-nikravesh"][0.9]
    series = 2.0 / GRAVITY / (1.0 - restitution)
    values = []  # total time, s, and last rebound, m/s, by stiffness
    for flights, speeds in map(_bounces, BALL_STIFFNESS):
        rebound = float(speeds[BOUNCES - 1])
        total = float(flights[:BOUNCES].sum()) + series * rebound
        values.append(np.array([total, rebound]))
    soft, stiff = values
    # The effect of gravity during a contact is proportional to the contact time, K^(-2/5).
    soft_stiffness, stiff_stiffness = BALL_STIFFNESS
    ratio = (stiff_stiffness / soft_stiffness) ** 0.4
    total, rebound = (stiff + (stiff - soft) / (ratio - 1.0)).tolist()
    name = "bouncing ball, dae: total time (s)"
    yield Check.against(name, series * BALL_SPEED, total, 1e-6)
    name = f"bouncing ball, dae: rebound {BOUNCES} (m/s)"
    yield Check.against(name, BALL_SPEED * restitution**BOUNCES, rebound, 1e-6)


def reference_cases() -> list[Case]:
    """Return the cases with a published solution or a closed form."""
    checks = {
        "Andrews' squeezer": andrews_checks,
        "impact": impact_checks,
        "friction": friction_checks,
        "bouncing ball": bouncing_checks,
    }
    sources = _DATA["sources"]
    return [Case(name, sources[name], run) for name, run in checks.items()]
