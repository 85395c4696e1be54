"""Checks of the engines against closed forms and published solutions."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicHermiteSpline

from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, InHouse
from presswear.linkage.laws import FrictionLaw
from presswear.linkage.linkage import Linkage
from presswear.recording.observe import SERIES_NAMES
from presswear.tools.errors import RunFailed
from presswear.validation import reference_problems as references
from presswear.validation.cases import Case, Check, contacts_of, finished, first_contact, order_of

Array = NDArray[np.float64]

TIGHT = InHouse(integration_tolerance=1e-11)  # the default, 1e-9, leaves 2e-8 in the restitution
NEWTON = 1e-12  # of Exudyn on smooth motion; 1e-9 and above hide the order of the integrator
ANDREWS_STEPS = (1e-5, 5e-6, 2.5e-6)  # s, of Exudyn
EXUDYN_STEPS_PER_CONTACT = {0.9: 50, 0.8: 100, 0.5: 100}  # 50 steps miss 1e-4 at 0.8 and 0.5
SHARP = 1e-6  # m/s above which friction is full in SDND100, 0.001 of the largest speed
FRICTION = FrictionLaw(0.1, 1e-4, 1e-3)  # of the block on incline and flat
GRAVITY = 9.81  # m/s^2
SLOPE = 0.05
BOUNCES = 20
ANDREWS = (
    references.andrews(),
    references.andrews_start(),
    Plan(references.ANDREWS_DURATION, 1, recorded_cycles=1),
)


def _worst(name: str, reference: Sequence[float], computed: Array, bound: float) -> Check:
    i = int(np.argmax(np.abs(computed - np.array(reference))))
    return Check.against(name, float(reference[i]), float(computed[i]), bound)


def andrews_checks() -> Iterator[Check]:
    """Check the angles and rates of Andrews' squeezer at t = 0.03 s, and the order of Exudyn."""
    end = finished(InHouse().simulate(*ANDREWS)).end
    expected = references.ANDREWS_ANGLES
    angles = references.andrews_angles(end.position)
    rates = references.andrews_angles(end.velocity)
    yield _worst("Andrews, dae: worst angle (rad)", expected, angles, 1e-8)
    yield _worst("Andrews, dae: worst rate (rad/s)", references.ANDREWS_RATES, rates, 1e-5)
    solutions = []
    for step in ANDREWS_STEPS:
        # A step one part in 1e9 shorter keeps round-off from removing a step.
        engine = ExudynJoints(50, 10, free_step=step * (1.0 - 1e-9), newton=NEWTON)
        run = finished(engine.simulate(*ANDREWS))
        solutions.append(references.andrews_angles(run.end.position))
    name = f"Andrews, Exudyn, {1e6 * ANDREWS_STEPS[-1]:g} us: worst angle (rad)"
    yield _worst(name, expected, solutions[-1], 1e-5)
    errors = [float(np.abs(angles - np.array(expected)).max()) for angles in solutions]
    yield Check.against("Andrews, Exudyn: order", 2.0, order_of(ANDREWS_STEPS, errors), 0.1)


def delivered(run: Run, speed: float) -> float:
    """Return the restitution of the first contact of a run with a closing speed, m/s."""
    return -first_contact(run)["release_speed"] / speed


def deepest_penetration(run: Run, speed: float) -> float:
    """Return the largest penetration of a free ``Impact`` between the recorded rows, m."""
    recorder = finished(run).recorder
    velocity = recorder.series("velocity")
    # The momentum of ring, 0.3 kg, and shaft, 0.1 kg, is the initial one of the shaft.
    rate = velocity - (speed - velocity) / 3.0
    curve = CubicHermiteSpline(recorder.series("time"), recorder.series("penetration", 0), rate)
    return float(curve(curve.derivative().roots(extrapolate=False)).max())


