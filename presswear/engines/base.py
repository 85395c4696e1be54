"""Start, plan, recorder and outcome of a run, the same for every engine."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force
from presswear.linkage.point_position import point_position
from presswear.linkage.points import GROUND
from presswear.physics.constraints import constraints_of
from presswear.physics.contact import CONTACT, MEMORY
from presswear.physics.drive_motion import motions_of
from presswear.physics.equations.layout import ENERGIES
from presswear.physics.interactions.elastic_guide import period_on
from presswear.physics.interactions.spring import check_springs
from presswear.physics.ledger import CHECK_START
from presswear.physics.load_transitions import place_loads
from presswear.physics.packed import pack
from presswear.physics.touchdown import COUNTERS, STORED_CONTACT
from presswear.physics.wear import map_shape
from presswear.recording.columns import (
    FILM_CYCLE_COUNT,
    JOINT_SERIES_COUNT,
    LAST,
    LEADER_SERIES_COUNT,
    SERIES_COUNT,
    cycle_columns,
    first_film_column,
)
from presswear.recording.film import empty_film
from presswear.recording.nominal_time import nominal_of
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.recording.recorder_state import (
    DRIVE,
    GUIDE,
    OUTPUT,
    PIN,
    WEAR_INTEGRALS,
    RecorderState,
)
from presswear.recording.series_rows import (
    CONTACTS_AT_MOST,
    FORCE_STEP,
    FRAME_ROWS,
    ROWS_AT_LEAST,
    ROWS_AT_MOST,
    ROWS_IN_ALL,
)
from presswear.recording.soundness import Finding
from presswear.recording.statistics import MapBatches
from presswear.tools.arrays import Array, State, numbers_of
from presswear.tools.compile import Records

Status = Literal["completed", "enough", "failed"]

STROKE_NOISE = 1e-9  # time by which a stroke ends earlier than planned, over a cycle


@dataclass(frozen=True)
class Start:
    """Initial state: coordinates and rates of all bodies, each (3 bodies,), at t = 0."""

    position: Array
    velocity: Array

    def __post_init__(self) -> None:
        for name, values in vars(self).items():
            object.__setattr__(self, name, numbers_of(name, values))


@dataclass(frozen=True)
class Plan:
    """Duration of a run and the results to store."""

    cycle: float  # nominal duration, s
    cycles: int  # largest number of cycles
    # number of cycles at the start of which series and single contacts are stored
    recorded_cycles: int = 5
    rows_per_cycle: int = ROWS_AT_LEAST  # least number of rows of the series in a cycle
    # Fractions of each cycle at which a step ends and the state is stored: in increasing
    # order, above 0 and up to 1
    sections: tuple[float, ...] = ()
    torques: bool = True  # True: the series contain the torques of the drives
    # Objects that are notified after each cycle; each of them can end the run
    observers: tuple[Observer, ...] = ()
    # Called many times a second with the completed fraction, 0 to 1, and the recorder
    report: Callable[[float, Recorder], object] = lambda fraction, recorder: None
    # Function that returns the depth by which the surfaces wear after a cycle, m, from the
    # number of cycles, the wear depth of the last cycle, m, and the depth of the
    # surfaces, m. All depths have the shape (joints, 2, bins). None: the surfaces stay.
    wear: Callable[[int, Array, Array], Array] | None = None
    # State to resume from, of a run with the same linkage, start, engine and plan
    resume: State | None = None
    # Nominal time before the first cycle, s; the series include it
    run_up: float = 0.0
    # Nominal times from the start of a cycle between which the bottom of its stroke is
    # searched, s; the first may be negative. None: start and end of the cycle
    stroke: tuple[float, float] | None = None
    # True: cycles end at times, also with a motor; False: at nominal times
    by_clock: bool = False

    def time_of(self, cycles: float) -> float:
        """Return the nominal time after a number of cycles, s."""
        return self.run_up + self.cycle * cycles

    @property
    def duration(self) -> float:
        """Nominal time of a run with the largest number of cycles, s."""
        return self.time_of(self.cycles)

    @property
    def settled(self) -> float:
        """Nominal time from which the energies of a run are judged, s."""
        return self.run_up + CHECK_START * self.cycle

    def advanced(self, recorder: Recorder) -> None:
        """Report the nominal time reached."""
        self.report(min(recorder.nominal_time / self.duration, 1.0), recorder)


@dataclass(frozen=True)
class Run:
    """The outcome of one run of an engine."""

    status: Status  # enough: ended by an observer before the most cycles
    finding: Finding | None  # cause that ended a run that failed
    recorder: Recorder
    end: Start  # final state, from which another run can start
    time: float  # simulated time, s
    # Counts and wall times by name, such as steps and Newton iterations
    diagnostics: dict[str, float | int | str] = field(default_factory=dict)
    cpu: float = 0.0  # CPU time of the solution without building, s

    @property
    def message(self) -> str:
        """Reason of a failure in a line; empty if the run did not fail."""
        return self.finding.words if self.finding else ""


def with_velocity(linkage: Linkage, position: Array, velocity: Array) -> Start:
    """Return an initial state whose velocity is the nearest that joints and drives allow."""
    _, error, _, jacobian = constraints_of(linkage).evaluate(0.0, position, velocity)
    return Start(position, velocity - np.linalg.pinv(jacobian) @ error)


def recorder_of(linkage: Linkage, start: Start, plan: Plan) -> Recorder:
    """Return the empty recorder of a run; the modes of its loads are those of the start.

    InputError if a spring has the length zero at the start.
    """
    check_springs(linkage, start.position)
    records = _records_of(linkage, start, plan)
    loads = records.packed.loads
    if loads.records.size:
        place_loads(loads, start.position, start.velocity)
    maps = MapBatches(map_shape(linkage.clearances))
    return Recorder(records, maps, len(plan.sections))


def _records_of(linkage: Linkage, start: Start, plan: Plan) -> RecorderState:
    """Return the arrays and records of an empty recorder."""
    count = len(linkage.clearances)
    drives = len(linkage.drives)
    has_leader = linkage.leader is not None
    counters = np.zeros(count, COUNTERS)
    counters["fewest_steps"] = np.iinfo(np.int64).max
    contacts = plan.recorded_cycles * CONTACTS_AT_MOST
    films = len(linkage.oiled_joints)
    rows = _series_rows(linkage, plan)
    columns = _series_columns(linkage, plan)
    shape = map_shape(linkage.clearances)
    film, sampler = empty_film(len(linkage.bodies), count, plan.cycle)
    angle_indices = _driven_angles(linkage)
    return RecorderState(
        packed=pack(linkage, plan.wear is not None),
        motions=motions_of(linkage),
        contacts=np.zeros(count, CONTACT),
        onset=np.zeros(count),
        memory=np.zeros(count, MEMORY),
        counters=counters,
        stored_contacts=np.empty((count, contacts), STORED_CONTACT),
        output=_output_of(linkage, start, plan),
        series=np.empty((rows, columns)),
        film=film,
        sampler=sampler,
        nominal=nominal_of(linkage),
        cycle=np.zeros(cycle_columns(count, drives, has_leader, films)),
        depth=np.zeros(shape),
        film_columns=_film_columns(linkage),
        last=np.zeros(count, LAST),
        wear_integrals=np.zeros(count, WEAR_INTEGRALS),
        shares=np.zeros((4, shape[2])),
        torque=np.zeros(drives),
        drives=np.zeros(drives, DRIVE),
        energies=np.zeros(len(ENERGIES)),
        powers=np.zeros(len(ENERGIES)),
        guides=_guides_of(linkage),
        pins=_pins_of(linkage),
        stretches=np.empty((rows, len(linkage.elastic_joints))),
        angle_indices=angle_indices,
        turns=np.empty((rows, 2, angle_indices.size)),
    )


def _driven_angles(linkage: Linkage) -> NDArray[np.int64]:
    """Return the indices in q of the angles of driven bodies; none without a motor."""
    drives = () if linkage.leader is None else linkage.drives
    indices = [3 * linkage.index(drive.body) + 2 for drive in drives]
    return np.array(indices, np.int64)


def _series_columns(linkage: Linkage, plan: Plan) -> int:
    """Return the number of columns of the series."""
    columns = SERIES_COUNT + JOINT_SERIES_COUNT * len(linkage.clearances)
    if plan.torques:
        columns += len(linkage.drives)
    if linkage.leader is not None:
        columns += LEADER_SERIES_COUNT
    return columns


def _output_of(linkage: Linkage, start: Start, plan: Plan) -> Records:
    """Return the record of OUTPUT at the start of a run."""
    output = np.zeros(1, OUTPUT)
    point = linkage.output
    output["room"] = np.iinfo(np.int64).max
    output["interval"] = plan.cycle / _rows_per_cycle(linkage, plan)
    output["force_step"] = FORCE_STEP
    output["index"] = 3 * linkage.index(point.body)
    output["cos"] = math.cos(point.direction)
    output["sin"] = math.sin(point.direction)
    output["x"] = point.x
    output["y"] = point.y
    x, y = point_position(linkage, point.attachment, start.position.tolist())
    output["start"] = math.cos(point.direction) * x + math.sin(point.direction) * y
    output["velocity"] = math.inf
    output["bottom"] = math.inf
    first, end = plan.stroke or (0.0, plan.cycle)
    output["period"] = plan.cycle
    output["stroke_length"] = end - first
    # A cycle may end a rounding error before its time. The first stroke contains the
    # start of the run.
    noise = STROKE_NOISE * plan.cycle
    output["stroke_end"] = plan.run_up + end - noise
    output["stroke_begin"] = plan.run_up + max(first, 0.0) - noise
    return output


def _series_rows(linkage: Linkage, plan: Plan) -> int:
    """Return the largest number of rows of the series."""
    cycles = plan.recorded_cycles + math.ceil(plan.run_up / plan.cycle)
    per_cycle = ROWS_AT_MOST
    if not linkage.clearances:
        per_cycle = 2 * _rows_per_cycle(linkage, plan)
    return min(cycles * per_cycle, ROWS_IN_ALL)


def _rows_per_cycle(linkage: Linkage, plan: Plan) -> int:
    """Return the rows of a series in a cycle, at least; more for frames that swing fast."""
    periods = [period_on(linkage, guide) for guide in linkage.elastic_guides]
    needed = math.ceil(FRAME_ROWS * plan.cycle / min(periods, default=math.inf))
    return max(plan.rows_per_cycle, min(needed, ROWS_AT_MOST // 2))


def _film_columns(linkage: Linkage) -> NDArray[np.int64]:
    """Return the first column of each joint's film in the row of a cycle; -1 without a film."""
    is_oiled = np.array([joint.oil is not None for joint in linkage.clearances], bool)
    first = first_film_column(len(linkage.clearances), linkage.leader is not None)
    films = np.cumsum(is_oiled) - 1
    return np.where(is_oiled, first + FILM_CYCLE_COUNT * films, -1)


