"""Press quantities of a stage: strokes, tonnage, drives, bottom dead centre, deep contacts.

They are computed from the stored arrays of a stage and from the ideal motion of its
scene.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import NamedTuple, get_args

import numpy as np

from presswear.linkage.elements import Bushing
from presswear.linkage.laws import Elasticity, NormalLaw
from presswear.linkage.linkage import Linkage
from presswear.physics.friction_and_normal import elastic_of, normal_record
from presswear.physics.ideal import Motion, bottom_of
from presswear.physics.loads import sizes_over
from presswear.physics.statics import (
    constraint_forces,
    forces_in_motion,
    friction_corners,
    load_corners,
)
from presswear.physics.touchdown import crossing, hermite
from presswear.recording import statistics
from presswear.recording.columns import (
    DRIVE_CYCLE,
    DURATION,
    first_leader_column,
    names_of,
)
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.corners import tilt_series
from presswear.results.stage import JointResult, StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.compile import Records
from presswear.tools.errors import RunFailed
from presswear.tools.numbers import quantity_text, readable
from presswear.tools.user_function import UserFunction

PHASES = ("approach", "work", "snap-through", "return")  # of a stroke
APPROACH, WORK, SNAP_THROUGH, RETURN = PHASES
# s after a fracture, in which press builders look for reversed loads
SNAP_THROUGH_S = 20e-3
ENERGY_BOUND = 1e-6  # residual over exchanged energy at the tolerances of a trajectory
# of the clearance: K delta^1.5 is 6 % above the foundation, the arc 49 degrees
SMALL_CONTACT = 0.1
LAW_WORDS = {
    "power": "K delta^1.5",
    "liu": "Liu's law",
    "foundation": "an elastic foundation",
}
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_PIECES = 720  # of the cycle of ideal torques
_PIECES_BEFORE = 90  # of the cycle before it


# Strokes on the work
# ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Strokes:
    """Instants of the recorded strokes on the work.

    Each array has the shape (strokes, 2): time, s, as ``StageResult.time``, and height
    over the ideal bottom dead centre, m; nan for a missing instant.
    """

    contact: Array  # the output touches the work
    fracture: Array  # the work breaks
    separation: Array  # the output leaves the height of the work again


class SampledStroke(NamedTuple):
    """Instants of a stroke after the start-up, s, by the clock; nan for a missing instant."""

    start: float  # upper dead centre of the ideal motion
    bottom: float  # bottom dead centre
    end: float  # next upper dead centre
    contact: float = math.nan
    fracture: float = math.nan
    done: float = math.nan  # the force of the work has vanished

    @property
    def phases(self) -> dict[str, tuple[float, float]]:
        """Start and end of each phase, s.

        Without work a stroke is approach down to bottom dead centre and return from
        there. Work lasts from contact to fracture, or until its force has vanished, and
        after ``SNAP_THROUGH_S`` of snap-through follows the return.
        """
        if math.isnan(self.contact):
            return {
                APPROACH: (self.start, self.bottom),
                RETURN: (self.bottom, self.end),
            }
        worked = after = self.done
        if not math.isnan(self.fracture):
            worked = self.fracture
            after = min(self.fracture + SNAP_THROUGH_S, self.end)
        times = (self.start, self.contact, worked, after, self.end)
        return dict(zip(PHASES, pairwise(times), strict=True))


def height_of(scene: Scene, stage: StageResult) -> Array:
    """Return the height of the output over the ideal bottom dead centre, shape (n,), m."""
    start = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    return np.asarray(stage.displacement + start - scene.bottom)


def _motion_of_work(scene: Scene, stage: StageResult) -> tuple[Array, Array]:
    """Return height, m, and velocity, m/s, of the point that the work presses on, (n,).

    Beside the middle of a slide that tilts it is higher than the output by the offset
    times the sine of the tilt. Without a series of the joints the tilt is unknown and
    left out.
    """
    height, velocity = height_of(scene, stage), stage.velocity
    offset = 0.0 if scene.process is None else scene.process.offset
    body = scene.base_linkage.output.body
    guides = [guide for guide in scene.loose_guides if guide.body == body]
    if offset == 0.0 or not guides or not stage.has_joint_series:
        return height, velocity
    rise = offset * np.sin(tilt_series(stage, guides[0]))
    # Times of successive rows may differ by round-off only.
    time, rows = np.unique(stage.clock, return_index=True)
    rate = np.interp(stage.clock, time, np.gradient(rise[rows], time))
    return height + rise, velocity + rate


def process_force(scene: Scene, stage: StageResult) -> Array | None:
    """Return the force of the work on the output at the times of the series, shape (n,), N.

    It is positive away from the work. None if the scene has no process.
    """
    if scene.process is None:
        return None
    height, velocity = _motion_of_work(scene, stage)
    place = height + scene.bottom
    motion = np.column_stack([stage.clock, place, velocity, stage.acceleration])
    sizes = sizes_over(scene.process_laws.values(), scene.loaded, motion)
    return np.asarray(sizes.sum(axis=1))


def strokes_of(scene: Scene, stage: StageResult) -> Strokes | None:
    """Return the strokes of the first replicate on the work; None if the scene has no process.

    A stroke starts with the first contact after the output was half way up between the
    work and the other end of the ideal stroke. Engines end a step, and write a row, at
    contact and fracture.
    """
    process = scene.process
    if process is None:
        return None
    height, velocity = _motion_of_work(scene, stage)
    missing = np.full((1, 2), math.nan)
    rows = []
    top = process.height
    broken = math.nan if process.fracture is None else top - process.fracture
    contacts, fractures = (
        _passes(stage, height, velocity, level, -1.0) for level in (top, broken)
    )
    leavings, turns = (
        _passes(stage, height, velocity, level, 1.0)
        for level in (top, top + scene.lift)
    )

    def between(instants: Array, start: float, end: float) -> Array:
        inside = instants[(instants[:, 0] > start) & (instants[:, 0] < end)]
        return inside if len(inside) else missing

    for start, end in pairwise([-math.inf, *turns[:, 0], math.inf]):
        contact = between(contacts, start, end)[0]
        if not math.isnan(contact[0]):
            fracture = between(fractures, contact[0], end)[0]
            # If the run ends before the stroke does, the output may only have bounced.
            is_whole = math.isfinite(end)
            left = between(leavings, contact[0], end)[-1] if is_whole else missing[0]
            rows.append((contact, fracture, left))
    return Strokes(*np.array(rows).reshape(-1, 3, 2).transpose(1, 0, 2))


def _passes(
    stage: StageResult, height: Array, velocity: Array, level: float, sign: float
) -> Array:
    """Return times at which the height rises (1.0) or falls (-1.0) to a level, and heights then."""
    off = sign * (height - level)
    rate = sign * velocity
    time = stage.clock
    instants = []
    for k in np.flatnonzero((off[:-1] < 0.0) & (off[1:] >= 0.0)):
        step = time[k + 1] - time[k]
        ends = off[k], rate[k], off[k + 1], rate[k + 1], step
        part = min(crossing(*ends), 1.0)
        instants.append((time[k] + part * step, level + sign * hermite(*ends, part)[0]))
    passes = np.array(instants).reshape(-1, 2)
    passes[:, 0] = stage.nominal_of(passes[:, 0])
    return passes


def sampled_strokes(scene: Scene, stage: StageResult) -> list[SampledStroke]:
    """Return the complete recorded strokes after the start-up, or the last complete one."""
    ideal = bottom_of(scene.ideal)
    time = stage.time
    if ideal is None or time.size < 2:
        return []
    period = ideal.period
    last = float(time[-1])
    noise = 1e-9 * ideal.period
    number = np.arange(int((last - scene.run_up) / period) + 2)
    starts = scene.run_up + ideal.top + period * number
    is_whole = (starts >= scene.run_up - noise) & (starts + period <= last + noise)
    is_sampled = is_whole & (number >= STARTUP_CYCLES)
    starts = starts[is_sampled] if is_sampled.any() else starts[is_whole][-1:]
    strokes = strokes_of(scene, stage)
    force = process_force(scene, stage)
    result = []
    for start in map(float, starts):
        stroke = SampledStroke(start, start + ideal.time - ideal.top, start + period)
        if strokes is not None and force is not None:
            when = strokes.contact[:, 0]
            for k in np.flatnonzero((when >= start) & (when < stroke.end))[:1]:
                contact = float(when[k])
                fracture = float(strokes.fracture[k, 0])
                pressed = time[(time > contact) & (time < stroke.end) & (force > 0.0)]
                done = float(pressed[-1]) if pressed.size else contact
                stroke = stroke._replace(contact=contact, fracture=fracture, done=done)
        result.append(SampledStroke(*map(float, stage.clock_of(np.array(stroke)))))
    return result


# Tonnage
# ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class JointTonnage:
    """Forces between pin and bearing of a joint, means over the sampled strokes, N.

    From ``working_force`` on, None if nothing breaks.
    """

    peak_by_phase: Mapping[str, Estimate]  # greatest force in each phase
    # greatest along the impulse from contact to fracture
    working_force: Estimate | None
    reversed_force: Estimate | None  # against it, within SNAP_THROUGH_S of the fracture
    reversed_fraction: Estimate | None  # reversed over working force, stroke by stroke
    reversal_time: Estimate | None  # from the fracture to the first reversed force, s


@dataclass(frozen=True)
class Tonnage:
    """Tonnage and shock in the sampled strokes of the first replicate of a stage.

    Reversed forces are those that inertia, drives at their prescribed motion and
    elastic contacts cause in each joint when the work gives way. They are not a bound
    of the reverse tonnage of a press, most of which is strain energy of frame, tools
    and drives.
    """

    strokes: int  # recorded sampled strokes, from upper dead centre to the next
    # greatest force of the work in a stroke, N; None: no process
    peak_force: Estimate | None
    work: Estimate | None  # work of the process in a stroke, J
    joints: Mapping[str, JointTonnage]
    # rms acceleration of the output minus the ideal one, m/s^2,
    vibration_before: Estimate | None
    vibration_after: Estimate | None  # SNAP_THROUGH_S before contact and after fracture


def tonnage_of(scene: Scene, stage: StageResult) -> Tonnage | None:
    """Return tonnage and shock in a stage; None if it failed or no stroke is complete."""
    strokes = [] if stage.failed else sampled_strokes(scene, stage)
    if not strokes:
        return None
    series = stage.joints if stage.has_joint_series else {}
    joints = {
        name: joint_tonnage(stage.clock, joint, strokes)
        for name, joint in series.items()
    }
    force = process_force(scene, stage)
    time = stage.clock
    peak = work = before = after = None
    if force is not None:
        height, _ = _motion_of_work(scene, stage)
        rows = [_rows(time, item.start, item.end) for item in strokes]
        peak = mean_of_strokes(float(force[part].max()) for part in rows)
        # The force is linear in height between two rows.
        work = mean_of_strokes(
            -float(np.trapezoid(force[part], height[part])) for part in rows
        )
        # To 1e-8 of the greatest acceleration, which is far below what contacts add.
        ideal = scene.ideal_slider(stage.time, closed=False)
        deviation = stage.acceleration - ideal[:, 2]
        window = SNAP_THROUGH_S
        broken = [item for item in strokes if not math.isnan(item.fracture)]
        before = mean_of_strokes(
            _rms(time, deviation, s.contact - window, s.contact) for s in broken
        )
        after = mean_of_strokes(
            _rms(time, deviation, s.fracture, s.fracture + window) for s in broken
        )
    return Tonnage(len(strokes), peak, work, joints, before, after)


def joint_tonnage(
    time: Array, joint: JointResult, strokes: list[SampledStroke]
) -> JointTonnage:
    """Return the forces of a joint in sampled strokes."""
    size = np.hypot(*joint.force.T)
    # A series has few rows in contacts that are light for the joint: their peaks are
    # stored.
    touchdown, separation, peak = map(
        joint.contact, ("touchdown", "separation", "peak_force")
    )
    peaks: dict[str, list[float]] = {name: [] for name in PHASES}
    for stroke in strokes:
        for name, (start, end) in stroke.phases.items():
            values = size[(time >= start) & (time < end)]
            within = peak[(touchdown >= start) & (separation < end)].max(initial=0.0)
            peaks[name] += (
                [max(float(values.max()), float(within))] if values.size else []
            )
    # Complex numbers are vectors: the force of the pin on its bearing in global
    # directions. The friction is stored as it acts on the pin.
    vector = np.array([1.0, 1j])
    pressed = (
        joint.force @ vector.conj() * np.exp(1j * np.angle(joint.eccentricity @ vector))
    )
    broken = [stroke for stroke in strokes if not math.isnan(stroke.fracture)]
    reversals = [_reversal(time, pressed, stroke) for stroke in broken]
    working, back, delay = np.array(reversals).reshape(-1, 3).T
    loaded = working > 0.0
    means = {
        name: mean
        for name, values in peaks.items()
        if (mean := mean_of_strokes(values)) is not None
    }
    fraction = back[loaded] / working[loaded]
    return JointTonnage(
        means,
        mean_of_strokes(working),
        mean_of_strokes(back),
        mean_of_strokes(fraction),
        mean_of_strokes(delay),
    )


def _reversal(
    time: Array, force: Array, stroke: SampledStroke
) -> tuple[float, float, float]:
    """Return the greatest working force and, after the fracture, the greatest reversed one, N.

    The third number is the time from the fracture to the first reversed force, s; nan
    if there is none within ``SNAP_THROUGH_S``. ``force`` are vectors as complex
    numbers.
    """
    into = _rows(time, stroke.contact, stroke.fracture)
    after = _rows(
        time, stroke.fracture, min(stroke.fracture + SNAP_THROUGH_S, stroke.end)
    )
    impulse = complex(np.trapezoid(force[into], time[into]))
    if impulse == 0.0:
        return 0.0, 0.0, math.nan
    along = (force * impulse.conjugate()).real / abs(impulse)
    against = np.maximum(-along[after], 0.0)
    delay = float(time[after][int((against > 0.0).argmax())]) - stroke.fracture
    back = float(against.max(initial=0.0))
    return float(along[into].max()), back, delay if back > 0.0 else math.nan


def _rms(time: Array, values: Array, start: float, end: float) -> float:
    """Return the root mean square of a series between two instants; nan for fewer than two rows."""
    rows = _rows(time, start, end)
    if time[rows].size < 2:
        return math.nan
    return math.sqrt(
        float(np.trapezoid(values[rows] ** 2, time[rows]) / np.ptp(time[rows]))
    )


def _rows(time: Array, start: float, end: float) -> slice:
    """Return the rows from one instant to another, both included."""
    noise = 1e-12 * max(abs(end), 1.0)
    ends = np.searchsorted(time, (start - noise, end + noise))
    return slice(int(ends[0]), int(ends[1]))


def mean_of_strokes(values: Iterable[float]) -> Estimate | None:
    """Return the mean over the values, from 0, that are numbers; None if there is none."""
    samples = np.array([float(value) for value in values if not math.isnan(value)])
    if not samples.size:
        return None
    half = statistics.half_width_of_runs([samples])
    return Estimate.symmetric(float(samples.mean()), half, samples.size).positive


# Drives
# -------------------------------------------------------------------------------------------


class Duty(NamedTuple):
    """Mean, root mean square and peak (farthest from zero, signed) of a quantity of a drive."""

    mean: float
    rms: float
    peak: float


@dataclass(frozen=True)
class DriveDuty:
    """Duty of a drive."""

    torque: Duty  # N m
    power: Duty  # W
    supplied: float  # energy that the drive supplies in a cycle, J
    returned: float  # energy that the linkage returns to it

    @property
    def work(self) -> float:
        """Net work in a cycle, J."""
        return self.supplied - self.returned


class DriveCurve(NamedTuple):
    """Drive over time, shape (n,) each; torque and power are empty if they were not stored."""

    time: Array  # s
    angle: Array  # of its body, rad
    torque: Array  # on its body, N m
    power: Array  # W


class DriveResult(NamedTuple):
    """Drive in a stage."""

    duty: DriveDuty  # of the run, integrated over all steps
    ideal: DriveDuty  # of rigid joints without friction
    # of rigid joints with the friction of their bearings, if any
    rubbing: DriveDuty | None
    # largest in magnitude of a cycle, mean over cycles, N m
    peak_torque: Estimate | None
    peak_power: Estimate | None  # W


def drives_of(scene: Scene, stage: StageResult) -> dict[str, DriveResult]:
    """Return the drives of a stage by their bodies; empty if torques were not stored.

    UntrustedLaw if the ideal torques need source code that is stored in a result.
    """
    if "drive_torque" not in stage.arrays or not stage.arrays["cycles"].size:
        return {}
    ideal = ideal_drives(scene)
    rubbing = rubbing_drives(scene)
    settling = stage.statistics.settling
    cycles = sampled_cycles(scene, stage)
    last = cycles[:, -len(DRIVE_CYCLE) * len(ideal) :].reshape(
        len(cycles), len(ideal), -1
    )
    numbers = {}
    peaks = {}
    for k, body in enumerate(ideal):
        columns = dict(zip(names_of(DRIVE_CYCLE), last[:, k].T, strict=True))
        peaks[body] = [
            mean_of_strokes(np.abs(columns[f"{name}_peak"]))
            for name in ("torque", "power")
        ]
        if stage.statistics.high_bumps or (settling and settling.is_mixture):
            peaks[body] = [peak and peak.without_interval for peak in peaks[body]]
        numbers[body] = {
            name: _farthest(values) if name.endswith("peak") else float(values.mean())
            for name, values in columns.items()
        }
    duties = _duties(numbers, _mean_duration(scene, stage, cycles))
    return {
        body: DriveResult(duties[body], ideal[body], rubbing.get(body), *peaks[body])
        for body in ideal
    }


def sampled_cycles(scene: Scene, stage: StageResult) -> Array:
    """Return the rows of the cycles after the start-up, of all replicates, as stored."""
    # The cycles of the second set of replicates are not used.
    start = stage.arrays["cycle_start"]
    settling = stage.statistics.settling
    replicates = [
        stage.arrays["cycles"][start == k][settling.skipped(k) if settling else 0 :]
        for k in range(scene.replicate_count)
    ]
    return np.concatenate([statistics.after_startup(rows) for rows in replicates])


def _mean_duration(scene: Scene, stage: StageResult, cycles: Array) -> float:
    """Return the mean duration of cycles, rows of a stage, s."""
    if not stage.has_clock:
        return scene.mechanism.period
    column = first_leader_column(len(stage.joint_names)) + DURATION
    return float(cycles[:, column].mean())


def rubbing_joints(scene: Scene) -> tuple[Bushing, ...]:
    """Return the pin joints with friction, whose laws act in rigid joints too.

    Empty if a friction law is source code that is stored in a result.
    """
    joints = scene.linkage().bushings
    laws = (one.friction.user_law for one in joints)
    return joints if all(law is None or law.is_trusted for law in laws) else ()


def rubbing_drives(scene: Scene) -> dict[str, DriveDuty]:
    """Return the duties of the drives of rigid joints with the friction of their bearings.

    Empty if no joint has friction, or if friction blocks the motion of rigid joints.
    """
    if not rubbing_joints(scene):
        return {}
    try:
        return ideal_drives(scene, rubs=True)
    except RunFailed:
        return {}


def ideal_drives(scene: Scene, rubs: bool = False) -> dict[str, DriveDuty]:
    """Return the duties of the drives of the linkage with rigid joints by their bodies.

    With ``rubs`` the joints have the friction of their bearings; RunFailed if it blocks
    the motion.
    """
    curves, weights = ideal_curves(scene, rubs)
    numbers = {
        body: {
            "torque_integral": float(weights @ curve.torque),
            "torque_square_integral": float(weights @ curve.torque**2),
            "power_square_integral": float(weights @ curve.power**2),
            "work_given": float(weights @ np.maximum(curve.power, 0.0)),
            "work_returned": float(weights @ np.maximum(-curve.power, 0.0)),
            "torque_peak": _farthest(curve.torque),
            "power_peak": _farthest(curve.power),
        }
        for body, curve in curves.items()
    }
    return _duties(numbers, float(weights.sum()))


@lru_cache(maxsize=16)  # a report uses them several times
def ideal_forces(scene: Scene) -> tuple[Array, dict[str, Array]]:
    """Return times in a cycle of rigid joints without friction, s, and the force of each pin, N.

    The forces are x + 1j y, shape (n,), on the first body; the first cycle after the
    run-up lets the laws of loads follow the motion and is left out.
    """
    linkage = scene.loaded
    ideal = scene.ideal
    period = scene.mechanism.period
    equal = scene.run_up + np.linspace(0.0, 2.0 * period, 2 * _PIECES, endpoint=False)
    # A load can be shorter than a piece. Corners next to an equal instant add nothing.
    corners = load_corners(
        linkage, ideal, np.append(equal, scene.run_up + 2.0 * period)
    )
    gaps = np.abs(corners[:, np.newaxis] - equal).min(axis=1)
    time = np.union1d(equal, corners[gaps > 1e-3 * period / _PIECES])
    is_last = time >= equal[_PIECES]
    holding_forces = constraint_forces(linkage, ideal, time)[is_last]
    pins = enumerate(linkage.revolutes)  # each has two rows
    return time[is_last], {
        one.name: holding_forces[:, 2 * k] + 1j * holding_forces[:, 2 * k + 1]
        for k, one in pins
    }


def _farthest(values: Array) -> float:
    return float(values[np.abs(values).argmax()])


def _duties(
    numbers: Mapping[str, Mapping[str, float]], period: float
) -> dict[str, DriveDuty]:
    """Return duties of drives from the numbers of a cycle, which are named in ``DRIVE_CYCLE``."""
    duties = {}
    for body, item in numbers.items():
        supplied = item["work_given"]
        returned = item["work_returned"]
        means = item["torque_integral"] / period, (supplied - returned) / period
        torque, power = (
            Duty(
                mean,
                math.sqrt(item[f"{name}_square_integral"] / period),
                item[f"{name}_peak"],
            )
            for name, mean in zip(("torque", "power"), means, strict=True)
        )
        duties[body] = DriveDuty(torque, power, supplied, returned)
    return duties


def curves_of(scene: Scene, stage: StageResult) -> dict[str, DriveCurve]:
    """Return the drives of a stage by their bodies; without torques if none were stored."""
    motion = scene.ideal.at(stage.time)
    torque = stage.arrays.get("drive_torque")
    if stage.has_clock:
        rate = stage.nominal_rate[:, np.newaxis]
        motion = replace(motion, velocity=motion.velocity * rate)
    return _curves(scene.mechanism.linkage(), motion, torque)


def _curves(
    linkage: Linkage, motion: Motion, torque: Array | None
) -> dict[str, DriveCurve]:
    """Return drives by their bodies in a motion."""
    curves = {}
    for k, drive in enumerate(linkage.drives):
        place = 3 * linkage.index(drive.body) + 2
        item = np.zeros(0) if torque is None else torque[:, k]
        power = item * motion.velocity[: item.size, place]
        curves[drive.body] = DriveCurve(
            motion.time, motion.position[:, place], item, power
        )
    return curves


@lru_cache(maxsize=16)
def ideal_curves(
    scene: Scene, rubs: bool = False
) -> tuple[dict[str, DriveCurve], Array]:
    """Return the drives of rigid joints over a cycle after the run-up, by their bodies.

    The array holds the weights of the instants in an integral over the cycle, s. With
    ``rubs`` the joints have the friction of their bearings.
    """
    bushings = rubbing_joints(scene) if rubs else ()
    start = scene.run_up
    period = scene.mechanism.period
    # The laws of loads are followed through a cycle before.
    before, cycle = (
        np.linspace(0.0, period, count + 1) for count in (_PIECES_BEFORE, _PIECES)
    )
    edges = start + np.concatenate([before, period + cycle[1:]])
    corners = load_corners(scene.loaded, scene.ideal, edges)
    if bushings:
        turns = friction_corners(scene.loaded, scene.ideal, edges, bushings)
        corners = np.union1d(corners, turns)
    edges = np.union1d(edges, corners)
    # Supplied and returned energy have a kink where the power of a drive changes its
    # sign.
    for _ in range(2):
        for time, _, _, power in _integrated(scene, edges, corners, bushings)[
            0
        ].values():
            k = np.flatnonzero(power[1:] * power[:-1] < 0.0)
            turns = time[k] - power[k] * np.diff(time)[k] / np.diff(power)[k]
            edges = np.union1d(edges, turns)
    return _integrated(scene, edges, corners, bushings)


def _integrated(
    scene: Scene, edges: Array, corners: Array, bushings: Sequence[Bushing]
) -> tuple[dict[str, DriveCurve], Array]:
    """Return ideal drives and Gauss weights, s, in the last cycle between some edges, s.

    Corners of loads, s, where a peak can be, are instants of the weight 0.
    """
    middle = 0.5 * (edges[1:] + edges[:-1])
    half = 0.5 * np.diff(edges)
    inner = (middle[:, np.newaxis] + half[:, np.newaxis] * _NODES).ravel()
    time = np.concatenate([inner, corners])
    weights = np.append(np.outer(half, _WEIGHTS).ravel(), np.zeros(corners.size))
    order = np.argsort(time, kind="stable")
    time = time[order]
    weights = weights[order]
    linkage = scene.loaded
    motion = scene.ideal.at(time)
    forces = forces_in_motion(linkage, scene.ideal, motion, bushings)
    curves = _curves(linkage, motion, forces[:, -len(linkage.drives) :])
    last = time > edges[-1] - scene.mechanism.period
    cut = {
        body: DriveCurve(*(part[last] for part in curve))
        for body, curve in curves.items()
    }
    return cut, weights[last]


# Bottom dead centre
# -------------------------------------------------------------------------------


def bottom_errors(scene: Scene, stage: StageResult) -> list[tuple[Array, Array]]:
    """Return the strokes of each replicate, by number, and bottom dead centre over the ideal, m.

    Each array has the shape (strokes,); empty if nothing moves.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return []
    error = stage.each_cycle("bottom_height") - ideal.height
    start = stage.arrays["cycle_start"]
    rows = [error[start == replicate][ideal.first :] for replicate in np.unique(start)]
    return [(ideal.first + 1.0 + np.arange(item.size), item) for item in rows]


