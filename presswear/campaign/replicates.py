"""One replicate: its initial state, its run specification, and the unit of work that advances it.

A work unit is a pure function of plain data: the specification, the surfaces, the state
to resume from, and the cycle at which it ends; it returns the state that is reached.
It does not depend on the process or the machine, except for the last digits in which
processors differ.
"""

import math
import time as clock
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np

from presswear.engines.base import Plan, Run, Start, Status, recorder_of, with_velocity
from presswear.engines.settings import Engine
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.linkage.surface import SIDES, Surface
from presswear.physics.constraints import constraints_of
from presswear.physics.dead_centre import bottom_of
from presswear.physics.ideal import IdealMotion
from presswear.physics.wall_wear import walls_of
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Finding
from presswear.recording.statistics import RANGE_STROKES, STARTUP_CYCLES, MapBatches
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array, State, named, part
from presswear.tools.compile import on_compiling
from presswear.tools.numbers import quantity_text
from presswear.tools.processes import Report, Stopped, is_stopped

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)  # inverse golden ratio
# Largest displacement of the start of a replicate over the smallest clearance. After a
# displacement of 1e-9 m two replicates would have equal first cycles.
SPREAD = 0.02
SPREAD_CLOSED = 1e-9  # largest displacement without clearance, m
# Newton steps that close the joints. The first one leaves an error of second order.
NEWTON_STEPS = 2

PIECES = 100  # pieces of a cycle; there are several between two touchdowns of a joint
PIECE_STRIDE = 4  # every fourth piece is repeated with finer steps
REFINEMENT = 100.0  # factor by which the tolerance of the repeated pieces is smaller
SETTLING = 2  # cycles before the one whose pieces are repeated
# Cycles of a stage from which the step check takes at most a twentieth of its time
STEP_CHECK_CYCLES = 50


@lru_cache(maxsize=64)
def start_of(scene: Scene, index: int = 0) -> Start:
    """Return the initial state of a replicate.

    The first replicate of seed 0 has its pins centred in their bearings, with positions
    and velocities of the ideal mechanism. All others are moved along a free direction.
    With a motor the velocities are those at its settled speed, unless it runs up from
    rest.
    """
    start = _ideal_start(scene.ideal)
    start = replace(start, velocity=_start_rate(scene) * start.velocity)
    # With multiples of two independent irrational numbers no two replicates are close
    # together.
    fraction = (index * GOLDEN + scene.seed * math.sqrt(2.0)) % 1.0
    if fraction == 0.0:
        return start
    linkage = scene.linkage()
    clearances = [joint.clearance for joint in linkage.clearances]
    spread = SPREAD * min(clearances) if clearances else SPREAD_CLOSED
    moved = disturbed(linkage, start, fraction * spread)
    if moved is None:
        return start
    constraints = constraints_of(linkage)
    position = moved.position
    for _ in range(NEWTON_STEPS):
        gap, _, _, jacobian = constraints.evaluate(0.0, position, moved.velocity)
        position = position - np.linalg.pinv(jacobian) @ gap
    return with_velocity(linkage, position, moved.velocity)


@lru_cache(maxsize=64)  # rows of a sweep that differ in a clearance share it
def _ideal_start(ideal: IdealMotion) -> Start:
    motion = ideal.at(np.zeros(1))
    return Start(motion.position[0], motion.velocity[0])


@lru_cache(maxsize=64)
def _start_rate(scene: Scene) -> float:
    """Return the speed of a scene's motor at the start over its nominal speed."""
    if scene.mechanism.linkage().leader is None:
        return 1.0
    if scene.run_up > 0.0:
        return 0.0
    from presswear.physics.settled_speed import settled_rate  # slow to import

    return settled_rate(scene.loaded, scene.ideal, scene.linkage().bushings)


