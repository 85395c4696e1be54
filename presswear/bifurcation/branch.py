"""One way through the values of a quantity, each run going on from where the last one ended."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from presswear.bifurcation.flow import exponent
from presswear.bifurcation.orders import HIGHEST, Orders, orders_of
from presswear.bifurcation.over import Extent, Over
from presswear.campaign.replicates import start_of, turned_back
from presswear.engines.base import Plan, Start
from presswear.engines.settings import InHouse
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.packed import pack
from presswear.recording.observe import SECTION_JOINT_NAMES, SECTION_NAMES
from presswear.scene.scene import Scene
from presswear.tools.arrays import read_numbers, write_arrays
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.workers import Report

Array = NDArray[np.float64]

ENGINE = InHouse("dopri5", 1e-6)
"""Places of periodic slider-cranks are within 6e-4 of the clearance of those at 1e-9; a period is
asked for to 1e-2."""
PHASES = (0.25, 0.5, 0.75, 1.0)
"""Parts of the cycle at which states are kept."""
OPEN = 1e-4
"""Least gap of a pin where a run goes on with another value, part of the clearance."""
_STEPS = 8
"""Newton steps that move pins to their places; three are enough."""


@dataclass(frozen=True)
class Points:
    """What was found at the values of a branch, in the order in which they were run.

    Attributes
    ----------
    value : ndarray, shape (n,)
        SI.
    sections : ndarray, shape (n, kept, phases, columns)
        See ``Recorder.sections``; NaN where a run failed.
    force : ndarray, shape (n, kept, joints)
        Peak normal force of each cycle, N.
    exponent : ndarray, shape (n, 2)
        Largest Lyapunov exponent and the half width of its interval, 1/s; NaN where there is none.
    amplitude : ndarray, shape (n, 1 + joints, orders)
    resonance : ndarray, shape (n, joints)
        See ``Orders``; no orders where none are sought.
    end : ndarray, shape (2, 3 bodies)
        Positions and velocities at the end of the last run.
    """

    value: Array
    sections: Array
    force: Array
    exponent: Array
    amplitude: Array
    resonance: Array
    end: Array

    def and_point(self, value: float, found: "Point") -> "Points":
        """The points and one more."""
        return Points(
            np.append(self.value, value),
            np.concatenate([self.sections, found.sections[None]]),
            np.concatenate([self.force, found.force[None]]),
            np.concatenate([self.exponent, [found.exponent]]),
            np.concatenate([self.amplitude, [found.orders.amplitude]]),
            np.concatenate([self.resonance, [found.orders.resonance]]),
            np.array([found.end.position, found.end.velocity]),
        )

    def eccentricity(self, joint: int) -> Array:
        """Places of a joint's pin at the phases, shape (n, kept, phases, 2), m."""
        first = len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * joint
        x, y = (SECTION_JOINT_NAMES.index(f"eccentricity_{axis}") for axis in "xy")
        return self.sections[..., [first + x, first + y]]


@dataclass(frozen=True)
class Point:
    """What was found at one value; see ``Points``."""

    sections: Array
    force: Array
    exponent: tuple[float, float]
    orders: Orders
    end: Start


def moved(linkage: Linkage, before: Linkage, end: Start, begun: Start) -> Start:
    """The end of a run of one linkage, after whole cycles, as the start of another.

    Pins keep their places in parts of the clearance, but for contacts, which open; velocities go
    with the speed of the first drive, and both are then moved as little as the constraints and
    the drives need.

    Parameters
    ----------
    begun : Start
        Start of the ideal linkage, which tells the full turns of its bodies.
    """
    ratios = [
        own.clearance / old.clearance
        for own, old in zip(linkage.clearances, before.clearances, strict=True)
    ]
    constraints = constraints_of(linkage)
    position = turned_back(end, begun).position
    places = _eccentricities(linkage)
    wanted = places(position).reshape(-1, 2) * np.array(ratios)[:, None]
    # Latched where it starts, the closing speed of a pin at rest in a contact would be next to
    # nothing, and the damping without bound: pins start open.
    gaps = np.array([joint.clearance for joint in linkage.clearances])
    far = np.hypot(*wanted.T) / ((1.0 - OPEN) * gaps)
    wanted = (wanted / np.maximum(far, 1.0)[:, None]).ravel()
    rest = np.zeros_like(position)
    for _ in range(_STEPS):
        phi, _, _, jacobian = constraints.evaluate(0.0, position, rest)
        off = np.concatenate([phi, places(position) - wanted])
        slopes = np.concatenate([jacobian, _slopes(places, position)])
        position -= np.linalg.lstsq(slopes, off, rcond=None)[0]
    velocity = end.velocity * (linkage.drives[0].speed / before.drives[0].speed)
    _, error, _, jacobian = constraints.evaluate(0.0, position, velocity)
    return Start(position, velocity - np.linalg.pinv(jacobian) @ error)