def rise(stage: StageResult, since: StageResult) -> Estimate | None:
    """Return how much higher bottom dead centre is in a stage than in another, m.

    The other stage is the unworn one, which gives the drift by wear, or that of a run
    at another speed. Both are taken as independent. None if either has no sampled
    stroke.
    """
    later = stage.statistics.bdc
    earlier = since.statistics.bdc
    if later is None or earlier is None:
        return None
    halves = later.error.half_width, earlier.error.half_width
    half = None if None in halves else math.hypot(*filter(None, halves))
    return Estimate.symmetric(later.error.mean - earlier.error.mean, half)


# Deep contacts
# ------------------------------------------------------------------------------------


def penetrations(scene: Scene, stages: Sequence[StageResult]) -> dict[str, float]:
    """Return the largest recorded penetration of each joint over its clearance."""
    ratios = {}
    for name in scene.loose_pins:
        arrays = [stage.arrays for stage in stages if not stage.failed]
        depths = [
            one[f"{name}_penetration"].max(initial=0.0)
            for one in arrays
            if _has(one, name)
        ]
        ratios[name] = float(max(depths, default=0.0)) / scene.bearing(name).clearance
    return ratios


def _has(arrays: Mapping[str, Array], joint: str) -> bool:
    return f"{joint}_penetration" in arrays


