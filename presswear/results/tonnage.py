"""Tonnage and shock: what the strokes of a press ask of its work, its joints and its slider."""

# ruff: noqa: N815 - units end the names

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.physics.bottom import bottom_of
from presswear.recording.statistics import STARTUP_CYCLES, Estimate, batched, half_width
from presswear.results.stage import JointResult, StageResult
from presswear.results.strokes import Strokes, height_of, process_force, strokes_of
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

PHASES = ("approach", "work", "snap-through", "return")
"""Of a stroke: down to the work, into it, behind the fracture, and the rest up to its end."""
APPROACH, WORK, SNAP_THROUGH, RETURN = range(len(PHASES))
SNAP_THROUGH_S = 20e-3
"""Time after a fracture within which press builders look for reversed loads."""


@dataclass(frozen=True)
class JointTonnage:
    """Forces between pin and bearing of a joint over the settled strokes.

    Attributes
    ----------
    peak_N : mapping of str to Estimate
        Greatest force of a stroke in each phase that there is, mean over the recorded strokes.
    largest_N : mapping of str to float
        The greatest of all of them.
    stroke_peak_N : Estimate or None
        Greatest normal force of a cycle over all starts.
    working_N : Estimate or None
        Greatest force along the working direction, that of the impulse between contact and
        fracture; None, as what follows, where nothing breaks.
    reversed_N : Estimate or None
        Greatest force against that direction within ``SNAP_THROUGH_S`` of the fracture.
    reversed_part : Estimate or None
        Of ``working_N``, stroke by stroke.
    reversal_s : Estimate or None
        Time from the fracture until the force first points the other way, over the strokes in
        which it does.
    """

    peak_N: Mapping[str, Estimate]
    largest_N: Mapping[str, float]
    stroke_peak_N: Estimate | None
    working_N: Estimate | None = None
    reversed_N: Estimate | None = None
    reversed_part: Estimate | None = None
    reversal_s: Estimate | None = None


@dataclass(frozen=True)
class Vibration:
    """Acceleration of what is watched, less the ideal one, rms over a window in each stroke.

    Attributes
    ----------
    after_m_s2 : Estimate
        Over ``SNAP_THROUGH_S`` from the fracture.
    before_m_s2 : Estimate
        Over as long before the contact.
    ideal_m_s2 : Estimate
        The ideal acceleration itself, over the window after the fracture.
    """

    after_m_s2: Estimate
    before_m_s2: Estimate
    ideal_m_s2: Estimate


@dataclass(frozen=True)
class Tonnage:
    """What settled strokes of a stage's first start ask for.

    Estimates are means over strokes with the half width of their 95 % interval, which is None
    where there is one stroke; they tell how many there were.

    The frame of this model is rigid and the work pushes one way.  So there is no tension at the
    punch, and no strain energy of frame, tools or drives is set free at fracture, which on a press
    gives most of its reverse tonnage.  What is told as reversed is what inertia, drives at their
    set motion and elastic contacts do in each joint when the work gives way: the load changes
    sides in its clearance, and presses on the far side.  It is no bound of a press's reverse
    tonnage.

    Attributes
    ----------
    strokes : int
        Recorded settled strokes, from upper dead centre to the next.
    force_peak_N : Estimate or None
        Greatest force of the work in a stroke; None where the scene has no process.
    work_J : Estimate or None
        Work that it takes in a stroke.
    joints : mapping of str to JointTonnage
    vibration : Vibration or None
        None where nothing breaks.
    most_loaded : str or None
        Joint with the greatest mean peak of a cycle over all starts; None without clearance.
    """

    strokes: int
    force_peak_N: Estimate | None
    work_J: Estimate | None
    joints: Mapping[str, JointTonnage]
    vibration: Vibration | None
    most_loaded: str | None


@dataclass(frozen=True)
class Stroke:
    """A settled stroke, by moments, s, that are not a number where there is none.

    Attributes
    ----------
    begin, bottom, end : float
        Upper, bottom and next upper dead centre of the ideal motion.
    contact, fracture : float
    done : float
        When the force of the work has gone.
    """

    begin: float
    bottom: float
    end: float
    contact: float
    fracture: float
    done: float