def disturbed(linkage: Linkage, start: Start, distance: float) -> Start | None:
    """Return a start that is displaced along the free direction that moves the output most.

    ``distance`` is the largest change of a coordinate, m or rad. None if the linkage has
    no degree of freedom.
    """
    constraints = constraints_of(linkage)
    *_, jacobian = constraints.evaluate(0.0, start.position, start.velocity)
    # Null space as in scipy.linalg.null_space, whose import takes 0.2 s in each process
    _, singular_values, rows = np.linalg.svd(jacobian)
    largest = singular_values.max(initial=0.0)
    least = largest * max(jacobian.shape) * np.finfo(float).eps
    rank = int((singular_values > least).sum())
    free = rows[rank:].T
    if free.shape[1] == 0:
        return None
    output = 3 * linkage.index(linkage.output.body)
    direction = linkage.output.direction
    unit_vector = np.array([math.cos(direction), math.sin(direction)])
    # Rate of the output along its direction for each free direction
    rates = unit_vector @ free[output : output + 2]
    moved = free @ rates if np.linalg.norm(rates) > 1e-6 else free[:, 0]
    position = start.position + distance * moved / np.abs(moved).max()
    return with_velocity(linkage, position, start.velocity)


def linkage_on(scene: Scene, depth: Array) -> Linkage:
    """Return the linkage of a scene on surfaces worn by a depth, m; see ``map_shape``."""
    linkage = scene.linkage()
    is_worn = any(
        joint.bearing_surface.is_worn or joint.pin_surface.is_worn
        for joint in linkage.clearances
    )
    if not (is_worn or depth.any()):
        return linkage
    return _linkage_on(scene, depth.shape, depth.tobytes())


@lru_cache(maxsize=64)  # each run of a stage requests it three times
def _linkage_on(scene: Scene, shape: tuple[int, ...], numbers: bytes) -> Linkage:
    depth = np.frombuffer(numbers).reshape(shape)
    linkage = scene.linkage()
    surfaces = {}
    for joint, (bearing, pin) in zip(linkage.clearances, depth, strict=True):
        bins = joint.bins
        surfaces[joint.name] = Surface(bearing[:bins]), Surface(pin[:bins])
    for guide, (left, right) in walls_of(linkage, depth).items():
        surfaces[guide] = Surface(left), Surface(right)
    return scene.linkage(surfaces)


def worn_out(
    joints: Sequence[ClearanceJoint],
    depth: Array,
    where: str = "",
    time: float = 0.0,
    strokes: float = 0.0,
) -> Finding | None:
    """Return a finding on the first surface that is worn too deep for the model, or None.

    See ``linkage.clearance_joint.deepest_wear``. ``depth`` has the shape
    (..., joints, 2, bins), m, after ``strokes`` strokes.
    """
    deepest = depth.max(axis=-1, initial=0.0)
    allowed = np.array([joint.deepest_wear for joint in joints])[:, np.newaxis]
    too_deep = np.argwhere(deepest > allowed)
    if not len(too_deep):
        return None
    first = tuple(too_deep[0])
    joint = joints[first[-2]]
    worn = float(deepest[first])
    surface = "wall" if isinstance(joint, GuideCorner) else SIDES[first[-1]]
    loss = quantity_text(worn, "m")
    limit = quantity_text(joint.deepest_wear, "m")
    clearance = quantity_text(joint.clearance, "m")
    # Strokes that wear the surface by a tenth of the clearance
    tenth = 0.1 * strokes * joint.clearance / worn
    return Finding(
        "wear",
        f"{where}the {surface} would lose {loss}, more than {limit}, "
        f"with a clearance of {clearance}",
        time,
        joint.name,
        f"cycles_per_update = {tenth:.1g} wears it by about a tenth of the clearance; "
        "or check wear_coefficient",
    )


