"""The engines against references that nobody here wrote: what is reached, what is not."""

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
from presswear.validation.runs import Check, Told, contacts_of, finished, order_of
from presswear.validation.verify import references

Array = NDArray[np.float64]

TIGHT = InHouse(integration_tolerance=1e-11)
"""The engine of the impacts; 1e-9, the default, leaves 2e-8 in the restitution."""
NEWTON = 1e-12
"""Tolerance of Exudyn on smooth motion: 1e-9 and above hide the order of the integrator."""
ANDREWS_STEPS = (1e-5, 5e-6, 2.5e-6)
"""Steps of Exudyn on Andrews' squeezer, s."""
EXUDYN_STEPS_PER_CONTACT = {0.9: 50, 0.8: 100, 0.5: 100}
"""Steps in an impact by nominal restitution: with 50 the two lower ones miss 1e-4."""
SHARP = 1e-6
"""Speed above which friction is full in SDND100, m/s: 0.001 of the greatest."""
FRICTION = FrictionLaw(0.1, 1e-4, 1e-3)
"""Friction of the block on incline and flat."""
GRAVITY = 9.81  # m/s^2
SLOPE = 0.05
BOUNCES = 20
ANDREWS = (
    references.andrews(),
    references.andrews_start(),
    Plan(references.ANDREWS_DURATION, 1, recorded_cycles=1),
)


@dataclass(frozen=True)
class Verified(Check):
    """A distance from a reference, both in the unit that its name tells."""

    reference: float = 0.0

    @staticmethod
    def of(quantity: str, reference: float, ours: float, bound: float) -> "Verified":
        """Hold a number against its reference."""
        return Verified(quantity, ours - reference, bound, reference=reference)

    @property
    def cells(self) -> list[str]:
        """Quantity, reference, ours, error and bound, as tables show them."""
        numbers = f"{self.reference:.9g}", f"{self.reference + self.value:.9g}"
        return [self.quantity, *numbers, f"{abs(self.value):.1e}", f"{self.bound:.0e}"]


def _worst(name: str, reference: Sequence[float], ours: Array, bound: float) -> Verified:
    """The component that is furthest off."""
    i = int(np.argmax(np.abs(ours - np.array(reference))))
    return Verified.of(name, float(reference[i]), float(ours[i]), bound)


def andrews_with_exudyn(step: float) -> Array:
    """The seven angles at the end, rad, with equal steps, s."""
    # A step one part in 1e9 shorter keeps round-off from making them one fewer.
    engine = ExudynJoints(50, 10, free_step=step * (1.0 - 1e-9), newton=NEWTON)
    return references.andrews_angles(finished(engine.simulate(*ANDREWS)).end.position)


def andrews_rows() -> Iterator[Verified]:
    """Andrews' squeezer at t = 0.03 s."""
    end = finished(InHouse().simulate(*ANDREWS)).end
    angles = references.andrews_angles(end.position)
    rates = references.andrews_angles(end.velocity)
    yield _worst("Andrews, dae: worst angle (rad)", references.ANDREWS_ANGLES, angles, 1e-8)
    yield _worst("Andrews, dae: worst rate (rad/s)", references.ANDREWS_RATES, rates, 1e-5)
    found = [andrews_with_exudyn(step) for step in ANDREWS_STEPS]
    name = f"Andrews, Exudyn, {1e6 * ANDREWS_STEPS[-1]:g} us: worst angle (rad)"
    yield _worst(name, references.ANDREWS_ANGLES, found[-1], 1e-5)
    errors = [float(np.abs(a - np.array(references.ANDREWS_ANGLES)).max()) for a in found]
    yield Verified.of("Andrews, Exudyn: order", 2.0, order_of(ANDREWS_STEPS, errors), 0.1)


def delivered(run: Run, speed: float) -> float:
    """Restitution of the first contact of a run that met at ``speed``, m/s."""
    return -first_contact(run)["release_speed"] / speed


def first_contact(run: Run, k: int = 0) -> dict[str, float]:
    """First contact of joint ``k`` by ``CONTACT_COLUMNS``, SI; RunFailed if there is none."""
    contacts = contacts_of(finished(run), k)
    if not contacts["touchdown"].size:
        raise RunFailed("a contact that must happen was not seen")
    return {name: float(column[0]) for name, column in contacts.items()}


def deepest_penetration(run: Run, speed: float) -> float:
    """Greatest penetration of a free ``Impact``, m, between the recorded rows too."""
    recorder = finished(run).recorder
    velocity = recorder.series("velocity")
    # The momentum of ring, 0.3 kg, and shaft, 0.1 kg, is the shaft's at the start.
    rate = velocity - (speed - velocity) / 3.0
    course = CubicHermiteSpline(recorder.series("time"), recorder.series("penetration", 0), rate)
    return float(course(course.derivative().roots(extrapolate=False)).max())