def settled_strokes(scene: Scene, stage: StageResult) -> list[Stroke]:
    """The recorded strokes behind the start-up, or the last whole one if none is.

    None where no stroke is whole.
    """
    ideal = bottom_of(scene.ideal)
    if ideal is None or stage.time.size < 2:
        return []
    period, last = ideal.period, float(stage.time[-1])
    number = np.arange(int((last - scene.run_up) / period) + 2)
    begins = scene.run_up + ideal.top + period * number
    noise = 1e-9 * period
    is_whole = (begins >= scene.run_up - noise) & (begins + period <= last + noise)
    settled = is_whole & (number >= STARTUP_CYCLES)
    begins = begins[settled] if settled.any() else begins[is_whole][-1:]
    down = ideal.time - ideal.top
    strokes, force = strokes_of(scene, stage), process_force(scene, stage)
    return [_stroke(own, down, period, stage.time, strokes, force) for own in map(float, begins)]


def _stroke(
    begin: float,
    down: float,
    period: float,
    time: Array,
    strokes: Strokes | None,
    force: Array | None,
) -> Stroke:
    end, bottom = begin + period, begin + down
    contact = fracture = done = math.nan
    if strokes is not None and force is not None:
        here = (strokes.contact[:, 0] >= begin) & (strokes.contact[:, 0] < end)
        if here.any():
            place = int(here.argmax())
            contact, fracture = (
                float(own[place, 0]) for own in (strokes.contact, strokes.fracture)
            )
            pressed = time[(time > contact) & (time < end) & (force > 0.0)]
            done = float(pressed[-1]) if pressed.size else contact
    return Stroke(begin, bottom, end, contact, fracture, done)


def phases_of(time: Array, strokes: list[Stroke]) -> NDArray[np.int64]:
    """Phase of each instant, an index of ``PHASES``, shape (n,); -1 outside the strokes.

    Without work a stroke is approach down to bottom dead centre and return from there.  Work
    lasts from the contact to the fracture, or where nothing breaks until its force has gone, and
    what follows, after ``SNAP_THROUGH_S`` of snap-through, is return.
    """
    found = np.full(time.size, -1)
    for own in strokes:
        spans = [(own.begin, own.bottom, APPROACH), (own.bottom, own.end, RETURN)]
        if not math.isnan(own.contact):
            ended = own.done if math.isnan(own.fracture) else own.fracture
            spans = [
                (own.begin, own.contact, APPROACH),
                (own.contact, ended, WORK),
                (ended, own.end, RETURN),
            ]
            if not math.isnan(own.fracture):
                spans.append((ended, min(ended + SNAP_THROUGH_S, own.end), SNAP_THROUGH))
        for begin, end, phase in spans:
            found[(time >= begin) & (time < end)] = phase
    return found


def tonnage_of(scene: Scene, stage: StageResult) -> Tonnage | None:
    """Tonnage and shock in a stage; None where it failed or no stroke is whole."""
    strokes = [] if stage.failed else settled_strokes(scene, stage)
    if not strokes:
        return None
    phase = phases_of(stage.time, strokes)
    told = stage.joints if stage.has_joint_series else {}
    joints = {name: joint_tonnage(stage.time, own, strokes, phase) for name, own in told.items()}
    known = {
        name: own.stroke_peak_N.mean
        for name, own in joints.items()
        if own.stroke_peak_N is not None
    }
    force, work = process_force(scene, stage), None
    peak = None
    if force is not None:
        height = height_of(scene, stage)
        rows = [_rows(stage.time, own.begin, own.end) for own in strokes]
        peak = _mean([float(force[own].max()) for own in rows])
        # Force is linear in height between two rows.
        work = _mean([-float(np.trapezoid(force[own], height[own])) for own in rows])
    return Tonnage(
        len(strokes),
        peak,
        work,
        joints,
        _vibration(scene, stage, strokes),
        max(known, key=lambda name: known[name], default=None),
    )


