"""Press quantities of a stage: strokes on the work, tonnage, drives, energy, bottom dead centre and
deep contacts.

They are computed from the stored arrays of a stage and from the ideal motion of its scene.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.physics.friction_and_normal import elastic_force, foundation_force, liu_force
from presswear.physics.ideal import bottom_of
from presswear.physics.loads import sizes_over
from presswear.physics.statics import needed_torques
from presswear.physics.touchdown import crossing, hermite
from presswear.recording.observe import CYCLE_DRIVE
from presswear.recording.statistics import (
    STARTUP_CYCLES,
    Estimate,
    after_startup,
    batched,
    half_width,
)
from presswear.results.stage import JointResult, StageResult
from presswear.scene.scene import Scene
from presswear.tools.numbers import readable
from presswear.tools.user_function import UserFunction

Array = NDArray[np.float64]

PHASES = ("approach", "work", "snap-through", "return")  # of a stroke
APPROACH, WORK, SNAP_THROUGH, RETURN = range(len(PHASES))
SNAP_THROUGH_S = 20e-3  # s after a fracture, in which press builders look for reversed loads
ENERGY_BOUND = 1e-6  # residual over exchanged energy at the tolerances of a trajectory
SMALL_CONTACT = 0.1  # of the clearance: K delta^1.5 is 6 % above the foundation, the arc 49 degrees
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_PIECES, _PIECES_BEFORE = 720, 90  # of the cycle of ideal torques, and of the one before it


# Strokes on the work ------------------------------------------------------------------------------


@dataclass(frozen=True)
class Strokes:
    """Instants of the recorded strokes on the work.

    Each array has the shape (strokes, 2): time, s, and height over the ideal bottom dead centre, m;
    nan for a missing instant.
    """

    contact: Array  # the output touches the work
    fracture: Array  # the work breaks
    separation: Array  # the output leaves the height of the work again


@dataclass(frozen=True)
class SettledStroke:
    """Instants of a stroke after the start-up, s; nan for a missing instant."""

    start: float  # upper dead centre of the ideal motion
    bottom: float  # bottom dead centre
    end: float  # next upper dead centre
    contact: float = math.nan
    fracture: float = math.nan
    done: float = math.nan  # the force of the work has vanished


def _output(scene: Scene, stage: StageResult) -> Array:
    start = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    return np.asarray(stage.displacement + start)


def height_of(scene: Scene, stage: StageResult) -> Array:
    """Return the height of the output over the ideal bottom dead centre, shape (n,), m."""
    return np.asarray(_output(scene, stage) - scene.bottom)


def process_force(scene: Scene, stage: StageResult) -> Array | None:
    """Return the force of the work on the output at the times of the series, shape (n,), N.

    It is positive away from the work. None if the scene has no process.
    """
    if scene.process is None:
        return None
    series = (stage.time, _output(scene, stage), stage.velocity, stage.acceleration)
    sizes = sizes_over(scene.process_laws.values(), scene.loaded, np.column_stack(series))
    return np.asarray(sizes.sum(axis=1))


def strokes_of(scene: Scene, stage: StageResult) -> Strokes | None:
    """Return the strokes of the first replicate on the work; None if the scene has no process.

    A stroke starts with the first contact after the output was half way up between the work and
    the other end of the ideal stroke. Engines end a step, and write a row, at contact and fracture.
    """
    process = scene.process
    if process is None:
        return None
    height, rate, time = height_of(scene, stage), stage.velocity, stage.time

    def crossings(level: float, up: bool) -> list[tuple[float, float]]:
        """Return instants at which the height crosses a level, and its height then."""
        sign = 1.0 if up else -1.0
        off = sign * (height - level)
        instants = []
        for k in np.flatnonzero((off[:-1] < 0.0) & (off[1:] >= 0.0)):
            h = time[k + 1] - time[k]
            ends = off[k], sign * rate[k], off[k + 1], sign * rate[k + 1], h
            part = min(crossing(*ends), 1.0)
            instants.append((time[k] + part * h, level + sign * hermite(*ends, part)[0]))
        return instants

    def first(instants: Any, start: float, end: float) -> tuple[float, float]:
        inside = (instant for instant in instants if start < instant[0] < end)
        return next(inside, (math.nan, math.nan))

    contacts, leaving = crossings(process.height, False), crossings(process.height, True)
    breaks = process.fracture
    broken = [] if breaks is None else crossings(process.height - breaks, False)
    turned = [instant for instant, _ in crossings(process.height + scene.lift, True)]
    rows = []
    for start, end in pairwise([-np.inf, *turned, np.inf]):
        contact = first(contacts, start, end)
        if not math.isnan(contact[0]):
            # If the run ends before the stroke does, the output may only have bounced.
            last = reversed(leaving) if np.isfinite(end) else ()
            rows.append((contact, first(broken, contact[0], end), first(last, contact[0], end)))
    return Strokes(*np.array(rows).reshape(-1, 3, 2).transpose(1, 0, 2))


def settled_strokes(scene: Scene, stage: StageResult) -> list[SettledStroke]:
    """Return the complete recorded strokes after the start-up, or the last complete one."""
    ideal, time = bottom_of(scene.ideal), stage.time
    if ideal is None or time.size < 2:
        return []
    period, last = ideal.period, float(time[-1])
    number = np.arange(int((last - scene.run_up) / period) + 2)
    begins = scene.run_up + ideal.top + period * number
    noise = 1e-9 * period
    is_whole = (begins >= scene.run_up - noise) & (begins + period <= last + noise)
    settled = is_whole & (number >= STARTUP_CYCLES)
    begins = begins[settled] if settled.any() else begins[is_whole][-1:]
    strokes, force = strokes_of(scene, stage), process_force(scene, stage)
    result = []
    for start in map(float, begins):
        stroke = SettledStroke(start, start + ideal.time - ideal.top, start + period)
        if strokes is not None and force is not None:
            inside = (strokes.contact[:, 0] >= start) & (strokes.contact[:, 0] < stroke.end)
            if inside.any():
                k = int(inside.argmax())
                contact, fracture = float(strokes.contact[k, 0]), float(strokes.fracture[k, 0])
                pressed = time[(time > contact) & (time < stroke.end) & (force > 0.0)]
                done = float(pressed[-1]) if pressed.size else contact
                stroke = replace(stroke, contact=contact, fracture=fracture, done=done)
        result.append(stroke)
    return result


def phases_of(time: Array, strokes: list[SettledStroke]) -> NDArray[np.int64]:
    """Return the phase of each instant, an index of ``PHASES``, shape (n,); -1 outside strokes.

    Without work a stroke is approach down to bottom dead centre and return from there. Work lasts
    from contact to fracture, or until its force has vanished, and after ``SNAP_THROUGH_S`` of
    snap-through follows the return.
    """
    phases = np.full(time.size, -1)
    for item in strokes:
        intervals = [(item.start, item.bottom, APPROACH), (item.bottom, item.end, RETURN)]
        if not math.isnan(item.contact):
            ended = item.done if math.isnan(item.fracture) else item.fracture
            intervals = [
                (item.start, item.contact, APPROACH),
                (item.contact, ended, WORK),
                (ended, item.end, RETURN),
            ]
            if not math.isnan(item.fracture):
                intervals.append((ended, min(ended + SNAP_THROUGH_S, item.end), SNAP_THROUGH))
        for start, end, phase in intervals:
            phases[(time >= start) & (time < end)] = phase
    return phases


# Tonnage ------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class JointTonnage:
    """Forces between pin and bearing of a joint over the settled strokes, N.

    From ``working_force`` on, None if nothing breaks.
    """

    peak_by_phase: Mapping[str, Estimate]  # mean over strokes of the greatest force in each phase
    largest_by_phase: Mapping[str, float]  # greatest of all strokes
    working_force: Estimate | None = None  # greatest along the impulse from contact to fracture
    reversed_force: Estimate | None = None  # against it, within SNAP_THROUGH_S of the fracture
    reversed_fraction: Estimate | None = None  # reversed over working force, stroke by stroke
    reversal_time: Estimate | None = None  # from the fracture to the first reversed force, s


@dataclass(frozen=True)
class Vibration:
    """Acceleration of the output minus the ideal one, rms in each stroke, m/s^2."""

    after: Estimate  # over SNAP_THROUGH_S after the fracture
    before: Estimate  # over SNAP_THROUGH_S before the contact
    ideal: Estimate  # ideal acceleration itself, after the fracture


@dataclass(frozen=True)
class Tonnage:
    """Tonnage and shock in the settled strokes of the first replicate of a stage.

    The frame of this model is rigid and the work pushes one way: there is no tension at the punch,
    and no strain energy of frame, tools or drives is released at fracture, which on a press causes
    most of its reverse tonnage. Reversed forces are those that inertia, drives at their prescribed
    motion and elastic contacts cause in each joint when the work gives way. They are no bound of a
    press's reverse tonnage.
    """

    strokes: int  # recorded settled strokes, from upper dead centre to the next
    peak_force: Estimate | None  # greatest force of the work in a stroke, N; None: no process
    work: Estimate | None  # work of the process in a stroke, J
    joints: Mapping[str, JointTonnage]
    vibration: Vibration | None  # None: nothing breaks
    most_loaded: str | None  # joint with the greatest mean peak force of all replicates


def tonnage_of(scene: Scene, stage: StageResult) -> Tonnage | None:
    """Return tonnage and shock in a stage; None if it failed or no stroke is complete."""
    strokes = [] if stage.failed else settled_strokes(scene, stage)
    if not strokes:
        return None
    phase = phases_of(stage.time, strokes)
    joints = {
        name: joint_tonnage(stage.time, joint, strokes, phase)
        for name, joint in (stage.joints if stage.has_joint_series else {}).items()
    }
    peaks = {
        name: item.peak_force_per_cycle.mean
        for name, item in stage.statistics.joints.items()
        if name in joints
    }
    force = process_force(scene, stage)
    peak = work = None
    if force is not None:
        height = height_of(scene, stage)
        rows = [_rows(stage.time, item.start, item.end) for item in strokes]
        peak = _mean([float(force[part].max()) for part in rows])
        # The force is linear in height between two rows.
        work = _mean([-float(np.trapezoid(force[part], height[part])) for part in rows])
    most_loaded = max(peaks, key=lambda name: peaks[name], default=None)
    vibration = _vibration(scene, stage, strokes)
    return Tonnage(len(strokes), peak, work, joints, vibration, most_loaded)


def joint_tonnage(
    time: Array, joint: JointResult, strokes: list[SettledStroke], phase: NDArray[np.int64]
) -> JointTonnage:
    """Return the forces of a joint in settled strokes; ``phase`` is that of ``phases_of``."""
    size = np.hypot(*joint.force.T)
    peaks: dict[str, list[float]] = {}
    for stroke in strokes:
        inside = (time >= stroke.start) & (time < stroke.end)
        for place, name in enumerate(PHASES):
            here = size[inside & (phase == place)]
            if here.size:
                peaks.setdefault(name, []).append(float(here.max()))
    reach = np.hypot(*joint.eccentricity.T)
    normal = joint.eccentricity / np.where(reach > 0.0, reach, 1.0)[:, np.newaxis]
    across = np.column_stack([-normal[:, 1], normal[:, 0]])
    pressed = joint.force[:, :1] * normal + joint.force[:, 1:] * across
    reversals = [
        reversal(time, pressed, stroke) for stroke in strokes if not math.isnan(stroke.fracture)
    ]
    working, back, delay = np.array(reversals).reshape(-1, 3).T
    loaded = working > 0.0
    return JointTonnage(
        {name: _estimate(values) for name, values in peaks.items()},
        {name: max(values) for name, values in peaks.items()},
        _mean(working),
        _mean(back),
        _mean(back[loaded] / working[loaded]),
        _mean(delay),
    )


def reversal(time: Array, force: Array, stroke: SettledStroke) -> tuple[float, float, float]:
    """Return the greatest working force and, after the fracture, the greatest reversed one, N.

    The third number is the time from the fracture to the first reversed force, s; nan if there is
    none within ``SNAP_THROUGH_S``.

    Parameters
    ----------
    force : ndarray, shape (n, 2)
        Force of the pin on its bearing, N.
    """
    into = _rows(time, stroke.contact, stroke.fracture)
    after = _rows(time, stroke.fracture, min(stroke.fracture + SNAP_THROUGH_S, stroke.end))
    impulse = [float(np.trapezoid(values, time[into])) for values in force[into].T]
    size = math.hypot(*impulse)
    if size == 0.0:
        return 0.0, 0.0, math.nan
    along = force @ np.array(impulse) / size
    against = -along[after]
    delay = math.nan
    if (against > 0.0).any():
        delay = float(time[after][int((against > 0.0).argmax())]) - stroke.fracture
    return float(along[into].max()), max(float(against.max(initial=0.0)), 0.0), delay


def _vibration(scene: Scene, stage: StageResult, strokes: list[SettledStroke]) -> Vibration | None:
    time, samples = stage.time, []
    for stroke in strokes:
        if math.isnan(stroke.fracture):
            continue
        after = _rows(time, stroke.fracture, stroke.fracture + SNAP_THROUGH_S)
        before = _rows(time, stroke.contact - SNAP_THROUGH_S, stroke.contact)
        if time[after].size < 2 or time[before].size < 2:
            continue
        ideal, calm = (scene.ideal_slider(time[part])[:, 2] for part in (after, before))
        windows = (
            (after, stage.acceleration[after] - ideal),
            (before, stage.acceleration[before] - calm),
            (after, ideal),
        )
        samples.append(
            [
                math.sqrt(float(np.trapezoid(values**2, time[rows]) / np.ptp(time[rows])))
                for rows, values in windows
            ]
        )
    return Vibration(*map(_estimate, np.transpose(samples))) if samples else None


def _rows(time: Array, start: float, end: float) -> slice:
    """Return the rows from one instant to another, both included."""
    noise = 1e-12 * max(abs(end), 1.0)
    ends = np.searchsorted(time, (start - noise, end + noise))
    return slice(int(ends[0]), int(ends[1]))


def _estimate(values: Array | Sequence[float]) -> Estimate:
    samples = np.asarray(values)
    return Estimate.symmetric(float(samples.mean()), half_width(batched(samples)), samples.size)


def _mean(values: Array | Sequence[float]) -> Estimate | None:
    """Return the mean over the values that are numbers; None if there is none."""
    numbers = [float(value) for value in values if not math.isnan(value)]
    return _estimate(numbers) if numbers else None


# Drives and energy --------------------------------------------------------------------------------


@dataclass(frozen=True)
class Duty:
    """Mean, root mean square and peak (farthest from zero, signed) of a quantity of a drive."""

    mean: float
    rms: float
    peak: float


@dataclass(frozen=True)
class Share:
    """Fractions of one drive in the sums over all drives; 0 if the sum is 0."""

    rms_torque: float
    peak_power: float
    energy: float


@dataclass(frozen=True)
class DriveDuty:
    """Duty of a drive."""

    torque: Duty  # N m
    power: Duty  # W
    supplied: float  # energy that the drive supplies in a cycle, J
    returned: float  # energy that the linkage returns to it
    share: Share = Share(0.0, 0.0, 0.0)

    @property
    def work(self) -> float:
        """Net work in a cycle, J."""
        return self.supplied - self.returned


@dataclass(frozen=True)
class DriveCurve:
    """Drive over time, shape (n,) each; torque and power are empty if they were not stored."""

    time: Array  # s
    angle: Array  # of its body, rad
    torque: Array  # on its body, N m
    power: Array  # W


@dataclass(frozen=True)
class DriveResult:
    """Drive in a stage."""

    recorded: DriveCurve  # at the times of the series
    duty: DriveDuty  # of the run, integrated over all steps
    ideal: DriveDuty  # of the linkage without clearance


@dataclass(frozen=True)
class Energy:
    """Energy for one manufactured part, which takes one stroke or cycle, J."""

    process_work: Estimate | None  # that the process absorbs in the recorded settled strokes
    ideal_process_work: float | None  # without clearance, and without a cushion
    drive_work: Estimate  # net work of all drives over the settled cycles of all replicates
    ideal_drive_work: float  # without clearance
    residual_fraction: float  # residual of the energy balance over energy that the drives exchanged


def drives_of(scene: Scene, stage: StageResult) -> dict[str, DriveResult]:
    """Return the drives of a stage by their bodies; empty if torques were not stored.

    Raises
    ------
    UntrustedLaw
        If the ideal torques need source code that is stored in a result.
    """
    if "drive_torque" not in stage.arrays or not stage.arrays["cycles"].size:
        return {}
    start, period = stage.arrays["cycle_start"], scene.mechanism.period
    # The cycles of the second set of replicates are not used.
    replicates = [stage.drive_cycles[start == k] for k in range(scene.replicate_count)]
    cycles = np.concatenate([after_startup(rows) for rows in replicates])
    recorded, ideal = curves_of(scene, stage), ideal_drives(scene)
    duties = _with_shares(
        {body: _duty_of_cycles(cycles[:, k], period) for k, body in enumerate(recorded)}
    )
    return {body: DriveResult(item, duties[body], ideal[body]) for body, item in recorded.items()}


def ideal_drives(scene: Scene) -> dict[str, DriveDuty]:
    """Return the duties of the drives of the linkage without clearance by their bodies."""
    curves, weights = _ideal_curves(scene)
    return _with_shares({body: _duty(curve, weights) for body, curve in curves.items()})


def ideal_curves(scene: Scene) -> dict[str, DriveCurve]:
    """Return the drives without clearance over a cycle after the run-up, by their bodies."""
    return _ideal_curves(scene)[0]


def energy_of(scene: Scene, stage: StageResult) -> Energy | None:
    """Return the energy of a part; None if the stage failed before a cycle was complete."""
    statistics = stage.statistics
    if statistics.drive_work_per_cycle is None:
        return None
    residual, exchanged = abs(statistics.energy_residual), statistics.energy_exchanged
    tonnage = tonnage_of(scene, stage)
    return Energy(
        None if tonnage is None else tonnage.work,
        None if scene.process is None else scene.process.work,
        statistics.drive_work_per_cycle,
        sum(duty.work for duty in ideal_drives(scene).values()),
        residual / exchanged if exchanged > 0.0 else 0.0,
    )


def curves_of(scene: Scene, stage: StageResult) -> dict[str, DriveCurve]:
    """Return the drives over the series by their bodies."""
    return _curves(scene, stage.time, stage.arrays.get("drive_torque"))


def _curves(scene: Scene, time: Array, torque: Array | None) -> dict[str, DriveCurve]:
    """Return drives by their bodies from their torques, shape (n, drives), N m."""
    linkage, motion = scene.mechanism.linkage(), scene.ideal.at(time)
    curves = {}
    for k, drive in enumerate(linkage.drives):
        place = 3 * linkage.index(drive.body) + 2
        item = np.zeros(0) if torque is None else torque[:, k]
        power = item * motion.velocity[: item.size, place]
        curves[drive.body] = DriveCurve(time, motion.position[:, place], item, power)
    return curves


@lru_cache(maxsize=16)
def _ideal_curves(scene: Scene) -> tuple[dict[str, DriveCurve], Array]:
    """Return the drives over a cycle of the ideal motion, and the weights of its instants, s."""
    start, period = scene.run_up, scene.mechanism.period
    # The laws of loads are followed through a cycle before.
    before, cycle = (np.linspace(0.0, period, count + 1) for count in (_PIECES_BEFORE, _PIECES))
    edges = start + np.concatenate([before, period + cycle[1:]])
    edges = np.unique(np.concatenate([edges, _kinks(scene, edges)]))
    curves, _ = _integrated(scene, edges)
    # Supplied and returned energy have a kink where the power of a drive changes its sign.
    cycle = edges[-1 - next(iter(curves.values())).time.size // _NODES.size :]
    turns = [_zeros(cycle, curve.power) for curve in curves.values()]
    return _integrated(scene, np.unique(np.concatenate([edges, *turns])))


def _integrated(scene: Scene, edges: Array) -> tuple[dict[str, DriveCurve], Array]:
    """Return ideal drives and Gauss weights in the last cycle between some edges, s."""
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    time = (middle[:, np.newaxis] + half[:, np.newaxis] * _NODES).ravel()
    torque = needed_torques(scene.loaded, scene.ideal, time)
    last = time > edges[-1] - scene.mechanism.period
    return _curves(scene, time[last], torque[last]), np.outer(half, _WEIGHTS).ravel()[last]


def _zeros(edges: Array, values: Array) -> Array:
    """Return the instants, s, at which parabolas through the values in each piece are zero."""
    a, b, c = np.linalg.solve(np.vander(_NODES), values.reshape(-1, _NODES.size).T)
    with np.errstate(divide="ignore", invalid="ignore"):
        far = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        roots = [far / a, c / far]
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    return np.concatenate([(middle + half * root)[np.abs(root) < 1.0] for root in roots])


def _kinks(scene: Scene, time: Array) -> Array:
    """Return the instants, s, at which the ideal stroke passes a kink of the force of the work."""
    from scipy.interpolate import CubicHermiteSpline  # slow to import

    process = scene.process
    if process is None:
        return np.zeros(0)
    place, speed, _ = scene.ideal.at(time).output(scene.loaded).T
    depth = CubicHermiteSpline(time, process.height - (place - scene.bottom), -speed)
    kinks = np.concatenate([depth.solve(level, False, False) for level, _ in process.curve])
    return np.asarray(kinks[np.isfinite(kinks)])


def _duty_of_cycles(cycles: Array, period: float) -> DriveDuty:
    """Return the duty of a drive from its cycles, shape (n, columns CYCLE_DRIVE)."""
    column = dict(zip(CYCLE_DRIVE, cycles.T, strict=True))
    mean = {name: float(values.mean()) for name, values in column.items()}
    peak = {name: float(values[np.abs(values).argmax()]) for name, values in column.items()}
    rms = {
        name: math.sqrt(mean[f"{name}_square_integral"] / period) for name in ("torque", "power")
    }
    supplied, returned = mean["work_given"], mean["work_returned"]
    return DriveDuty(
        Duty(mean["torque_integral"] / period, rms["torque"], peak["torque_peak"]),
        Duty((supplied - returned) / period, rms["power"], peak["power_peak"]),
        supplied,
        returned,
    )


def _duty(curve: DriveCurve, weights: Array) -> DriveDuty:
    """Return the duty of a drive over a cycle from the weights, s, of its instants."""
    duration = float(weights.sum())
    torque, power = (
        Duty(
            float(weights @ values) / duration,
            math.sqrt(float(weights @ values**2) / duration),
            float(values[np.abs(values).argmax()]),
        )
        for values in (curve.torque, curve.power)
    )
    supplied, returned = (
        float(weights @ np.maximum(sign * curve.power, 0.0)) for sign in (1.0, -1.0)
    )
    return DriveDuty(torque, power, supplied, returned)


def _with_shares(duties: Mapping[str, DriveDuty]) -> dict[str, DriveDuty]:
    numbers = [(duty.torque.rms, duty.power.peak, duty.supplied) for duty in duties.values()]
    sizes = np.abs(numbers)
    totals = sizes.sum(axis=0)
    shares = (sizes / np.where(totals > 0.0, totals, 1.0)).tolist()
    return {
        body: replace(duty, share=Share(*row))
        for (body, duty), row in zip(duties.items(), shares, strict=True)
    }


# Bottom dead centre -------------------------------------------------------------------------------


def bottom_errors(scene: Scene, stage: StageResult) -> list[tuple[Array, Array]]:
    """Return the strokes of each replicate, by number, and bottom dead centre over the ideal, m.

    Each array has the shape (strokes,); empty if nothing moves.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None:
        return []
    error, start = stage.each_cycle("bottom_height") - ideal.height, stage.arrays["cycle_start"]
    rows = [error[start == replicate][ideal.first :] for replicate in np.unique(start)]
    return [(ideal.first + 1.0 + np.arange(item.size), item) for item in rows]