def impact_checks() -> Iterator[Check]:
    """Check restitution, penetration and duration of one free central impact."""
    plan = Plan(0.005, 1)
    for nominal, expected in references.DELIVERED["lankarani-nikravesh"].items():
        impact = references.Impact(nominal)
        steps = EXUDYN_STEPS_PER_CONTACT[nominal]
        joints = ExudynJoints(steps, 10, free_step=2e-5, newton=1e-10)
        for word, engine, bound in (("dae", TIGHT, 1e-8), (f"Exudyn, {steps} steps", joints, 1e-4)):
            run = engine.simulate(impact.linkage, impact.start, plan)
            name = f"restitution, nominal {nominal}, {word}"
            yield Check.against(name, expected, delivered(run, impact.speed), bound)
    for law in ("hunt-crossley", "flores", "gonthier"):
        for nominal, expected in references.DELIVERED[law].items():
            impact = references.Impact(nominal, law=law)
            run = TIGHT.simulate(impact.linkage, impact.start, plan)
            name = f"restitution, {law}, nominal {nominal}, dae"
            yield Check.against(name, expected, delivered(run, impact.speed), 1e-8)
    impact = references.Impact(0.9, clearance=1e-5)
    run = TIGHT.simulate(impact.linkage, impact.start, Plan(2.2e-4, 1))
    ratio = deepest_penetration(run, impact.speed) / impact.deepest
    yield Check.against("penetration over closed form, dae", 1.0, ratio, 1e-8)
    impact = references.Impact(1.0)
    contact = first_contact(TIGHT.simulate(impact.linkage, impact.start, plan))
    duration = (contact["separation"] - contact["touchdown"]) * impact.speed / impact.deepest
    expected = references.HERTZ_DURATION
    yield Check.against("Hertz: duration (delta_max/v), dae", expected, duration, 1e-8)


def turning_points(run: Run, start: float) -> tuple[Array, Array]:
    """Return times, s, and positions, m, at which the recorded motion changes direction.

    Each is extrapolated from the last row before the turn, because friction changes sign there.

    Parameters
    ----------
    start : float
        Initial recorded coordinate, m.
    """
    recorder = finished(run).recorder
    velocity = recorder.series("velocity")
    before = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    t, x, v, a = (recorder.series(name)[before] for name in SERIES_NAMES)
    left = -v / a
    return t + left, start + x + left * (v + 0.5 * a * left)


def friction_checks() -> Iterator[Check]:
    """Check SDND100, creep on an incline, and slowing on the flat."""
    linkage, start = references.sdnd100(SHARP)
    duration = 4.5 * references.SDND100_INTERVAL
    run = TIGHT.simulate(linkage, start, Plan(duration, 1, recorded_cycles=1))
    released, *extrema = references.SDND100_EXTREMA
    times, positions = turning_points(run, released)
    if len(times) != len(extrema):
        raise RunFailed(f"SDND100: expected {len(extrema)} turning points, found {len(times)}")
    millimetres = [1e3 * x for x in extrema]
    yield _worst("SDND100, dae: worst turning point (mm)", millimetres, 1e3 * positions, 1e-5)
    expected = [references.SDND100_INTERVAL * (k + 1) for k in range(len(extrema))]
    yield _worst("SDND100, dae: its time (s)", expected, times, 1e-5)
    rest = 1e3 * float(run.end.position[0])
    yield Check.against("SDND100, dae: sticks at (mm)", millimetres[-1], rest, 1e-4)
    creeping = references.creep_speed(FRICTION, SLOPE)
    # The approach decays with mu g cos(theta) / (v1 - v0), 1090 per second.
    speed = final_speed(*on_incline(SLOPE, 0.005), 0.2)
    yield Check.against("creep on an incline (mm/s)", 1e3 * creeping, 1e3 * speed, 1e-6)
    for time in (0.005, 0.011):
        slowing = references.slowed_speed(FRICTION, 0.01, GRAVITY, time)
        speed = final_speed(*references.block(0.0, GRAVITY, FRICTION, 0.01), time)
        name = f"slowing on the flat, {1e3 * time:g} ms (mm/s)"
        yield Check.against(name, 1e3 * slowing, 1e3 * speed, 1e-6)


