"""Recorder of a run: recorded quantities, and their state for a checkpoint."""

import math
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, field
from itertools import chain

import numpy as np

from presswear.linkage.surface import Surface
from presswear.physics.packed import depths_of, pack_surfaces
from presswear.physics.touchdown import CONTACT_COLUMNS, LEAST_STEPS, settle
from presswear.recording.columns import (
    CYCLE_COUNT,
    DISPLACEMENT_MAX,
    DURATION,
    END_X,
    END_Y,
    FILM_CYCLE,
    JOINT_CYCLE_COUNT,
    JOINT_SERIES_COUNT,
    LEADER_CYCLE,
    LEADER_SERIES_COUNT,
    LEADER_SPEED_MAX,
    LEADER_SPEED_MEAN,
    LEADER_SPEED_MIN,
    LEAST_FILM,
    SECTION_JOINT_NAMES,
    SECTION_NAMES,
    SERIES_COUNT,
    VELOCITY_MAX,
    VELOCITY_MIN,
    cycle_column,
    first_leader_column,
    names_of,
    series_column,
)
from presswear.recording.film import Film
from presswear.recording.recorder_state import RecorderState
from presswear.recording.statistics import MapBatches
from presswear.tools.arrays import Array, State, named, part

# Fields of RecorderState that ``Recorder.save`` does not copy, because they do not change
# in a run, or because only their written rows are stored
_NOT_COPIED = (
    "packed",
    "motions",
    "series",
    "stored_contacts",
    "film",
    "shares",
    "guides",
    "pins",
    "stretches",
    "angle_indices",
    "turns",
    "film_columns",
)
_COPIED = tuple(name for name in RecorderState._fields if name not in _NOT_COPIED)