@dataclass(frozen=True)
class RunSpec:
    """Run specification shared by the replicates of an ensemble."""

    cycles: int  # largest number of cycles of each replicate
    # relative error of the wear maps below which the runs end early
    tolerance: float | None = None
    # wear after each cycle, see ``Plan.wear``
    wear: Callable[[int, Array, Array], Array] | None = None
    # number of the ensemble within its stage: each ensemble has other starts
    number: int = 0
    label: str = ""  # short description for progress

    def plan(self, scene: Scene) -> Plan:
        """Return the plan of each run, without observers."""
        recorded = Plan.recorded_cycles
        if scene.process is not None:
            # Working strokes are samples of the loads on joints and drives.
            recorded = STARTUP_CYCLES + RANGE_STROKES
        recording = scene.recording
        if recording.recorded_cycles is not None:
            recorded = recording.recorded_cycles
        sections = recording.phases
        if self.wear is not None:
            # The results of a stage are not from runs that wear after each cycle.
            recorded = 1
            sections = ()
        bottom = bottom_of(scene.ideal)
        return Plan(
            scene.mechanism.period,
            self.cycles,
            recorded,
            rows_per_cycle=recording.rows_per_cycle,
            sections=sections,
            torques=scene.stores_torques,
            wear=self.wear,
            run_up=scene.run_up,
            stroke=None if bottom is None else bottom.window,
        )


@dataclass(frozen=True)
class RunState:
    """State of a run between two cycles."""

    # arrays of its recorder and, if the run can be resumed, of its engine
    arrays: State
    status: Status | None = None  # as ``Run.status``; None: the run is not finished
    finding: Finding | None = None
    end: Start | None = None
    time: float = 0.0  # s
    diagnostics: Mapping[str, float | int | str] = field(default_factory=dict)

    @property
    def cycles(self) -> int:
        """Number of finished cycles."""
        return len(self.arrays["recorder/cycles"])

    @property
    def maps(self) -> MapBatches:
        """Wear maps of the finished cycles."""
        return MapBatches.load(part(self.arrays, "recorder/maps"))

    def run(self, scene: Scene, spec: RunSpec, depth: Array) -> Run:
        """Return the finished run on surfaces, shape (joints, 2, bins), m."""
        assert self.status is not None
        assert self.end is not None
        linkage = linkage_on(scene, depth)
        recorder = recorder_of(linkage, start_of(scene), spec.plan(scene))
        recorder.load(part(self.arrays, "recorder"))
        diagnostics = dict(self.diagnostics)
        return Run(
            self.status, self.finding, recorder, self.end, self.time, diagnostics
        )


@dataclass(frozen=True)
class Part:
    """Part of one run, from the cycle at which it starts or resumes to another cycle."""

    # wear depth of the surfaces at the start of the run, (joints, 2, bins), m
    depth: Array
    replicate: int  # number of the replicate, see ``start_of``
    until: int  # cycle of the run after which the part ends
    arrays: State | None  # state to resume from; None: the run starts


@dataclass(frozen=True)
class WorkUnit:
    """Part of a run that one process computes."""

    scene: Scene
    spec: RunSpec
    part: Part
    duration: float  # wall time after which the part ends with the next cycle, s
    observers: tuple[Observer, ...] = ()  # notified by the engine, in this process

    def __call__(self, report: Report) -> RunState:
        """Compute the part; return the state that is reached.

        An interrupt raises ``Stopped`` with the state after the last finished cycle.
        """
        running = _RunningPart(self)
        plan = replace(
            self.spec.plan(self.scene),
            observers=(running, *self.observers),
            report=lambda share, recorder: report(share * self.spec.cycles),
            resume=running.arrays,
        )
        start = start_of(self.scene, self.part.replicate)
        with on_compiling(lambda: report(math.nan, "compiling")):
            try:
                run = self.scene.solver.simulate(running.linkage, start, plan)
            except BaseException as error:
                # After a signal any error is treated as an interrupt.
                is_interrupt = isinstance(error, KeyboardInterrupt) or is_stopped()
                if running.arrays is None or not is_interrupt:
                    raise
                raise Stopped(RunState(running.arrays)) from None
        return running.state_of(run)


