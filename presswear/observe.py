"""What is kept of a run, step by step: series, episodes, peaks and wear.

Memory does not grow with the number of cycles: series and episodes are kept for
the first cycles only; everything else is one row a cycle or a running sum.
"""

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.clearance import STATE, note_contacts, note_forces
from presswear.compiled import Records, compiled
from presswear.film import Film, empty_film, shutter_of, take_frame
from presswear.joint_data import pack_joints, pack_surfaces
from presswear.linkage import ClearanceJoint, Linkage
from presswear.sampling import MapBatches
from presswear.touch import LEAST_STEPS, TALLY, TOUCH, settle
from presswear.wear import deposit_in_bin, deposit_over_arc, pack_wear

Array = NDArray[np.float64]

SERIES_FIXED = 4
"""Columns of a series row before the joints: time, displacement, velocity, acceleration."""
SERIES_JOINT = 6
"""Columns per joint: e_x, e_y, penetration, normal and tangential force, sliding speed."""
EPISODE_COLUMNS = ("onset", "end", "closing_speed", "release_speed", "peak_force", "steps")
CYCLE_FIXED = ("displacement_max", "velocity_min", "velocity_max", "acceleration_max", "steps")
CYCLE_JOINT = ("force_max", "dose", "contacts")
CYCLE_FIXED_COUNT = len(CYCLE_FIXED)
CYCLE_JOINT_COUNT = len(CYCLE_JOINT)

ROWS_AT_LEAST = 2000
"""Series rows in one cycle without contact."""
ROWS_AT_MOST = 40_000
"""Room for series rows, per recorded cycle."""
EPISODES_AT_MOST = 5000
"""Room for episodes, per joint and recorded cycle."""
FORCE_STEP = 0.02
"""A row is written when a force has changed by this part of its peak so far."""
PRESSURE_POINTS = 8192
"""Room for the pressure distribution over one contact arc."""

RECORD = np.dtype(
    [
        ("rows", np.int64),  # series rows written
        ("last_time", np.float64),  # of the last row, s
        ("now", np.float64),  # of the last accepted state, s
        ("interval", np.float64),  # longest time between two rows, s
        ("force_step", np.float64),  # change of a force, part of its peak, that makes a row
        ("probe", np.int64),  # index of the watched body's x in q
        ("probe_cos", np.float64),
        ("probe_sin", np.float64),
        ("start", np.float64),  # watched coordinate at the start, m
        ("steps", np.int64),
        ("room", np.int64),  # rows and episodes that may be written
    ]
)
"""Where the recording stands."""


class Book(NamedTuple):
    """The arrays that the kernels fill during one run.

    Attributes
    ----------
    joints, wear : records of JOINT and WEAR
    surfaces : ndarray, shape (joints, ROWS, m)
    states : records of STATE
        Contacts and forces of the last accepted state.
    onset : ndarray, shape (joints,)
        Latched closing speeds, 0 where open, m/s.
    touch, tally : records of TOUCH and TALLY
    record : one record of RECORD
    series : ndarray, shape (rows, SERIES_FIXED + SERIES_JOINT joints + drives)
        Without the torques of the drives where they are not asked for.
    episodes : ndarray, shape (joints, rows, 6)
    film, shutter : ndarray and one record of SHUTTER
        See ``presswear.film``.
    cycle : ndarray, shape (CYCLE_FIXED + CYCLE_JOINT joints,)
        Row of the present cycle.
    depth : ndarray, shape (joints, 2, m)
        Depth that the present cycle added to bearing and pin, m.
    doses : ndarray, shape (joints, 2)
        F_n ds, N m, and p ds, N/m, of the last step.
    pressure : ndarray
        Working space of one contact arc.
    torque : ndarray, shape (drives,)
        Torques of the drives in the present state, N m.
    ledger : ndarray, shape (7,)
        Of engines that sum powers by steps: drive work, its absolute value, contact
        loss, friction loss, J; then the last powers of drives, contact, friction, W.
    """

    joints: Records
    wear: Records
    surfaces: Array
    states: Records
    onset: Array
    touch: Records
    tally: Records
    record: Records
    series: Array
    episodes: Array
    film: Array
    shutter: Records
    cycle: Array
    depth: Array
    doses: Array
    pressure: Array
    torque: Array
    ledger: Array


@compiled
def deposit(book: Book, k: int) -> None:
    """Add the wear of the last step's doses to the maps of joint ``k``."""
    law = book.wear[k]
    joint = book.joints[k]
    contact = book.states[k]
    bearing_angle = contact.bearing_angle
    pin_angle = contact.pin_angle
    if law.over_arc:
        deposit_over_arc(
            book.depth[k],
            law,
            joint,
            book.surfaces[k],
            contact,
            bearing_angle,
            pin_angle,
            book.doses[k, 0],
            book.pressure,
        )
    else:
        deposit_in_bin(
            book.depth[k], law, joint, contact, bearing_angle, pin_angle, book.doses[k, 1]
        )