def _eccentricities(linkage: Linkage) -> Callable[[Array], Array]:
    """Places of the pins in their bearings over the positions of all bodies, shape (2 joints,)."""
    packed, contacts = pack(linkage, False), np.zeros(len(linkage.clearances), CONTACT)

    def places(position: Array) -> Array:
        note_contacts(packed, contacts, position, np.zeros_like(position))
        return np.column_stack([contacts["eccentricity_x"], contacts["eccentricity_y"]]).ravel()

    return places


def _slopes(places: Callable[[Array], Array], position: Array, step: float = 1e-6) -> Array:
    """Derivatives of the places by central differences."""
    columns = []
    for k in range(position.size):
        shift = np.zeros_like(position)
        shift[k] = step
        columns.append((places(position + shift) - places(position - shift)) / (2.0 * step))
    return np.transpose(columns)


def point(scene: Scene, start: Start, extent: Extent) -> Point:
    """Run a scene's unworn linkage from a start; where it fails its numbers are NaN."""
    linkage, period = scene.linkage(), scene.mechanism.period
    plan = Plan(period, extent.cycles, 1, sections=PHASES, torques=False)
    run = ENGINE.simulate(linkage, start, plan)
    joints, kept = len(linkage.clearances), extent.kept
    told, orders = (math.nan, math.nan), Orders.none(joints, HIGHEST if extent.order_cycles else 0)
    if run.status == "failed":
        sections = run.recorder.sections
        empty = np.full((kept, *sections.shape[1:]), math.nan)
        return Point(empty, np.full((kept, joints), math.nan), told, orders, start_of(scene))
    force = [run.recorder.each_cycle("force_max", k) for k in range(joints)]
    end = moved(linkage, linkage, run.end, start)
    if extent.exponent_cycles:
        try:
            found = exponent(linkage, end, period, extent.exponent_cycles)
            half = math.nan if found.half_width is None else found.half_width
            told = (found.value, half)
        except RunFailed:
            pass
    if extent.order_cycles:
        orders = orders_of(linkage, end, period, extent.order_cycles, ENGINE)
    return Point(run.recorder.sections[-kept:], np.transpose(force)[-kept:], told, orders, run.end)


@dataclass(frozen=True)
class Branch:
    """A way through values as a job; what is found stands in its file after each value.

    Attributes
    ----------
    scene : Scene
    over : Over
    values : tuple of float
        In the order in which they are run, SI.
    extent : Extent
    file : Path
        Gone on with where it is there.
    """

    scene: Scene
    over: Over
    values: tuple[float, ...]
    extent: Extent
    file: Path

    def __call__(self, report: Report) -> None:
        """Run what is left of it."""
        done = read_points(self.file) if self.file.exists() else None
        before: Linkage | None = None
        if done is not None and len(done.value):
            before = self.over.scene(self.scene, float(done.value[-1])).linkage()
        for value in self.values[0 if done is None else len(done.value) :]:
            report(0.0 if done is None else len(done.value) / len(self.values))
            scene = self.over.scene(self.scene, value)
            linkage = scene.linkage()
            start = start_of(scene)
            if done is not None and before is not None and not np.isnan(done.force[-1]).any():
                start = moved(linkage, before, Start(*done.end), start)
            found = point(scene, start, self.extent)
            done = (done or _nothing(found)).and_point(value, found)
            write_arrays(self.file, vars(done), np.savez)
            before = linkage


def _nothing(found: Point) -> Points:
    """Points of which there are none yet, shaped as one that was found."""
    return Points(
        np.zeros(0),
        np.zeros((0, *found.sections.shape)),
        np.zeros((0, *found.force.shape)),
        np.zeros((0, 2)),
        np.zeros((0, *found.orders.amplitude.shape)),
        np.zeros((0, *found.orders.resonance.shape)),
        np.zeros((2, found.end.position.size)),
    )


def read_points(file: Path) -> Points:
    """The points of a branch from its file; InputError where it holds something else."""
    try:
        return Points(**read_numbers(file))
    except TypeError:
        raise InputError(f"{file} holds no branch of a diagram") from None
