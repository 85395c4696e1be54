"""Hard cases of one or two free bodies, most of them with a closed form."""

import math
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from hard_case import HardCase, run_sound

from presswear.engines.base import Run, Start
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.bodies import Body
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.normal_law import (
    NormalLaw,
    delivered_restitution,
    lankarani_nikravesh_damping,
)
from presswear.linkage.points import GROUND, Attachment
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.friction_and_normal import ONSET_SPEED_FLOOR
from presswear.physics.packed import mass_of
from presswear.validation import reference_problems as references
from presswear.validation.cases import Check, contacts_of, first_contact, guarded

Checks = Iterator[Check]
DATA = tomllib.loads(Path(__file__).with_name("hard_cases.toml").read_text("utf-8"))

JOINTS = ExudynJoints(100, 10, free_step=2e-5, newton=1e-10)
# Error of the restitution allowed; twice that in kinetic energy
RESTITUTION = {"dae": 1e-6, "exudyn-tree": 1e-5, "exudyn-joints": 1e-4}
# Energy residual allowed at rest; implicit steps grow to a tenth of half a period.
REST_ENERGY = {"dae": 1e-6, "exudyn-joints": 1e-3}
BINS = 360  # of a worn surface
FALL = 1e-9  # m, from which a block falls on the floor
FINEST = 1e-14  # the smallest tolerance of ``dae`` that a scene allows
PIN_MASS = 0.1  # kg
APPROACH = 0.25  # m/s, of the pins
CLEARANCE = 0.8e-3  # m
BORE_STIFFNESS = 1e10  # N/m^1.5
HOUR = "at rest for an hour"  # implicit steps take minutes


def _energy_check(name: str, run: Run, energy: float, bound: float) -> Check:
    residual = float(run.diagnostics["energy_residual_J"])
    return Check(f"energy residual / {name}", residual / energy, bound)


def stays_centred(engine: Engine) -> Checks:
    """Check that a pin at rest exactly in the middle stays there."""
    start = Start(np.zeros(6), np.zeros(6))
    run = run_sound(references.Impact(0.9).linkage, start, engine, guarded(0.01))
    distance = float(np.abs(run.end.position).max())
    yield Check("distance from the middle (m)", distance, 0.0)


def strikes(
    engine: Engine, clearance: float, speed: float, gap: float, nominal: float
) -> Checks:
    """Check restitution and energy of one central impact from a gap, m."""
    impact = references.Impact(nominal, clearance=clearance, speed=speed)
    start = impact.start
    start.position[3] = clearance - gap
    duration = gap / speed + 3.0 * impact.elastic_duration
    if isinstance(engine, ExudynJoints):
        engine = replace(engine, free_step=duration / 50.0)
    run = run_sound(impact.linkage, start, engine, guarded(duration))
    # Below its floor the closing speed in the law is the floor.
    share = min(speed / ONSET_SPEED_FLOOR, 1.0)
    expected = delivered_restitution(share * lankarani_nikravesh_damping(nominal))
    bound = RESTITUTION[engine.word]
    error = references.delivered(run, speed) - expected
    yield Check("restitution less closed form", error, bound)
    yield _energy_check("kinetic", run, 0.5 * PIN_MASS * speed**2, 2.0 * bound)


def rests(engine: Engine, duration: float, speed: float) -> Checks:
    """Check that a block that fell on the floor lies there at the penetration under its weight.

    Its closing speed stays in the law as long as it lies; the initial downward speed is
    in m/s.
    """
    damping = lankarani_nikravesh_damping(0.9)
    linkage, start = references.on_incline(0.0, 0.0, damping)
    sunk = -float(start.position[1])
    falling = Start(np.array([0.0, FALL, 0.0]), np.array([0.0, -speed, 0.0]))
    run = run_sound(linkage, falling, engine, guarded(duration))
    error = -float(run.end.position[1]) / sunk - 1.0
    yield Check("depth at the end / closed form, less 1", error, 1e-6)
    final_speed = float(np.abs(run.end.velocity[:2]).max())
    yield Check("speed at the end (m/s)", final_speed, 1e-7)
    initial = 0.5 * speed**2 + references.GRAVITY * sunk
    yield _energy_check("that at the start", run, initial, REST_ENERGY[engine.word])