def on_incline(slope: float, speed: float) -> tuple[Linkage, Start]:
    """Return a block on an incline with an initial speed, m/s."""
    angle = math.atan(slope)
    pull, press = GRAVITY * math.sin(angle), GRAVITY * math.cos(angle)
    return references.block(pull, press, FRICTION, speed)


def final_speed(linkage: Linkage, start: Start, time: float) -> float:
    """Return the speed of a block after a time, s, in ``dae``, m/s."""
    run = TIGHT.simulate(linkage, start, Plan(time, 1, recorded_cycles=1))
    return float(finished(run).end.velocity[0])


@dataclass(frozen=True)
class Bounces:
    """Flights between bounces, s, rebound speeds, m/s, and contact times, s."""

    flights: Array
    rebounds: Array
    contacts: Array


def bounced(ball: references.Ball, duration: float) -> Bounces:
    """Run a bouncing ball for a time, s, in ``dae``."""
    run = TIGHT.simulate(ball.linkage, ball.start, Plan(duration, 1, recorded_cycles=1))
    first_contact(run)
    contacts = contacts_of(run)
    touchdown, separation = contacts["touchdown"], contacts["separation"]
    left = np.concatenate([[0.0], separation[:-1]])
    return Bounces(touchdown - left, -contacts["release_speed"], separation - touchdown)


def stiff_limit(values: Sequence[float], ratio: float) -> float:
    """Return the limit for short contacts of a quantity, from its values at two stiffnesses.

    The effect of gravity during contact is proportional to the contact time, K^(-2/5).

    Parameters
    ----------
    ratio : float
        Second stiffness over the first, above 1.
    """
    stiff, stiffer = values
    return stiffer + (stiffer - stiff) / (ratio**0.4 - 1.0)


def bouncing_checks() -> Iterator[Check]:
    """Check twenty bounces of a ball and the total time, with the rest as a geometric series."""
    restitution = references.DELIVERED["lankarani-nikravesh"][0.9]
    stiffer = references.Ball(0.9)
    stiff = replace(stiffer, stiffness=0.1 * stiffer.stiffness)
    series = 2.0 / stiffer.gravity / (1.0 - restitution)
    totals, rebounds = [], []
    for ball in (stiff, stiffer):
        bounces = bounced(ball, 6.0)
        if len(bounces.rebounds) < BOUNCES:
            raise RunFailed(f"expected {BOUNCES} bounces, found {len(bounces.rebounds)}")
        last = float(bounces.rebounds[BOUNCES - 1])
        totals.append(float(bounces.flights[:BOUNCES].sum()) + series * last)
        rebounds.append(last)
    speed = stiffer.speed
    total, rebound = stiff_limit(totals, 10.0), stiff_limit(rebounds, 10.0)
    yield Check.against("bouncing ball, dae: total time (s)", series * speed, total, 1e-6)
    expected = speed * restitution**BOUNCES
    yield Check.against(f"bouncing ball, dae: rebound {BOUNCES} (m/s)", expected, rebound, 1e-6)


_TABLE: dict[str, tuple[Callable[[], Iterator[Check]], str]] = {
    "Andrews' squeezer": (
        andrews_checks,
        "IVP test set (Mazzia and Magherini, University of Bari), after Giles 1978 and Manning "
        "1981; IFToMM library A03. Order 2 is that of the trapezoidal rule.",
    ),
    "impact": (
        impact_checks,
        "Roots e' of (1 + e') chi = ln((1 + chi) / (1 - chi e')) for chi of Lankarani and "
        "Nikravesh 1990, Hunt and Crossley 1975, Flores and others 2011, Gonthier and others 2004; "
        "depth and duration in closed form (Hertz).",
    ),
    "friction": (
        friction_checks,
        "code_aster V5.01.100, test SDND100; creep and slowing under the ramp law in closed form.",
    ),
    "bouncing ball": (
        bouncing_checks,
        "Geometric series of the delivered restitution in the limit of short contacts.",
    ),
}


def reference_cases() -> list[Case]:
    """Return the cases with a published solution or a closed form."""
    return [Case(name, source, "all", checks) for name, (checks, source) in _TABLE.items()]