@compiled
def settle_state(book: Book, t: float, needed: int) -> int:
    """Settle an accepted state whose contacts are noted; see ``settle``."""
    events = settle(
        book.joints, book.onset, book.touch, book.tally, book.episodes, book.states, t, needed
    )
    note_forces(book.joints, book.onset, book.states)
    return events


@compiled
def observe(book: Book, t: float, h: float, q: Array, v: Array, a: Array) -> None:
    """Account for one accepted step of length ``h``, s, that ended in the given state.

    The state's contacts are in the book, settled.
    """
    joints, touch, tally, series = book.joints, book.touch, book.tally, book.series
    cycle = book.cycle
    state = book.record[0]
    count = joints.shape[0]
    i = state.probe
    displacement = state.probe_cos * q[i] + state.probe_sin * q[i + 1] - state.start
    velocity = state.probe_cos * v[i] + state.probe_sin * v[i + 1]
    acceleration = state.probe_cos * a[i] + state.probe_sin * a[i + 1]
    cycle[0] = max(cycle[0], displacement)
    cycle[1] = min(cycle[1], velocity)
    cycle[2] = max(cycle[2], velocity)
    cycle[3] = max(cycle[3], abs(acceleration))
    cycle[4] += 1
    state.steps += 1
    state.now = t
    row = state.rows
    has_room = row < min(state.room, series.shape[0])
    is_due = row == 0 or t - state.last_time >= state.interval
    for k in range(count):
        contact = book.states[k]
        counts = tally[k]
        base = CYCLE_FIXED_COUNT + CYCLE_JOINT_COUNT * k
        if contact.normal > 0.0:
            duration = min(h, t - touch[k].onset_time)
            counts.closed_time += duration
            counts.peak_force = max(counts.peak_force, contact.normal)
            touch[k].peak_force = max(touch[k].peak_force, contact.normal)
            cycle[base] = max(cycle[base], contact.normal)
        cycle[base + 1] += book.doses[k, 0]
        if book.doses[k, 0] > 0.0 and book.wear[k].coefficient > 0.0:
            deposit(book, k)
        cycle[base + 2] = counts.contacts
        if has_room:
            column = SERIES_FIXED + SERIES_JOINT * k
            series[row, column] = contact.eccentricity_x
            series[row, column + 1] = contact.eccentricity_y
            series[row, column + 2] = contact.penetration
            series[row, column + 3] = contact.normal
            series[row, column + 4] = contact.tangential
            series[row, column + 5] = contact.sliding
            if row > 0:
                change = abs(contact.normal - series[row - 1, column + 3])
                is_due = is_due or change > state.force_step * counts.peak_force
    take_frame(book.film, book.shutter, book.states, t, q)
    if has_room and is_due:
        series[row, 0] = t
        series[row, 1] = displacement
        series[row, 2] = velocity
        series[row, 3] = acceleration
        first = SERIES_FIXED + SERIES_JOINT * count
        for column in range(first, series.shape[1]):
            series[row, column] = book.torque[column - first]
        state.rows += 1
        state.last_time = t