@dataclass
class Recorder:
    """Quantities that one run has recorded so far; SI units."""

    records: RecorderState  # arrays that the kernels fill
    maps: MapBatches  # depth that the finished cycles added to bearing and pin, m
    sections_per_cycle: int = 0
    # Rows of the finished cycles: columns CYCLE, JOINT_CYCLE, LEADER_CYCLE, FILM_CYCLE and
    # DRIVE_CYCLE
    cycles: Array = field(init=False)
    # Largest added depth and largest depth of bearing and pin after each cycle, m, shape
    # (cycles, 2, joints, 2); no rows if the surfaces do not wear during the run
    growth: Array = field(init=False)
    _sections: list[Array] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self.cycles = np.zeros((0, self.records.cycle.size))
        self.growth = np.zeros((0, 2, self.records.memory.size, 2))
        self.start_cycle()

    @property
    def rows(self) -> Array:
        """Series rows written so far: SERIES, then JOINT_SERIES of each joint, then torques."""
        return self.records.series[: int(self.records.output["rows"][0])]

    def series(self, name: str, joint: int | None = None) -> Array:
        """Return a recorded series of the linkage or of a joint, shape (n,)."""
        return self.rows[:, series_column(name, joint)]

    @property
    def has_leader(self) -> bool:
        """True if a motor turns the linkage, so that its cycles end at angles."""
        return bool(self.records.nominal["column"][0] >= 0)

    @property
    def nominal_times(self) -> Array:
        """Nominal times of the series rows, s; without a motor their times."""
        if not self.has_leader:
            return self.series("time")
        return self.rows[:, -LEADER_SERIES_COUNT]

    @property
    def nominal_rates(self) -> Array:
        """Rates of the nominal time at the series rows; without a motor 1."""
        return self.rows[:, -1] if self.has_leader else np.ones(len(self.rows))

    @property
    def torques(self) -> Array:
        """Recorded torques of the drives, N m, shape (n, drives), or (n, 0) without torques."""
        first = SERIES_COUNT + JOINT_SERIES_COUNT * self.records.memory.size
        last = self.rows.shape[1] - LEADER_SERIES_COUNT * self.has_leader
        return self.rows[:, first:last]

    @property
    def stretches(self) -> Array:
        """Recorded stretches of guides with a spring, shape (n, guides), m."""
        return self._stretches[:, : self.records.guides.size]

    @property
    def pin_stretches(self) -> Array:
        """Recorded distances of the centres of elastic pins, shape (n, pins), m."""
        return self._stretches[:, self.records.guides.size :]

    @property
    def _stretches(self) -> Array:
        return self.records.stretches[: len(self.rows)]

    @property
    def turns(self) -> Array:
        """Recorded angles, rad, and speeds, rad/s, of the drives, shape (n, 2, drives).

        No drive without a motor.
        """
        return self.records.turns[: len(self.rows)]

    def each_cycle(self, name: str, joint: int | None = None) -> Array:
        """Return a quantity of each finished cycle by its name, shape (cycles,)."""
        if self.has_leader and name in names_of(LEADER_CYCLE):
            column = self._leader_column + names_of(LEADER_CYCLE).index(name)
            return self.cycles[:, column]
        if joint is not None and name in names_of(FILM_CYCLE):
            first = self.records.film_columns[joint]
            return self.cycles[:, first + names_of(FILM_CYCLE).index(name)]
        return self.cycles[:, cycle_column(name, joint)]

    @property
    def _leader_column(self) -> int:
        return first_leader_column(self.records.memory.size)

    def since(self, cycle: int) -> "Recorder":
        """Return a recorder without the rows and maps of the first cycles."""
        later = copy(self)
        later.cycles = self.cycles[cycle:]
        later.maps = self.maps.since(cycle)
        return later

    @property
    def film(self) -> Film:
        """Film frames recorded so far."""
        rows = self.records.film[: int(self.records.sampler["frames"][0])]
        return Film.of(rows, self.records.memory.size)

    def stored_contacts(self, k: int) -> Array:
        """Return the recorded contacts of joint ``k``, shape (n, 6), columns CONTACT_COLUMNS."""
        rows = self.records.stored_contacts[k, : int(self.records.counters["rows"][k])]
        return np.asarray(rows.view(np.float64).reshape(-1, len(CONTACT_COLUMNS)))

    def stop_recording(self) -> None:
        """Stop the recording of series rows and single contacts."""
        self.records.output["room"] = 0
        self.records.counters["full"] = True

    def note_section(self) -> None:
        """Store the last accepted state as a Poincare section of the present cycle."""
        point = [self.records.output[name] for name in SECTION_NAMES]
        joints = [self.records.contacts[name] for name in SECTION_JOINT_NAMES]
        self._sections.append(np.concatenate([*point, np.transpose(joints).ravel()]))

    @property
    def sections(self) -> Array:
        """Sections of the finished cycles, shape (cycles, sections, columns).

        Columns SECTION_NAMES, then SECTION_JOINT_NAMES of each joint.
        """
        columns = (
            len(SECTION_NAMES) + len(SECTION_JOINT_NAMES) * self.records.memory.size
        )
        finished = self._sections[: len(self.cycles) * self.sections_per_cycle]
        # numpy cannot infer the number of cycles of an empty array.
        cycles = -1 if finished else 0
        return np.reshape(finished, (cycles, self.sections_per_cycle, columns))

    def start_cycle(self) -> None:
        """Clear the row and the maps of the present cycle."""
        records = self.records
        records.counters["contacts_before"] = records.counters["contacts"]
        records.cycle[:] = 0.0
        records.cycle[[DISPLACEMENT_MAX, VELOCITY_MAX]] = -math.inf
        records.cycle[VELOCITY_MIN] = math.inf
        films = records.film_columns[records.film_columns >= 0]
        records.cycle[films + LEAST_FILM] = math.inf
        if self.has_leader:
            leader = records.cycle[self._leader_column :]
            nominal = records.nominal[0]
            nominal["cycle_start"] = self.last_time
            nominal["cycle_begin"] = nominal["now"]
            speed = nominal["rate"] * abs(nominal["speed"])
            is_first = self.last_time == 0.0  # the initial state is not recorded yet
            leader[LEADER_SPEED_MIN] = math.inf if is_first else speed
            leader[LEADER_SPEED_MAX] = -math.inf if is_first else speed
        records.depth[:] = 0.0

    @property
    def last_time(self) -> float:
        """Time of the last accepted state, s."""
        return float(self.records.output["now"][0])

    @property
    def nominal_time(self) -> float:
        """Nominal time of the last accepted state, s; without a motor its time."""
        return float(self.records.nominal["now"][0])

    @property
    def ends_by_angle(self) -> bool:
        """True if the present section ends at an angle of the leader; see ``aim``."""
        return math.isfinite(self.records.nominal["end"][0])

    def aim(self, end: float) -> None:
        """Let the engine stop at a nominal time, s, instead of at a time of the clock."""
        self.records.nominal["end"] = end

    @property
    def surface_depth(self) -> Array:
        """Present depth of bearings and pins, shape (joints, 2, bins), m; no bin: round."""
        return depths_of(self.records.packed)

    def _rebuild(self, depth: Array) -> None:
        packed = self.records.packed
        for k, sides in enumerate(depth):
            bearing, pin = sides[:, : packed.joints[k]["surface_bins"]]
            pack_surfaces(packed, k, (Surface(bearing), Surface(pin)))

    def wear(self, new_depth: Array, update_contacts: Callable[[], None]) -> None:
        """Wear the surfaces by a depth, m, shape (joints, 2, bins).

        Contacts of pins that rested on the worn material end. ``update_contacts`` fills
        the contacts of the present state.
        """
        records = self.records
        depth = self.surface_depth + new_depth
        self._rebuild(depth)
        growth = [new_depth.max(axis=2), self.surface_depth.max(axis=2)]
        self.growth = np.append(self.growth, [growth], axis=0)
        update_contacts()
        step = records.memory["step"].copy()
        if settle(records, self.last_time, LEAST_STEPS) > 0:
            update_contacts()
        records.memory["step"] = step

    def end_cycle(self) -> Array:
        """Store the present cycle and start the next; return the depth that it added, m."""
        self._note_pins()
        if self.has_leader:
            self._note_duration()
        self.cycles = np.append(self.cycles, [self.records.cycle], axis=0)
        depth = self.records.depth.copy()
        self.maps.add(depth)
        self.start_cycle()
        return depth

    def _note_duration(self) -> None:
        """Write the duration of the cycle and the mean speed of the leader into its row."""
        nominal = self.records.nominal[0]
        leader = self.records.cycle[self._leader_column :]
        leader[DURATION] = self.last_time - nominal["cycle_start"]
        angle = abs(nominal["speed"]) * (nominal["now"] - nominal["cycle_begin"])
        leader[LEADER_SPEED_MEAN] = angle / leader[DURATION]

    def _note_pins(self) -> None:
        """Write the positions of the pins at the end of the cycle into its row."""
        for k, contact in enumerate(self.records.contacts):
            joint = self.records.cycle[CYCLE_COUNT + JOINT_CYCLE_COUNT * k :]
            joint[END_X] = contact["eccentricity_x"]
            joint[END_Y] = contact["eccentricity_y"]

    def save(self) -> State:
        """Return the state of the recorder as named arrays.

        Without the arrays that are computed from linkage, start and plan. Rows of series,
        contacts, film and cycles are views, because a written row does not change.
        """
        records = self.records
        frames = int(self.records.sampler["frames"][0])
        arrays = {
            **{name: getattr(records, name).copy() for name in _COPIED},
            **named("maps", self.maps.save()),
            "series": self.rows,
            "stretches": self._stretches,
            "turns": self.turns,
            "film": records.film[:frames],
            "frame": records.film[frames].copy(),
            "cycles": self.cycles,
            "surface_depth": self.surface_depth,
            "growth": self.growth,
            "sections": self.sections,
        }
        for k, count in enumerate(records.counters["rows"]):
            arrays[f"stored_contacts_{k}"] = records.stored_contacts[k, :count]
        arrays["modes"] = records.packed.loads.modes.copy()
        return arrays

    def load(self, saved: State) -> None:
        """Restore the state that a recorder of the same linkage, start and plan has saved."""
        records = self.records
        frames = len(saved["film"])
        for name in _COPIED:
            getattr(records, name)[...] = saved[name]
        self.maps = MapBatches.load(part(saved, "maps"))
        records.series[: len(saved["series"])] = saved["series"]
        for name in ("stretches", "turns"):
            getattr(records, name)[: len(saved["series"])] = saved[name]
        records.film[:frames] = saved["film"]
        records.film[frames] = saved["frame"]
        self.cycles = np.array(saved["cycles"])
        self.growth = np.array(saved["growth"])
        self._sections = list(chain.from_iterable(saved["sections"]))
        self._rebuild(saved["surface_depth"])
        for k in range(records.memory.size):
            rows = saved[f"stored_contacts_{k}"]
            records.stored_contacts[k, : len(rows)] = rows
        records.packed.loads.modes[...] = saved["modes"]