def comes_back(engine: Engine, speed: float) -> Checks:
    """Check a block that leaves the floor at nearly zero speed and falls back at once."""
    linkage, start = references.on_incline(0.0, 0.0)
    velocity = np.array([0.0, speed, 0.0])
    run = run_sound(linkage, Start(np.zeros(3), velocity), engine, guarded(0.01))
    fall = -references.GRAVITY * float(start.position[1])
    yield _energy_check("of its fall", run, fall, REST_ENERGY[engine.word])
    pressed = run_sound(linkage, Start(np.zeros(3), -velocity), engine, guarded(0.01))
    error = float(run.end.position[1] / pressed.end.position[1]) - 1.0
    yield Check("depth over that of one that is pressed down, less 1", error, 1e-9)


def creeps(engine: Engine, slope: float) -> Checks:
    """Check the creep of a block on an incline, from rest."""
    linkage, start = references.on_incline(slope, 0.0)
    run = run_sound(linkage, start, engine, guarded(0.2))
    expected = references.creep_speed(references.FRICTION, slope)
    error = float(run.end.velocity[0]) / expected - 1.0
    yield Check("creep / closed form, less 1", error, 1e-5)


def sticks(engine: Engine) -> Checks:
    """Check that a block on the flat ends at the speed below which there is no friction."""
    linkage, start = references.on_incline(0.0, 0.01)
    run = run_sound(linkage, start, engine, guarded(0.1))
    error = float(run.end.velocity[0]) / references.FRICTION.lower - 1.0
    # The floor is a bowl of 10 km, which slows the block by 4e-5 in this time.
    yield Check("speed left / v_0, less 1", error, 1e-4)


def twins() -> tuple[Linkage, Start]:
    """Return a free bar between two pins that move away from each other symmetrically."""
    law = NormalLaw(1.25e10, 1.5, lankarani_nikravesh_damping(0.9))
    bodies = [Body("bar", 0.3, 4e-4)]
    joints = []
    for side, name in ((-1.0, "left"), (1.0, "right")):
        bodies.append(Body(name, PIN_MASS, 1e-4))
        joint = ClearanceJoint(
            name,
            Attachment("bar", 0.1 * side, 0.0),
            Attachment(name, 0.0, 0.0),
            bearing_radius=0.015,
            clearance=CLEARANCE,
            width=0.02,
            normal=law,
            friction=references.FRICTION,
        )
        joints.append(joint)
    linkage = references.free_bodies("twins", tuple(bodies), tuple(joints), "right")
    position = np.zeros((3, 3))
    velocity = np.zeros((3, 3))
    position[1:, 0] = -0.1, 0.1
    velocity[1:, 0] = -APPROACH, APPROACH
    return linkage, Start(position.ravel(), velocity.ravel())


def touch_together(engine: Engine, ahead: float) -> Checks:
    """Check two touchdowns, one nearer by a distance, m, which leave the bar at rest."""
    linkage, start = twins()
    start.position[6] += ahead
    run = run_sound(linkage, start, engine, guarded(0.005))
    left = first_contact(run, 0)
    right = first_contact(run, 1)
    difference = left["touchdown"] - right["touchdown"] - ahead / APPROACH
    yield Check("time between the touches less closed form (s)", difference, 1e-10)
    # Neither pin moves the bar while the second one holds it: an infinite mass for
    # both.
    expected = delivered_restitution(lankarani_nikravesh_damping(0.9))
    bound = RESTITUTION[engine.word]
    worst = max(
        abs(-pin["release_speed"] / APPROACH - expected) for pin in (left, right)
    )
    yield Check("restitution less closed form", worst, bound + 1e5 * ahead)
    yield _energy_check("kinetic", run, PIN_MASS * APPROACH**2, 2.0 * bound)