def joint_tonnage(
    time: Array, joint: JointResult, strokes: list[Stroke], phase: NDArray[np.int64]
) -> JointTonnage:
    """Forces of one joint in settled strokes.

    Parameters
    ----------
    phase : ndarray, shape (n,)
        Of ``phases_of``.
    """
    size = np.hypot(*joint.force.T)
    peaks: dict[str, list[float]] = {}
    for own in strokes:
        inside = (time >= own.begin) & (time < own.end)
        for place, name in enumerate(PHASES):
            here = size[inside & (phase == place)]
            if here.size:
                peaks.setdefault(name, []).append(float(here.max()))
    reversals = [
        reversal(time, pressed(joint), own) for own in strokes if not math.isnan(own.fracture)
    ]
    forces = np.array(reversals).reshape(-1, 3)
    working, back, delay = forces.T
    loaded = working > 0.0
    return JointTonnage(
        {name: _some(own) for name, own in peaks.items()},
        {name: max(own) for name, own in peaks.items()},
        joint.stored and joint.stored.peak_force_per_cycle,
        _mean(working),
        _mean(back),
        _mean(back[loaded] / working[loaded]),
        _mean(delay),
    )


def pressed(joint: JointResult) -> Array:
    """Force of the pin on its bearing, shape (n, 2), N; its normal along the line of centres."""
    reach = np.hypot(*joint.eccentricity.T)
    normal = joint.eccentricity / np.where(reach > 0.0, reach, 1.0)[:, np.newaxis]
    across = np.column_stack([-normal[:, 1], normal[:, 0]])
    return np.asarray(joint.force[:, :1] * normal + joint.force[:, 1:] * across)


def reversal(time: Array, force: Array, stroke: Stroke) -> tuple[float, float, float]:
    """Greatest force along the working direction and, behind the fracture, against it, N.

    The third number is the time from the fracture to the first force against it, s; not a number
    where there is none within ``SNAP_THROUGH_S``.

    Parameters
    ----------
    force : ndarray, shape (n, 2)
        N.
    """
    into = _rows(time, stroke.contact, stroke.fracture)
    behind = _rows(time, stroke.fracture, min(stroke.fracture + SNAP_THROUGH_S, stroke.end))
    impulse = [float(np.trapezoid(own, time[into])) for own in force[into].T]
    size = math.hypot(*impulse)
    if size == 0.0:
        return 0.0, 0.0, math.nan
    along = force @ np.array(impulse) / size
    against = -along[behind]
    delay = math.nan
    if (against > 0.0).any():
        delay = float(time[behind][int((against > 0.0).argmax())]) - stroke.fracture
    return float(along[into].max()), max(float(against.max(initial=0.0)), 0.0), delay


def _vibration(scene: Scene, stage: StageResult, strokes: list[Stroke]) -> Vibration | None:
    rows: list[tuple[float, float, float]] = []
    time = stage.time
    for own in strokes:
        if math.isnan(own.fracture):
            continue
        behind = _rows(time, own.fracture, own.fracture + SNAP_THROUGH_S)
        ahead = _rows(time, own.contact - SNAP_THROUGH_S, own.contact)
        if time[behind].size < 2 or time[ahead].size < 2:
            continue
        ideal = scene.ideal_slider(time[behind])[:, 2]
        calm = scene.ideal_slider(time[ahead])[:, 2]
        rows.append(
            (
                rms(time[behind], stage.acceleration[behind] - ideal),
                rms(time[ahead], stage.acceleration[ahead] - calm),
                rms(time[behind], ideal),
            )
        )
    if not rows:
        return None
    found = [_some([own[k] for own in rows]) for k in range(3)]
    return Vibration(*found)


def rms(time: Array, values: Array) -> float:
    """Root mean square over time of a sampled quantity, by the trapezoidal rule."""
    return math.sqrt(float(np.trapezoid(values**2, time)) / float(time[-1] - time[0]))


def _rows(time: Array, begin: float, end: float) -> slice:
    """The rows from one moment to another, both among them where rows stand there."""
    noise = 1e-12 * max(abs(end), 1.0)
    ends = np.searchsorted(time, (begin - noise, end + noise))
    return slice(int(ends[0]), int(ends[1]))


def _some(values: list[float]) -> Estimate:
    """Mean over one stroke or more."""
    samples = np.array(values)
    return Estimate.symmetric(float(samples.mean()), half_width(batched(samples)), samples.size)


def _mean(values: Array | list[float]) -> Estimate | None:
    """Mean over the strokes in which there is such a number; None where there is none."""
    known = [float(own) for own in values if not math.isnan(own)]
    return _some(known) if known else None