class _RunningPart(Observer):
    """Observer that ends a part of a run, and stores the arrays to resume from."""

    def __init__(self, unit: WorkUnit) -> None:
        self._unit = unit
        self.linkage = linkage_on(unit.scene, unit.part.depth)
        self._started = clock.perf_counter()
        self._is_interrupted = False
        self.arrays = unit.part.arrays
        self._resumed = 0
        if self.arrays is not None:
            self._resumed = len(self.arrays["recorder/cycles"])

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        cycles = len(recorder.cycles)
        unit = self._unit
        if cycles > self._resumed:
            self.arrays = state()
        joints = self.linkage.clearances
        if unit.spec.wear and worn_out(joints, recorder.surface_depth):
            return True
        if cycles >= unit.part.until:
            return True
        is_due = clock.perf_counter() - self._started >= unit.duration
        self._is_interrupted = is_due and cycles > self._resumed
        return self._is_interrupted

    def state_of(self, run: Run) -> RunState:
        arrays = self.arrays
        if run.status == "failed" or arrays is None:
            arrays = named("recorder", run.recorder.save())
        status = None
        if run.status == "failed" or not self._is_interrupted:
            status = run.status
        return RunState(arrays, status, run.finding, run.end, run.time, run.diagnostics)


class _OnPiece(Observer):
    """Observer that calls a function at the end of each piece of a run.

    A class inside of ``StepCheck.__call__`` would keep its variables in memory until the
    garbage collection.
    """

    def __init__(self, function: Callable[[int, Callable[[], State]], None]) -> None:
        self._function = function

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        self._function(len(recorder.cycles), state)
        return False


# Numbers of a cycle, and the names of their errors in ``StageStatistics``
_CHECKED = {
    "load_distance": "load_distance_step_error",
    "force_max": "peak_force_step_error",
}


def _values_of(recorder: Recorder, piece: int) -> Array:
    """Return the checked numbers of a piece, (numbers, joints); NaN if it was not completed."""
    joints = range(recorder.records.memory.size)
    values = np.full((len(_CHECKED), len(joints)), np.nan)
    if piece < len(recorder.cycles):
        for row, name in zip(values, _CHECKED, strict=True):
            row[:] = [recorder.each_cycle(name, k)[piece] for k in joints]
    return values


@dataclass(frozen=True)
class StepCheck:
    """Check of the time step: pieces of a run are repeated with a 100 times smaller tolerance.

    Two runs at different tolerances diverge after some touchdowns, because the motion is
    chaotic. Their difference is then not the error of integration. Each piece therefore
    starts in a state of the run and is too short to diverge.
    """

    scene: Scene
    depth: Array  # wear depth of the surfaces, (joints, 2, bins), m
    replicate: int = -1  # replicates of stages have other numbers, from 0

    def __call__(self, report: Report) -> dict[str, float]:
        """Return the relative changes of load distance and of the peak forces of the pieces.

        They are the largest of all joints, by the names of ``StageStatistics``; empty
        where the engine has no tolerance or a run failed.
        """
        scene = self.scene
        linkage = linkage_on(self.scene, self.depth)
        cycle = scene.mechanism.period
        engine = scene.solver.for_cycle(cycle)
        finer: Engine | None = engine.finer(REFINEMENT)
        if finer is None or not linkage.clearances:
            return {}
        simulate_finer = finer.simulate
        start = start_of(scene, self.replicate)
        first = PIECES * SETTLING
        last = PIECES * (SETTLING + 1)
        plan = Plan(cycle / PIECES, last, 0, torques=False, run_up=scene.run_up)
        plan = replace(plan, report=lambda fraction, recorder: report(fraction))
        fine: dict[int, Array] = {}

        def refine(piece: int, state: Callable[[], State]) -> None:
            if first <= piece < last and (piece - first) % PIECE_STRIDE == 0:
                piece_plan = replace(plan, cycles=piece + 1, resume=state())
                repeated = simulate_finer(linkage, start, piece_plan)
                fine[piece] = _values_of(repeated.recorder, piece)

        run = engine.simulate(
            linkage, start, replace(plan, observers=(_OnPiece(refine),))
        )
        if run.status == "failed" or np.isnan([*fine.values()]).any():
            return {}
        usual = np.sum([_values_of(run.recorder, piece) for piece in fine], axis=0)
        change = np.abs(np.sum([*fine.values()], axis=0) - usual)
        relative = np.divide(change, usual, out=np.zeros_like(usual), where=usual > 0.0)
        return dict(zip(_CHECKED.values(), relative.max(axis=1).tolist(), strict=True))