def rise(stage: StageResult, since: StageResult) -> Estimate | None:
    """Return how much higher bottom dead centre is in a stage than in another, m.

    The other stage is the unworn one, which gives the drift by wear, or that of a run at another
    speed. Both are taken as independent. None if either has no settled stroke.
    """
    later, earlier = stage.statistics.bdc, since.statistics.bdc
    if later is None or earlier is None:
        return None
    halves = later.error.half_width, earlier.error.half_width
    half = None if None in halves else math.hypot(*filter(None, halves))
    return Estimate.symmetric(later.error.mean - earlier.error.mean, half)


# Deep contacts ------------------------------------------------------------------------------------


def deepest_penetrations(stage: StageResult) -> dict[str, float]:
    """Return the deepest recorded penetration of each pin, m."""
    return {
        name: float(np.max(joint.arrays.get("penetration", 0.0), initial=0.0))
        for name, joint in stage.joints.items()
    }


def deep_contacts(scene: Scene, stages: Sequence[StageResult]) -> list[str]:
    """Return sentences on joints whose penetration is too large for a law of a small contact.

    Each is on the stage in which the pin is deepest. The surfaces overlap by e cos(x) - c at an
    angle x from the line of centres: over an arc of which c / (c + penetration) is the cosine of
    the half.
    """
    sentences = []
    for name in scene.clearance_joints:
        bearing = scene.bearing(name)
        depths = [deepest_penetrations(stage).get(name, 0.0) for stage in stages]
        depth = max(depths, default=0.0)
        ratio = depth / bearing.clearance
        if ratio <= SMALL_CONTACT:
            continue
        arc = math.degrees(2.0 * math.acos(1.0 / (1.0 + ratio)))
        text = (
            f"joint {name}: the penetration of {readable(1e6 * depth)} µm is {readable(ratio)} of "
            f"the clearance, and the contact extends over {arc:.0f} degrees, too wide for a law of "
            "a small contact"
        )
        if not isinstance(bearing.normal_law, UserFunction) and bearing.exponent == 1.5:
            law = (0.0, 1.0, 1.0, 1.5, 0.0, 1.0)
            whole = foundation_force(ratio, *law)
            power, liu = elastic_force(ratio, 1.0, 1.5) / whole, liu_force(ratio, *law) / whole
            text += (
                f"; K delta^1.5 then has {power:.2f} and Liu's law {liu:.2f} of the force of an "
                "elastic foundation"
            )
            is_worn = stages[depths.index(depth)].is_worn
            on_foundation = scene.conventions.contact == "foundation" and is_worn
            if bearing.elasticity == "power" and not on_foundation:
                text += "; use elasticity = liu or foundation"
        sentences.append(text)
    return sentences


# Settled motion -----------------------------------------------------------------------------------


def has_motion(scene: Scene, stage: StageResult) -> bool:
    """Return whether a complete cycle of a motion with clearance was recorded."""
    if stage.failed or not stage.has_joint_series or stage.time.size < 2:
        return False
    start, end = settled_span(scene, stage)
    return end - start > 0.99 * scene.mechanism.period


def settled_span(scene: Scene, stage: StageResult) -> tuple[float, float]:
    """Return start and end of the recorded motion after the start-up, s; complete cycles."""
    period, run_up = scene.mechanism.period, scene.run_up
    whole = int((float(stage.time[-1]) - run_up) / period + 0.02)
    first = max(min(STARTUP_CYCLES, whole - 1), 0)
    end = run_up + max(whole, first + 1) * period
    return run_up + first * period, min(end, float(stage.time[-1]))
