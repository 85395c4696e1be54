"""Hard cases of one or two free bodies, most of them with a closed form."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Run, Start
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.elements import Attachment, Body, ClearanceJoint
from presswear.linkage.laws import (
    NormalLaw,
    delivered_restitution,
    lankarani_nikravesh_damping,
)
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.friction_and_normal import ONSET_SPEED_FLOOR
from presswear.physics.packed import mass_of
from presswear.validation.cases import Case, Check, first_contact, guarded, run_sound
from presswear.validation.reference_checks import FRICTION, GRAVITY, TIGHT, delivered, on_incline
from presswear.validation.reference_problems import Impact, block, creep_speed, free_bodies

Array = NDArray[np.float64]

JOINTS = ExudynJoints(100, 10, free_step=2e-5, newton=1e-10)
# Errors allowed in a restitution, 100 times and once what ``presswear verify`` allows; twice that
# in the kinetic energy, which goes with the square of the speed.
RESTITUTION = {"dae": 1e-6, "exudyn-joints": 1e-4}
# Energy residual allowed at rest; implicit steps grow to a tenth of half a period.
REST_ENERGY = {"dae": 1e-6, "exudyn-joints": 1e-3}
FALL = 1e-9  # m, from which a block falls on the floor
FINEST = 1e-14  # the smallest tolerance of ``dae`` that a scene allows
PAIR_CLEARANCE, PAIR_BINS = 0.8e-3, 360  # of the worn pair, m
HOUR = "at rest for an hour"  # implicit steps take minutes


def stays_centred(engine: Engine) -> Iterator[Check]:
    """Check that a pin at rest exactly in the middle stays there."""
    start = Start(np.zeros(6), np.zeros(6))
    run = run_sound(Impact(0.9).linkage, start, engine, guarded(0.01))
    yield Check("distance from the middle (m)", float(np.abs(run.end.position).max()), 0.0)


def strikes(
    engine: Engine, clearance: float, speed: float, gap: float | None, nominal: float
) -> Iterator[Check]:
    """Check the restitution and energy of one central impact.

    Parameters
    ----------
    gap : float or None
        Initial gap, m; None starts from the middle.
    """
    impact = Impact(nominal, clearance=clearance, speed=speed)
    start = impact.start
    if gap is not None:
        start.position[3] = clearance - gap
    duration = (clearance if gap is None else gap) / speed + 3.0 * impact.elastic_duration
    if isinstance(engine, ExudynJoints):
        engine = replace(engine, free_step=duration / 50.0)
    run = run_sound(impact.linkage, start, engine, guarded(duration))
    # Below its floor the closing speed in the law is the floor.
    share = min(speed / ONSET_SPEED_FLOOR, 1.0)
    expected = delivered_restitution(share * lankarani_nikravesh_damping(nominal))
    bound = RESTITUTION[engine.word]
    yield Check("restitution less closed form", delivered(run, speed) - expected, bound)
    yield _energy_check("kinetic", run, 0.5 * 0.1 * speed**2, 2.0 * bound)


def _energy_check(name: str, run: Run, energy: float, bound: float) -> Check:
    residual = float(run.diagnostics["energy_residual_J"])
    return Check(f"energy residual / {name}", residual / energy, bound)


def rests(engine: Engine, duration: float, speed: float, damping: float) -> Iterator[Check]:
    """Check that a block that fell on the floor lies there at the penetration under its weight.

    Parameters
    ----------
    speed : float
        Initial downward speed, m/s; the closing speed stays in the law as long as the block lies.
    """
    linkage, start = block(0.0, GRAVITY, FRICTION, 0.0)
    joint = linkage.clearances[0]
    joint = replace(joint, normal=replace(joint.normal, damping=damping))
    linkage = replace(linkage, clearances=(joint,))
    sunk = -float(start.position[1])
    falling = Start(np.array([0.0, FALL, 0.0]), np.array([0.0, -speed, 0.0]))
    run = run_sound(linkage, falling, engine, guarded(duration))
    yield Check("depth at the end / closed form, less 1", -run.end.position[1] / sunk - 1.0, 1e-6)
    moved = float(np.abs(run.end.velocity[:2]).max())
    yield Check("speed at the end (m/s)", moved, 1e-7)
    initial = 0.5 * speed**2 + GRAVITY * sunk
    yield _energy_check("that at the start", run, initial, REST_ENERGY[engine.word])


def comes_back(engine: Engine, speed: float) -> Iterator[Check]:
    """Check a block that leaves the floor at nearly zero speed and falls back at once."""
    linkage, start = block(0.0, GRAVITY, FRICTION, 0.0)
    sunk = -float(start.position[1])
    leaving = Start(np.zeros(3), np.array([0.0, speed, 0.0]))
    run = run_sound(linkage, leaving, engine, guarded(0.01))
    yield _energy_check("of its fall", run, GRAVITY * sunk, REST_ENERGY[engine.word])
    pressing = Start(leaving.position, -leaving.velocity)
    pressed = run_sound(linkage, pressing, engine, guarded(0.01))
    depth = float(run.end.position[1] / pressed.end.position[1])
    yield Check("depth over that of one that is pressed down, less 1", depth - 1.0, 1e-9)


def creeps(engine: Engine, slope: float) -> Iterator[Check]:
    """Check the creep of a block on an incline, from rest."""
    run = run_sound(*on_incline(slope, 0.0), engine, guarded(0.2))
    error = float(run.end.velocity[0]) / creep_speed(FRICTION, slope) - 1.0
    yield Check("creep / closed form, less 1", error, 1e-5)


def sticks(engine: Engine) -> Iterator[Check]:
    """Check that a block on the flat ends at the speed below which there is no friction."""
    run = run_sound(*block(0.0, GRAVITY, FRICTION, 0.01), engine, guarded(0.1))
    error = float(run.end.velocity[0]) / FRICTION.lower - 1.0
    # The floor is a bowl of 10 km, which slows the block by 4e-5 in this time.
    yield Check("speed left / v_0, less 1", error, 1e-4)


def twins() -> tuple[Linkage, Start]:
    """Return a free bar between two pins that move away from each other symmetrically."""
    law = NormalLaw(1.25e10, 1.5, lankarani_nikravesh_damping(0.9))
    bodies = [Body("bar", 0.3, 4e-4)]
    joints = []
    for side, name in ((-1.0, "left"), (1.0, "right")):
        bodies.append(Body(name, 0.1, 1e-4))
        ends = Attachment("bar", 0.1 * side, 0.0), Attachment(name, 0.0, 0.0)
        joints.append(ClearanceJoint(name, *ends, 0.015, 0.8e-3, 0.02, law, FRICTION))
    linkage = free_bodies("twins", tuple(bodies), tuple(joints), "right")
    position = np.array([0.0, 0.0, 0.0, -0.1, 0.0, 0.0, 0.1, 0.0, 0.0])
    velocity = np.array([0.0, 0.0, 0.0, -0.25, 0.0, 0.0, 0.25, 0.0, 0.0])
    return linkage, Start(position, velocity)


def touch_together(engine: Engine, ahead: float) -> Iterator[Check]:
    """Check two touchdowns in one instant, or one a little earlier, which leave the bar at rest.

    Parameters
    ----------
    ahead : float
        Distance by which one pin is nearer, m.
    """
    linkage, start = twins()
    start.position[6] += ahead
    run = run_sound(linkage, start, engine, guarded(0.005))
    left, right = (first_contact(run, k) for k in range(2))
    difference = left["touchdown"] - right["touchdown"]
    name = "time between the touches less closed form (s)"
    yield Check(name, difference - ahead / 0.25, 1e-10)
    # Neither pin moves the bar while the second one holds it: an infinite mass for both.
    expected = delivered_restitution(lankarani_nikravesh_damping(0.9))
    bound = RESTITUTION[engine.word]
    worst = max(abs(-pin["release_speed"] / 0.25 - expected) for pin in (left, right))
    yield Check("restitution less closed form", worst, bound + 1e5 * ahead)
    yield _energy_check("kinetic", run, 0.1 * 0.25**2, 2.0 * bound)


def worn_pair() -> tuple[Linkage, Start]:
    """Return a ring and a shaft in it, worn differently to half of the clearance, both spinning.

    Mass centres lie off the centres of hole and pin, so that spin and path exchange energy through
    couples, too. The total momentum is zero.
    """
    angle = bin_centres(PAIR_BINS)
    joint = ClearanceJoint(
        "J",
        Attachment("ring", 0.01, -0.005),
        Attachment("shaft", -0.004, 0.006),
        bearing_radius=0.015,
        clearance=PAIR_CLEARANCE,
        width=0.02,
        normal=NormalLaw(1.25e10),
        map_frame="body",
        contact="foundation",
        bearing_surface=Surface(
            4e-4 * np.exp(-(((angle - 1.5) / 0.4) ** 2)) + 1e-4 * (1.0 + np.sin(3.0 * angle))
        ),
        pin_surface=Surface(
            2e-4 * np.exp(-(((angle - 4.0) / 0.25) ** 2)) + 5e-5 * (1.0 + np.cos(5.0 * angle))
        ),
    )
    bodies = Body("ring", 0.3, 4e-4), Body("shaft", 0.1, 1e-4)
    position = np.array([-0.01, 0.005, 0.0, 0.004, -0.006, 0.0])
    velocity = np.array([-0.1, 0.05, 9.0, 0.3, -0.15, -14.0])
    return free_bodies("worn pair", bodies, (joint,), "shaft"), Start(position, velocity)


def angular_momentum(linkage: Linkage, state: Start) -> float:
    """Return the angular momentum about the origin, kg m^2/s."""
    p = (mass_of(linkage) * state.velocity).reshape(-1, 3)
    x, y, _ = state.position.reshape(-1, 3).T
    return float(np.sum(x * p[:, 1] - y * p[:, 0] + p[:, 2]))


def kinetic_energy(linkage: Linkage, state: Start) -> float:
    """Return the kinetic energy, J."""
    return 0.5 * float(np.sum(mass_of(linkage) * state.velocity**2))


def conservation_errors(tolerance: float, duration: float) -> tuple[int, float, float]:
    """Run the worn pair for a time, s, in ``dae``.

    Returns
    -------
    tuple of int, float, float
        Number of contacts, change of kinetic and elastic energy relative to the initial kinetic
        energy, and change of angular momentum relative to the sum of the initial spins.
    """
    linkage, start = worn_pair()
    run = run_sound(linkage, start, InHouse(integration_tolerance=tolerance), guarded(duration))
    before = kinetic_energy(linkage, start)
    elastic = float(run.recorder.records.memory["energy"].sum())
    change = kinetic_energy(linkage, run.end) + elastic - before
    turned = angular_momentum(linkage, run.end) - angular_momentum(linkage, start)
    spins = (mass_of(linkage) * start.velocity)[2::3]
    contacts = int(run.recorder.records.counters["contacts"].sum())
    return contacts, change / before, turned / float(np.abs(spins).sum())


def conserves(duration: float, least: int) -> Iterator[Check]:
    """Check energy and angular momentum of the worn pair over a time, s, and the contacts."""
    _, coarse, _ = conservation_errors(1e-9, duration)
    contacts, energy, momentum = conservation_errors(FINEST, duration)
    yield Check("contacts fewer than wanted", max(least - contacts, 0), 0.0)
    # Errors of contacts are independent, so that their sum grows as a random walk.
    label = f"change of energy / kinetic / root of the contacts, tolerance {FINEST:g}"
    yield Check(label, energy / math.sqrt(contacts), 1e-9)
    yield Check("... over that at tolerance 1e-09", energy / coarse, 0.1)
    yield Check("change of angular momentum / spin", momentum, 1e-12)


def impact_cases() -> Iterator[Case]:
    """Yield all hard cases of one or two bodies."""
    for engine in (JOINTS, TIGHT):
        for name, reason, checks in _cases(engine):
            is_long = engine is JOINTS and name == HOUR
            yield Case(name, reason, engine.word, checks, is_long=is_long)
    reason = "two free bodies, worn deep and differently, both spinning"
    yield Case("worn pair", reason, "dae", partial(conserves, 0.3, 50))
    long = partial(conserves, 6.0, 1000)
    yield Case("worn pair, 1,000 contacts", reason, "dae", long, is_long=True)


def _cases(engine: Engine) -> Iterator[tuple[str, str, Callable[[], Iterator[Check]]]]:
    """Yield the name of each case for an engine, the reason why it is hard, and its checks."""
    chi = lankarani_nikravesh_damping(0.9)
    calm = replace(JOINTS, free_step=1e-3) if engine is JOINTS else engine
    centred = "the eccentricity has no direction"
    yield "pin at rest in the middle", centred, partial(stays_centred, engine)
    for clearance in (1e-6, 8e-4):
        strike = partial(strikes, engine, clearance, 0.25, None, 0.9)
        yield f"from the middle, c = {clearance:g} m", centred, strike
    for nominal in (0.05, 1.0):
        strike = partial(strikes, engine, 8e-4, 0.25, None, nominal)
        yield f"one impact, ce = {nominal:g}", "an end of the range", strike
    for speed in (1e-3, 1e-6, 1e-9):
        strike = partial(strikes, engine, 8e-4, speed, 1e-4 * speed, 0.9)
        yield f"grazing at {speed:g} m/s", "the law divides by it", strike
    for ahead in (0.0, 1e-15, 1e-12, 1e-9):
        together = partial(touch_together, engine, ahead)
        yield f"two touches, {ahead:g} m apart", "two events in one step", together
    for slope in (0.05, 0.0999):
        yield f"creep at a slope of {slope:g}", "starts at rest", partial(creeps, calm, slope)
    yield "sticking on the flat", "ramp of the friction law", partial(sticks, calm)
    for speed in (0.0, 1e-15):
        back = partial(comes_back, engine, speed)
        yield f"leaves the floor at {speed:g} m/s", "two touches at once", back
    yield HOUR, "its closing speed is long past", partial(rests, calm, 3600.0, 0.1, chi)
    stronger = "damping a thousand times stronger"
    yield "at rest, met at 0.14 mm/s", stronger, partial(rests, calm, 60.0, 0.0, chi)