@dataclass
class Account:
    """What one run has observed so far; made anew for every run.

    Attributes
    ----------
    book : Book
        What the kernels fill.
    cycles : list of ndarray
        One row per finished cycle, columns CYCLE_FIXED and CYCLE_JOINT.
    maps : MapBatches
        Depth that the finished cycles added to bearing and pin, m.
    """

    book: Book
    maps: MapBatches
    cycles: list[Array] = field(default_factory=list)

    @staticmethod
    def of(
        linkage: Linkage,
        position: Array,
        recorded_cycles: int,
        cycle: float,
        torques: bool = True,
    ) -> "Account":
        """An empty account for a linkage that starts in a position.

        Parameters
        ----------
        position : ndarray, shape (3 bodies,)
        recorded_cycles : int
            Cycles whose series and episodes are kept.
        cycle : float
            Duration of one cycle, s.
        torques : bool
            Whether series hold the torques of the drives.
        """
        joints = pack_joints(linkage)
        count = joints.size
        angles = max((j.wear.angles for j in linkage.clearances if j.wear), default=1)
        touch = np.zeros(count, TOUCH)
        touch["effective_mass"] = [effective_mass(linkage, k) for k in range(count)]
        touch["relief"] = [relief(joint) for joint in linkage.clearances]
        tally = np.zeros(count, TALLY)
        tally["fewest_steps"] = np.iinfo(np.int64).max
        record = np.zeros(1, RECORD)
        record["room"] = np.iinfo(np.int64).max
        record["interval"] = cycle / ROWS_AT_LEAST
        record["force_step"] = FORCE_STEP
        record["probe"] = 3 * linkage.index(linkage.probe.body)
        record["probe_cos"] = math.cos(linkage.probe.direction)
        record["probe_sin"] = math.sin(linkage.probe.direction)
        record["start"] = (
            record["probe_cos"] * position[record["probe"]]
            + record["probe_sin"] * position[record["probe"] + 1]
        )
        rows = recorded_cycles * (ROWS_AT_MOST if count else 2 * ROWS_AT_LEAST)
        columns = SERIES_FIXED + SERIES_JOINT * count + len(linkage.drives) * torques
        shape = (count, 2, angles)
        book = Book(
            joints=joints,
            wear=pack_wear(linkage),
            surfaces=pack_surfaces(linkage),
            states=np.zeros(count, STATE),
            onset=np.zeros(count),
            touch=touch,
            tally=tally,
            record=record,
            series=np.zeros((rows, columns)),
            episodes=np.zeros((count, recorded_cycles * EPISODES_AT_MOST, len(EPISODE_COLUMNS))),
            film=empty_film(len(linkage.bodies), count),
            shutter=shutter_of(cycle),
            cycle=np.zeros(len(CYCLE_FIXED) + len(CYCLE_JOINT) * count),
            depth=np.zeros(shape),
            doses=np.zeros((count, 2)),
            pressure=np.zeros(PRESSURE_POINTS),
            torque=np.zeros(len(linkage.drives)),
            ledger=np.zeros(7),
        )
        account = Account(book, MapBatches(shape))
        account.start_cycle()
        return account

    def begin(self, q: Array, v: Array, a: Array) -> None:
        """Settle contact in the initial state and write the first row of the series."""
        book = self.book
        note_contacts(book.joints, book.surfaces, book.states, q, v)
        settle_state(book, 0.0, LEAST_STEPS)
        observe(book, 0.0, 0.0, q, v, a)

    @property
    def rows(self) -> Array:
        """Series rows written so far, shape (n, SERIES_FIXED + SERIES_JOINT joints + drives)."""
        return self.book.series[: int(self.book.record["rows"][0])]

    @property
    def film(self) -> Film:
        """Frames kept so far."""
        book = self.book
        rows = book.film[: int(book.shutter["frames"][0])]
        return Film.of(rows, book.joints.size)

    @property
    def last_frames(self) -> Film:
        """Frames up to now: of a film that is full, the one that is taken and taken again."""
        book = self.book
        frames = int(book.shutter["frames"][0])
        first = frames if frames == len(book.film) - 1 else 0
        return Film.of(book.film[first : max(frames, first + 1)], book.joints.size)

    def episodes(self, k: int) -> Array:
        """Recorded contacts of joint ``k``, shape (n, 6), columns EPISODE_COLUMNS."""
        return self.book.episodes[k, : int(self.book.tally["episodes"][k])]

    def stop_recording(self) -> None:
        """Keep no further series rows and episodes."""
        self.book.record["room"] = 0

    def start_cycle(self) -> None:
        """Clear the row and the maps of the present cycle."""
        self.book.cycle[:] = 0.0
        self.book.cycle[0] = self.book.cycle[2] = -math.inf
        self.book.cycle[1] = math.inf
        self.book.depth[:] = 0.0

    @property
    def last_time(self) -> float:
        """Time of the last accepted state, s."""
        return float(self.book.record["now"][0])

    def end_cycle(self) -> None:
        """File the present cycle and start the next."""
        self.cycles.append(self.book.cycle.copy())
        self.maps.add(self.book.depth)
        self.start_cycle()


def relief(joint: ClearanceJoint) -> float:
    """Greatest difference of depth that a pin can meet on the worn surfaces, m."""
    return sum(
        float(np.ptp(surface.depth)) if surface.is_worn else 0.0
        for surface in (joint.bearing_surface, joint.pin_surface)
    )


def effective_mass(linkage: Linkage, k: int) -> float:
    """Lower bound of the mass that meets in clearance joint ``k``, kg.

    Both bodies taken as free: 1/m = sum of 1/m + r^2/I.  Constraints only add mass.
    A driven body and the frame do not give way.
    """
    joint = linkage.clearances[k]
    driven = {drive.body for drive in linkage.drives}
    mobility = 0.0
    for end in (joint.bearing, joint.pin):
        for body in linkage.bodies:
            if body.name == end.body and body.name not in driven:
                mobility += 1.0 / body.mass + (end.x**2 + end.y**2) / body.inertia
    return 1.0 / mobility if mobility > 0.0 else math.inf