def impact_rows() -> Iterator[Verified]:
    """One free central impact."""
    plan = Plan(0.005, 1)
    for nominal, expected in references.DELIVERED["lankarani-nikravesh"].items():
        impact = references.Impact(nominal)
        steps = EXUDYN_STEPS_PER_CONTACT[nominal]
        joints = ExudynJoints(steps, 10, free_step=2e-5, newton=1e-10)
        for word, engine, bound in (("dae", TIGHT, 1e-8), (f"Exudyn, {steps} steps", joints, 1e-4)):
            run = engine.simulate(impact.linkage, impact.start, plan)
            name = f"restitution, nominal {nominal}, {word}"
            yield Verified.of(name, expected, delivered(run, impact.speed), bound)
    for law in ("hunt-crossley", "flores", "gonthier"):
        for nominal, expected in references.DELIVERED[law].items():
            impact = references.Impact(nominal, law=law)
            run = TIGHT.simulate(impact.linkage, impact.start, plan)
            name = f"restitution, {law}, nominal {nominal}, dae"
            yield Verified.of(name, expected, delivered(run, impact.speed), 1e-8)
    impact = references.Impact(0.9, clearance=1e-5)
    run = TIGHT.simulate(impact.linkage, impact.start, Plan(2.2e-4, 1))
    part = deepest_penetration(run, impact.speed) / impact.deepest
    yield Verified.of("penetration over closed form, dae", 1.0, part, 1e-8)
    impact = references.Impact(1.0)
    contact = first_contact(TIGHT.simulate(impact.linkage, impact.start, plan))
    lasted = (contact["separation"] - contact["touchdown"]) * impact.speed / impact.deepest
    expected = references.HERTZ_DURATION
    yield Verified.of("Hertz: duration (delta_max/v), dae", expected, lasted, 1e-8)


def turning_points(run: Run, begin: float) -> tuple[Array, Array]:
    """Times, s, and places, m, at which the watched motion turns round.

    Continued from the last row before each turn: friction changes sign there, so
    that nothing smooth leads across.

    Parameters
    ----------
    begin : float
        Watched coordinate at the start, m.
    """
    recorder = finished(run).recorder
    velocity = recorder.series("velocity")
    before = np.flatnonzero(velocity[:-1] * velocity[1:] < 0.0)
    t, x, v, a = (recorder.series(name)[before] for name in SERIES_NAMES)
    left = -v / a
    return t + left, begin + x + left * (v + 0.5 * a * left)


def friction_rows() -> Iterator[Verified]:
    """Dry friction in a mechanism, with ``dae``."""
    linkage, start = references.sdnd100(SHARP)
    duration = 4.5 * references.SDND100_INTERVAL
    run = TIGHT.simulate(linkage, start, Plan(duration, 1, recorded_cycles=1))
    released, *extrema = references.SDND100_EXTREMA
    times, places = turning_points(run, released)
    if len(times) != len(extrema):
        raise RunFailed(f"SDND100 turned round {len(times)} times instead of {len(extrema)}")
    millimetres = [1e3 * x for x in extrema]
    yield _worst("SDND100, dae: worst turning point (mm)", millimetres, 1e3 * places, 1e-5)
    expected = [references.SDND100_INTERVAL * (k + 1) for k in range(len(extrema))]
    yield _worst("SDND100, dae: its time (s)", expected, times, 1e-5)
    rest = 1e3 * float(run.end.position[0])
    yield Verified.of("SDND100, dae: sticks at (mm)", millimetres[-1], rest, 1e-4)
    creeping = references.creep_speed(FRICTION, SLOPE)
    yield Verified.of("creep on an incline (mm/s)", 1e3 * creeping, 1e3 * creep(SLOPE), 1e-6)
    for time in (0.005, 0.011):
        slowing = references.slowed_speed(FRICTION, 0.01, GRAVITY, time)
        name = f"slowing on the flat, {1e3 * time:g} ms (mm/s)"
        yield Verified.of(name, 1e3 * slowing, 1e3 * slowed(0.01, time), 1e-6)


def slowed(speed: float, time: float) -> float:
    """Speed, m/s, of a block on the flat after a time, s, with ``dae``."""
    return _slid(*references.block(0.0, GRAVITY, FRICTION, speed), time)