def _guides_of(linkage: Linkage) -> Records:
    """Return the guides with a spring as records of GUIDE."""
    guides = np.zeros(len(linkage.elastic_guides), GUIDE)
    for record, guide in zip(guides, linkage.elastic_guides, strict=True):
        cosine = math.cos(guide.direction)
        sine = math.sin(guide.direction)
        record["index"] = 3 * linkage.index(guide.body)
        record["cos"] = cosine
        record["sin"] = sine
        record["point"] = cosine * guide.x + sine * guide.y
    return guides


def _pins_of(linkage: Linkage) -> Records:
    """Return the elastic pins as records of PIN."""
    pins = np.zeros(len(linkage.elastic_pins), PIN)
    for record, pin in zip(pins, linkage.elastic_pins, strict=True):
        for name, end in zip(("first", "second"), pin.ends, strict=True):
            record[name] = -1 if end.body == GROUND else 3 * linkage.index(end.body)
            record[f"{name}_x"] = end.x
            record[f"{name}_y"] = end.y
    return pins


def described(linkage: Linkage, model: str, prescribed: Iterable[str] = ()) -> str:
    """Return a sentence on the model that an engine solves, and on its prescribed bodies."""
    if names := sorted(prescribed):
        model = f"{model}, {listed(names)} prescribed"
    forces = [load for load in linkage.loads_with_law if isinstance(load, Force)]
    if names := [force.name for force in forces if force.name]:
        model = f"{model}; forces: {', '.join(names)}"
    if linkage.rubbing_pins:
        rubs = listed(joint.name for joint in linkage.rubbing_pins)
        model = f"{model}; friction without clearance: {rubs}"
    if linkage.elastic_joints:
        stretching = listed(joint.name for joint in linkage.elastic_joints)
        model = f"{model}; elastic: {stretching}"
    joints = linkage.clearances
    if not joints:
        return f"{model}; clearance: none"
    has_friction = any(joint.friction.coefficient > 0.0 for joint in joints)
    is_worn = any(
        joint.bearing_surface.is_worn or joint.pin_surface.is_worn for joint in joints
    )
    wears = any(joint.wear is not None for joint in joints) or linkage.worn_guides
    texts = [
        model,
        f"clearance: {', '.join(joint.name for joint in joints)}",
        "friction on" if has_friction else "friction off",
        "surfaces worn" if is_worn else "surfaces round",
        "wear computed" if wears else "wear not computed",
    ]
    return "; ".join(texts)


def listed(names: Iterable[str]) -> str:
    """Return names in a sentence: ``a``, ``a and b``, ``a, b and c``."""
    *first_names, last = names
    return f"{', '.join(first_names)} and {last}" if first_names else last