def worn_pair() -> tuple[Linkage, Start]:
    """Return a ring and a shaft in it, worn differently to half of the clearance, both spinning.

    Mass centres lie off the centres of hole and pin, so that spin and path exchange
    energy through couples, too. The total momentum is zero.
    """
    angle = bin_centres(BINS)
    bearing = 4e-4 * np.exp(-(((angle - 1.5) / 0.4) ** 2))
    bearing += 1e-4 * (1.0 + np.sin(3.0 * angle))
    pin = 2e-4 * np.exp(-(((angle - 4.0) / 0.25) ** 2))
    pin += 5e-5 * (1.0 + np.cos(5.0 * angle))
    joint = ClearanceJoint(
        "J",
        Attachment("ring", 0.01, -0.005),
        Attachment("shaft", -0.004, 0.006),
        bearing_radius=0.015,
        clearance=CLEARANCE,
        width=0.02,
        normal=NormalLaw(1.25e10),
        map_frame="body",
        contact="foundation",
        bearing_surface=Surface(bearing),
        pin_surface=Surface(pin),
    )
    bodies = Body("ring", 0.3, 4e-4), Body("shaft", PIN_MASS, 1e-4)
    linkage = references.free_bodies("worn pair", bodies, (joint,), "shaft")
    position = np.array([-0.01, 0.005, 0.0, 0.004, -0.006, 0.0])
    velocity = np.array([-0.1, 0.05, 9.0, 0.3, -0.15, -14.0])
    return linkage, Start(position, velocity)


def conserves(duration: float, least: int) -> Checks:
    """Check energy and angular momentum of the worn pair over a time, s, and the contacts."""
    linkage, start = worn_pair()
    mass = mass_of(linkage)
    changes = []

    def kinetic_and_angular(state: Start) -> tuple[float, float]:
        """Return kinetic energy, J, and angular momentum about the origin, kg m^2/s."""
        x_momentum, y_momentum, spin = (mass * state.velocity).reshape(-1, 3).T
        x, y, _ = state.position.reshape(-1, 3).T
        angular = float(np.sum(x * y_momentum - y * x_momentum + spin))
        return 0.5 * float(mass @ state.velocity**2), angular

    kinetic, angular = kinetic_and_angular(start)
    for tolerance in (1e-9, FINEST):
        engine = InHouse(integration_tolerance=tolerance)
        run = run_sound(linkage, start, engine, guarded(duration))
        kinetic_end, angular_end = kinetic_and_angular(run.end)
        elastic = float(run.recorder.records.memory["energy"].sum())
        changes.append((kinetic_end + elastic) / kinetic - 1.0)
    contacts = int(run.recorder.records.counters["contacts"].sum())
    yield Check("contacts fewer than wanted", max(least - contacts, 0), 0.0)
    # Errors of contacts are independent, so that their sum grows as a random walk.
    label = f"change of energy / kinetic / root of the contacts, tolerance {FINEST:g}"
    yield Check(label, changes[1] / math.sqrt(contacts), 1e-9)
    yield Check("... over that at tolerance 1e-09", changes[1] / changes[0], 0.1)
    spins = float(np.abs((mass * start.velocity)[2::3]).sum())
    change = (angular_end - angular) / spins
    yield Check("change of angular momentum / spin", change, 1e-12)


def touch_and_part(engine: Engine, x: float, y: float) -> Checks:
    """Check contacts that begin and end at the same instants at two joints, far from the origin, m.

    The round-off of a coordinate grows with its distance from the origin. It makes no
    contacts of its own, and no pin leaves while it closes.
    """
    linkage, start = twins()
    start.position[0::3] += x
    start.position[1::3] += y
    run = run_sound(linkage, start, engine, guarded(0.1))
    contacts = [contacts_of(run, k) for k in range(2)]
    difference = contacts[0]["touchdown"].size - contacts[1]["touchdown"].size
    yield Check("contacts of one joint less those of the other", difference, 0.0)
    fastest = max(float(pins["release_speed"].max()) for pins in contacts)
    yield Check("fastest release above zero (m/s)", max(fastest, 0.0), 0.0)
    durations = [pins["separation"] - pins["touchdown"] for pins in contacts]
    missing = 1e-6 - float(np.concatenate(durations).min())
    yield Check("shortest contact below a microsecond (s)", max(missing, 0.0), 0.0)