def forces_by_law(scene: Scene, joint: str, force: float) -> dict[str, float]:
    """Return the peak force, N, of each elastic law for the elastic energy of a peak force, N.

    The law of the scene stores that energy in round surfaces up to the force, and an
    impact of the same energy is assumed for all laws. A force that the load prescribes
    is the same for all laws, and a forced penetration makes them differ more. Empty for
    a user law, and for an exponent other than 1.5, which the laws of conforming pins do
    not have.
    """
    bearing = scene.bearing(joint)
    conventions = scene.conventions
    if isinstance(bearing.normal_law, UserFunction) or bearing.exponent != 1.5:
        return {}
    records = {}
    for law in get_args(Elasticity):
        stiffness = bearing.normal_stiffness(law, conventions.stiffness)
        records[law] = normal_record(
            NormalLaw(stiffness, elasticity=law), bearing.clearance
        )
    used = records[bearing.elastic_law(conventions.contact)]
    energy = elastic_of(used, _depth_of(used, 0, force))[1]
    return {
        law: elastic_of(one, _depth_of(one, 1, energy))[0]
        for law, one in records.items()
    }


def _depth_of(law: Records, kind: int, value: float) -> float:
    """Return the penetration, m, of a force, N (kind 0), or of an elastic energy, J (kind 1)."""
    low, high = 0.0, float(law["clearance"])
    while elastic_of(law, high)[kind] < value:
        low, high = high, 2.0 * high
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (
            (middle, high) if elastic_of(law, middle)[kind] < value else (low, middle)
        )
    return high


