"""Hard cases of one or two free bodies, most of them with a closed form."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from presswear.engines.base import Run, Start
from presswear.engines.settings import Engine, ExudynJoints, InHouse
from presswear.linkage.elements import Attachment, Body, ClearanceJoint, Linkage, Probe
from presswear.linkage.laws import (
    FrictionLaw,
    NormalLaw,
    delivered_restitution,
    lankarani_nikravesh_damping,
)
from presswear.physics.laws import ONSET_SPEED_FLOOR
from presswear.tools.errors import RunFailed
from presswear.trials.hard.case import Case, Finding, guarded, ran
from presswear.trials.hard.free_pair import kept
from presswear.trials.verify.references import Impact, block, creep_speed

Array = NDArray[np.float64]

TIGHT = InHouse(integration_tolerance=1e-11)
JOINTS = ExudynJoints(100, 10, free_step=2e-5, newton=1e-10)
BOTH: tuple[Engine, ...] = (JOINTS, TIGHT)
RESTITUTION = {"dae": 1e-6, "exudyn-joints": 1e-4}
"""Error allowed in a restitution: 100 times and as much as ``presswear verify`` allows.

Of the kinetic energy twice that may be missing: it goes with the square of the speed.
"""
REST_ENERGY = {"dae": 1e-6, "exudyn-joints": 1e-3}
"""Energy that may be missing at rest; implicit steps grow to a tenth of half a period."""
FALL = 1e-9
"""Height from which a block falls on the floor, m."""
FINEST = 1e-14
"""The smallest tolerance that a scene allows to ``dae``."""
GRAVITY = 9.81
FRICTION = FrictionLaw(0.1, 1e-4, 1e-3)


def first_contacts(run: Run) -> Array:
    """The first contact of every joint, shape (joints, 6); RunFailed if one has none."""
    rows = [run.recorder.episodes(k)[:1] for k in range(len(run.recorder.book.memory))]
    if any(len(row) == 0 for row in rows):
        raise RunFailed("a contact that must happen was not seen")
    return np.concatenate(rows)


def stays_centred(accuracy: Engine) -> Iterator[Finding]:
    """A pin at rest exactly in the middle stays there exactly."""
    impact = Impact(0.9)
    start = Start(np.zeros(6), np.zeros(6))
    run = ran(impact.linkage, start, accuracy, guarded(0.01))
    yield Finding("distance from the middle (m)", float(np.abs(run.end.position).max()), 0.0)


def strikes(
    accuracy: Engine, clearance: float, speed: float, gap: float | None, nominal: float
) -> Iterator[Finding]:
    """One central impact delivers the restitution of its law.

    Parameters
    ----------
    gap : float or None
        Left at the start, m; None starts from the middle.
    """
    impact = Impact(nominal, clearance=clearance, speed=speed)
    start = impact.start
    if gap is not None:
        start.position[3] = clearance - gap
    lasts = impact.elastic_duration
    duration = (clearance if gap is None else gap) / speed + 3.0 * lasts
    if isinstance(accuracy, ExudynJoints):
        accuracy = replace(accuracy, free_step=duration / 50.0)
    run = ran(impact.linkage, start, accuracy, guarded(duration))
    contact = first_contacts(run)[0]
    # Below its floor the closing speed in the law is the floor.
    share = min(speed / ONSET_SPEED_FLOOR, 1.0)
    expected = delivered_restitution(share * lankarani_nikravesh_damping(nominal))
    engine = accuracy.word
    found = -float(contact[3]) / speed
    yield Finding("restitution less closed form", found - expected, RESTITUTION[engine])
    kinetic = 0.5 * 0.1 * speed**2
    residual = float(run.diagnostics["energy_residual_J"]) / kinetic
    yield Finding("energy residual / kinetic", residual, 2.0 * RESTITUTION[engine])


def rests(accuracy: Engine, duration: float, speed: float, damping: float) -> Iterator[Finding]:
    """A block that fell on the floor lies there as deep as its weight presses it.

    Parameters
    ----------
    speed : float
        Downwards at the start, m/s; that at which it meets the floor is kept in the law for
        as long as it lies.
    """
    linkage, start = block(0.0, GRAVITY, FRICTION, 0.0)
    joint = linkage.clearances[0]
    joint = replace(joint, normal=replace(joint.normal, damping=damping))
    linkage = replace(linkage, clearances=(joint,))
    sunk = -float(start.position[1])
    fallen = Start(np.array([0.0, FALL, 0.0]), np.array([0.0, -speed, 0.0]))
    run = ran(linkage, fallen, accuracy, guarded(duration))
    yield Finding("depth at the end / closed form, less 1", -run.end.position[1] / sunk - 1.0, 1e-6)
    moved = float(np.abs(run.end.velocity[:2]).max())
    yield Finding("speed at the end (m/s)", moved, 1e-7)
    begun = 0.5 * speed**2 + GRAVITY * sunk
    residual = float(run.diagnostics["energy_residual_J"]) / begun
    yield Finding("energy residual / that at the start", residual, REST_ENERGY[accuracy.word])


def creeps(accuracy: Engine, slope: float) -> Iterator[Finding]:
    """A block on an incline, from rest, creeps at the speed at which friction holds it."""
    angle = math.atan(slope)
    pull, press = GRAVITY * math.sin(angle), GRAVITY * math.cos(angle)
    run = ran(*block(pull, press, FRICTION, 0.0), accuracy, guarded(0.2))
    expected = creep_speed(FRICTION, slope)
    found = float(run.end.velocity[0]) / expected - 1.0
    yield Finding("creep / closed form, less 1", found, 1e-5)


def sticks(accuracy: Engine) -> Iterator[Finding]:
    """A block that slides out on the flat ends at the speed below which there is no friction."""
    run = ran(*block(0.0, GRAVITY, FRICTION, 0.01), accuracy, guarded(0.1))
    found = float(run.end.velocity[0]) / FRICTION.lower - 1.0
    # The floor is a bowl of 10 km, which slows what no friction holds by 4e-5 in this time.
    yield Finding("speed left / v_0, less 1", found, 1e-4)


def twins() -> tuple[Linkage, Start]:
    """A free bar between two pins that move apart: mirror images of each other."""
    law = NormalLaw(1.25e10, 1.5, lankarani_nikravesh_damping(0.9))
    bodies = [Body("bar", 0.3, 4e-4)]
    joints = []
    for side, name in ((-1.0, "left"), (1.0, "right")):
        bodies.append(Body(name, 0.1, 1e-4))
        ends = Attachment("bar", 0.1 * side, 0.0), Attachment(name, 0.0, 0.0)
        joints.append(ClearanceJoint(name, *ends, 0.015, 0.8e-3, 0.02, law, FRICTION))
    linkage = Linkage(
        "twins", tuple(bodies), (), (), (), tuple(joints), Probe("right", 0.0), gravity=0.0
    )
    position = np.array([0.0, 0.0, 0.0, -0.1, 0.0, 0.0, 0.1, 0.0, 0.0])
    velocity = np.array([0.0, 0.0, 0.0, -0.25, 0.0, 0.0, 0.25, 0.0, 0.0])
    return linkage, Start(position, velocity)


def touch_together(accuracy: Engine, ahead: float) -> Iterator[Finding]:
    """Both pins touch in one instant, or one a little ahead; the bar feels nothing.

    Parameters
    ----------
    ahead : float
        Distance by which one pin is nearer, m.
    """
    linkage, start = twins()
    start.position[6] += ahead
    run = ran(linkage, start, accuracy, guarded(0.005))
    rows = first_contacts(run)
    apart = float(rows[0, 0] - rows[1, 0])
    yield Finding("time between the touches less closed form (s)", apart - ahead / 0.25, 1e-10)
    # Neither pin moves the bar while the other holds it: an infinite mass for both.
    expected = delivered_restitution(lankarani_nikravesh_damping(0.9))
    bound = RESTITUTION[accuracy.word] + 1e5 * ahead
    worst = float(np.abs(-rows[:, 3] / 0.25 - expected).max())
    yield Finding("restitution less closed form", worst, bound)
    residual = float(run.diagnostics["energy_residual_J"]) / (0.1 * 0.25**2)
    energy_bound = 2.0 * RESTITUTION[accuracy.word]
    yield Finding("energy residual / kinetic", residual, energy_bound)


def body_cases() -> Iterator[Case]:
    """All of them."""
    chi = lankarani_nikravesh_damping(0.9)
    for accuracy in BOTH:
        engine = accuracy.word
        implicit = isinstance(accuracy, ExudynJoints)
        calm = replace(JOINTS, free_step=1e-3) if implicit else accuracy

        def case(
            name: str,
            hard: str,
            check: Callable[..., Iterator[Finding]],
            *values: object,
            engine: str = engine,
            long: bool = False,
        ) -> Case:
            return Case(name, hard, engine, partial(check, *values), long=long)

        centred = "the eccentricity has no direction"
        yield case("pin at rest in the middle", centred, stays_centred, accuracy)
        for clearance in (1e-6, 8e-4):
            name = f"from the middle, c = {clearance:g} m"
            yield case(name, centred, strikes, accuracy, clearance, 0.25, None, 0.9)
        for nominal in (0.05, 1.0):
            name = f"one impact, ce = {nominal:g}"
            yield case(name, "an end of the range", strikes, accuracy, 8e-4, 0.25, None, nominal)
        for speed in (1e-3, 1e-6, 1e-9):
            name = f"grazing at {speed:g} m/s"
            yield case(
                name, "the law divides by it", strikes, accuracy, 8e-4, speed, 1e-4 * speed, 0.9
            )
        for ahead in (0.0, 1e-15, 1e-12, 1e-9):
            name = f"two touches, {ahead:g} m apart"
            yield case(name, "two events in one step", touch_together, accuracy, ahead)
        for slope in (0.05, 0.0999):
            yield case(f"creep at a slope of {slope:g}", "starts at rest", creeps, calm, slope)
        yield case("sticking on the flat", "friction's ramp", sticks, calm)
        stale = "its closing speed is long past"
        yield case("at rest for an hour", stale, rests, calm, 3600.0, 0.1, chi, long=implicit)
        yield case(
            "at rest, met at 0.14 mm/s",
            "damping a thousand times stronger",
            rests,
            calm,
            60.0,
            0.0,
            chi,
        )
    unlike = "two free bodies, worn deep and unlike, both spinning"
    yield Case("worn pair", unlike, "dae", partial(keeps, 0.3, 50))
    yield Case("worn pair, 1,000 contacts", unlike, "dae", partial(keeps, 3.8, 1000), long=True)


def keeps(duration: float, least: int) -> Iterator[Finding]:
    """Energy and angular momentum of the worn pair stay what they were.

    Parameters
    ----------
    duration : float
        s.
    least : int
        Contacts that there must be.
    """
    coarse, found = (kept(tolerance, duration) for tolerance in (1e-9, FINEST))
    yield Finding("contacts fewer than wanted", max(least - found.contacts, 0), 0.0)
    yield Finding(f"change of energy / kinetic, tolerance {FINEST:g}", found.energy, 1e-8)
    yield Finding("... over that at tolerance 1e-09", found.energy / coarse.energy, 0.1)
    yield Finding("change of angular momentum / spin", found.momentum, 1e-12)