def pin_in_bore(clearance: float, damping: float) -> Linkage:
    """Return a free pin in a bore of the frame."""
    joint = ClearanceJoint(
        "bore",
        Attachment(GROUND, 0.0, 0.0),
        Attachment("pin", 0.0, 0.0),
        bearing_radius=0.015,
        clearance=clearance,
        width=0.02,
        normal=NormalLaw(BORE_STIFFNESS, 1.5, damping),
    )
    pin = Body("pin", PIN_MASS, 1e-4)
    return references.free_bodies("bore", (pin,), (joint,), "pin")


def springs_off(engine: Engine, depth: float) -> Checks:
    """Check a pin that is at rest at first, pressed into its bearing by a depth, m."""
    start = Start(np.array([CLEARANCE + depth, 0.0, 0.0]), np.zeros(3))
    energy = BORE_STIFFNESS * depth**2.5 / 2.5
    speed = math.sqrt(2.0 * energy / PIN_MASS)
    duration = 5.0 * depth / speed
    if isinstance(engine, ExudynJoints):
        engine = replace(engine, free_step=duration / 50.0)
    run = run_sound(pin_in_bore(CLEARANCE, 0.0), start, engine, guarded(duration))
    error = float(np.hypot(*run.end.velocity[:2])) / speed - 1.0
    bound = RESTITUTION[engine.word]
    yield Check("speed at the end / closed form, less 1", error, bound)
    yield _energy_check("elastic at the start", run, energy, 2.0 * bound)


def bounces(engine: Engine, clearance: float) -> Checks:
    """Check a pin that bounces between both sides of a bore much smaller than its penetration.

    Each contact gives back the restitution of the law, and the next one closes with
    what the last one gave back. The pin of 0.1 kg at 0.25 m/s penetrates by 14 um.
    """
    damping = lankarani_nikravesh_damping(0.9)
    linkage = pin_in_bore(clearance, damping)
    along = np.array([math.cos(0.3), math.sin(0.3), 0.0])
    start = Start(0.5 * clearance * along, APPROACH * along)
    contacts = contacts_of(run_sound(linkage, start, engine, guarded(2.5e-3)))
    closing = contacts["closing_speed"]
    release = -contacts["release_speed"]
    yield Check("contacts fewer than wanted", max(8 - closing.size, 0), 0.0)
    bound = RESTITUTION[engine.word]
    worst = float(np.abs(release / closing - delivered_restitution(damping)).max())
    yield Check("restitution less closed form", worst, bound)
    worst = float(np.abs(closing[1:] / release[:-1] - 1.0).max())
    yield Check("closing speed over release speed before, less 1", worst, bound)


def impact_cases() -> Iterator[HardCase]:
    """Yield the cases of one or two bodies."""
    functions: tuple[Callable[..., Checks], ...] = (
        stays_centred,
        strikes,
        rests,
        comes_back,
        creeps,
        sticks,
        touch_together,
        touch_and_part,
        springs_off,
        bounces,
    )
    by_name = {function.__name__: function for function in functions}
    for engine in (ExudynTree(), JOINTS, references.TIGHT):
        for name, reason, function, *values in DATA["impacts_in_all_engines"]:
            checks = partial(by_name[function], engine, *values)
            yield HardCase(name, reason, engine.word, checks)
    for engine in (JOINTS, references.TIGHT):
        for name, reason, function, *values in DATA["impacts"]:
            is_calm = engine is JOINTS and function in ("creeps", "sticks", "rests")
            used = replace(JOINTS, free_step=1e-3) if is_calm else engine
            checks = partial(by_name[function], used, *values)
            is_long = is_calm and name == HOUR
            yield HardCase(name, reason, engine.word, checks, is_long=is_long)
    reason = "two free bodies, worn deep and differently, both spinning"
    yield HardCase("worn pair", reason, "dae", partial(conserves, 0.3, 50))
    long = partial(conserves, 6.0, 1000)
    yield HardCase("worn pair, 1,000 contacts", reason, "dae", long, is_long=True)