def creep(slope: float) -> float:
    """Speed, m/s, of a block on an incline after 0.2 s, with ``dae``.

    The approach decays with mu g cos(theta) / (v1 - v0), 1090 per second.
    """
    return _slid(*on_incline(slope, 0.005), 0.2)


def on_incline(slope: float, speed: float) -> tuple[Linkage, Start]:
    """A block on an incline, at a speed, m/s."""
    angle = math.atan(slope)
    pull, press = GRAVITY * math.sin(angle), GRAVITY * math.cos(angle)
    return references.block(pull, press, FRICTION, speed)


def _slid(linkage: Linkage, start: Start, time: float) -> float:
    run = TIGHT.simulate(linkage, start, Plan(time, 1, recorded_cycles=1))
    return float(finished(run).end.velocity[0])


@dataclass(frozen=True)
class Bounces:
    """Flights between bounces, s, rebound speeds, m/s, and contact times, s."""

    flights: Array
    rebounds: Array
    contacts: Array


def bounced(ball: references.Ball, duration: float) -> Bounces:
    """Follow a ball for a time, s, with ``dae``."""
    run = TIGHT.simulate(ball.linkage, ball.start, Plan(duration, 1, recorded_cycles=1))
    first_contact(run)
    contacts = contacts_of(run)
    touchdown, separation = contacts["touchdown"], contacts["separation"]
    left = np.concatenate([[0.0], separation[:-1]])
    return Bounces(touchdown - left, -contacts["release_speed"], separation - touchdown)


def stiff_limit(values: Sequence[float], ratio: float) -> float:
    """Limit of a quantity as contacts get short, from its values at two stiffnesses.

    Gravity acts during contact too; its effect goes with the contact time, K^(-2/5).

    Parameters
    ----------
    ratio : float
        The second stiffness over the first, above 1.
    """
    stiff, stiffer = values
    return stiffer + (stiffer - stiff) / (ratio**0.4 - 1.0)


def bouncing_rows() -> Iterator[Verified]:
    """A ball that comes to rest: twenty bounces, the rest as a geometric series."""
    restitution = references.DELIVERED["lankarani-nikravesh"][0.9]
    stiffer = references.Ball(0.9)
    stiff = replace(stiffer, stiffness=0.1 * stiffer.stiffness)
    series = 2.0 / stiffer.gravity / (1.0 - restitution)
    totals, rebounds = [], []
    for ball in (stiff, stiffer):
        seen = bounced(ball, 6.0)
        if len(seen.rebounds) < BOUNCES:
            raise RunFailed(f"the ball bounced {len(seen.rebounds)} times, not {BOUNCES}")
        last = float(seen.rebounds[BOUNCES - 1])
        totals.append(float(seen.flights[:BOUNCES].sum()) + series * last)
        rebounds.append(last)
    speed = stiffer.speed
    total, rebound = stiff_limit(totals, 10.0), stiff_limit(rebounds, 10.0)
    yield Verified.of("bouncing ball, dae: total time (s)", series * speed, total, 1e-6)
    expected = speed * restitution**BOUNCES
    yield Verified.of(f"bouncing ball, dae: rebound {BOUNCES} (m/s)", expected, rebound, 1e-6)


@dataclass(frozen=True)
class Problem:
    """Rows that hold the engines against one reference, and where it stands."""

    rows: Callable[[], Iterator[Verified]]
    source: str


PROBLEMS = {
    "Andrews' squeezer": Problem(
        andrews_rows,
        "IVP test set (Mazzia and Magherini, University of Bari), after Giles 1978 and Manning "
        "1981; IFToMM library A03. Order 2 is that of the trapezoidal rule.",
    ),
    "impact": Problem(
        impact_rows,
        "Roots e' of (1 + e') chi = ln((1 + chi) / (1 - chi e')) for chi of Lankarani and "
        "Nikravesh 1990, Hunt and Crossley 1975, Flores and others 2011, Gonthier and others 2004; "
        "depth and duration in closed form (Hertz).",
    ),
    "friction": Problem(
        friction_rows,
        "code_aster V5.01.100, test SDND100; creep and slowing under the ramp law in closed form.",
    ),
    "bouncing ball": Problem(
        bouncing_rows, "Geometric series of the restitution delivered, as contacts get short."
    ),
}
"""The reference problems by name."""


def verify(told: Told) -> list[Verified]:
    """Run every reference problem; RunFailed if one fails, so that there is nothing to compare."""
    rows: list[Verified] = []
    for done, (name, problem) in enumerate(PROBLEMS.items()):
        told(name, done / len(PROBLEMS))
        rows.extend(problem.rows())
    told("done", 1.0)
    return rows