def deep_contacts(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on joints whose penetration is too large for a stiffness of small contacts.

    The surfaces overlap by e cos(x) - c at an angle x from the line of centres: over an
    arc of which c / (c + penetration) is the cosine of the half.
    """
    sentences = []
    for name, ratio in penetrations(scene, stages).items():
        if ratio <= SMALL_CONTACT:
            continue
        arc = math.degrees(2.0 * math.acos(1.0 / (1.0 + ratio)))
        deepest = 1e6 * ratio * scene.bearing(name).clearance
        text = (
            f"Joint {name}: the pin penetrates its bearing by {readable(deepest)} µm, "
            f"{readable(ratio)} of the clearance, and touches it over {arc:.0f} degrees. The "
            "contact law is made for small contacts; here bottom dead centre under load may be "
            "wrong, forces less so."
        )
        last = next(one for one in reversed(stages) if not one.failed)
        joint = last.statistics.joints.get(name)
        if joint and (
            forces := forces_by_law(scene, name, joint.peak_force_per_cycle.mean)
        ):
            used = scene.bearing(name).elastic_law(scene.conventions.contact)
            rest = [
                f"{quantity_text(force, 'N')} by {LAW_WORDS[law]}"
                for law, force in forces.items()
                if law != used
            ]
            text += f" The peak force is {quantity_text(forces[used], 'N')} by {LAW_WORDS[used]}. "
            text += f"An impact of the same elastic energy gives {' and '.join(rest)}; a load that "
            text += "prescribes the force gives the same by all."
        sentences.append(f"{text} A measured contact_stiffness reduces this doubt.")
    return sentences


def high_bumps(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on stages whose surfaces have bumps higher than the penetration."""
    advice = (
        "life.quick = off"
        if scene.is_quick
        else "more cycles, or extrapolation = steps"
    )
    sentences = []
    for stage in stages:
        rough = [
            f"{name} ({readable(1e6 * one.height, 2)} µm, penetration "
            f"{readable(1e6 * one.penetration, 2)} µm)"
            for name, one in stage.statistics.high_bumps.items()
        ]
        if rough:
            sentences.append(
                f"{stage.name.capitalize()}: bumps are higher than the penetration at joint "
                f"{' and '.join(rough)}, because one jump multiplies the noise of its wear map. "
                f"Contacts and peak values have no interval; use {advice}."
            )
    return sentences


def contact_warnings(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on contacts that are too deep for the model, or on rough surfaces."""
    return deep_contacts(scene, stages) + high_bumps(scene, stages)


# Sampled motion
# -----------------------------------------------------------------------------------


def has_motion(scene: Scene, stage: StageResult) -> bool:
    """Return whether a complete cycle of a motion with clearance was recorded."""
    if stage.failed or not stage.has_joint_series or stage.time.size < 2:
        return False
    start, end = sampled_span(scene, stage)
    return end - start > 0.99 * scene.mechanism.period


def sampled_span(scene: Scene, stage: StageResult) -> tuple[float, float]:
    """Return start and end of the recorded motion after the start-up, s; complete cycles.

    They are values of ``StageResult.time``.
    """
    period = scene.mechanism.period
    run_up = scene.run_up
    whole = int((float(stage.time[-1]) - run_up) / period + 0.02)
    first = max(min(STARTUP_CYCLES, whole - 1), 0)
    end = run_up + max(whole, first + 1) * period
    return run_up + first * period, min(end, float(stage.time[-1]))
