"""Strokes of a press on its work: height, force of the work, instants and phases.

They are computed from the stored series of a stage and from the ideal motion of its
scene.
"""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from presswear.physics.dead_centre import bottom_of
from presswear.physics.event_time import crossing, hermite
from presswear.physics.packed_loads import sizes_over
from presswear.recording import statistics
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.corners import tilt_series
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# Phases of a stroke on the work
PHASES = ("approach", "work", "snap-through", "return")
APPROACH, WORK, SNAP_THROUGH, RETURN = PHASES
# s after a fracture, in which press builders look for reversed loads
SNAP_THROUGH_S = 20e-3


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
    def has_work(self) -> bool:
        """True if the output touches the work."""
        return not math.isnan(self.contact)

    @property
    def has_fracture(self) -> bool:
        """True if the work breaks."""
        return not math.isnan(self.fracture)

    @property
    def phases(self) -> dict[str, tuple[float, float]]:
        """Start and end of each phase, s.

        Without work a stroke is approach down to bottom dead centre and return from
        there. Work lasts from contact to fracture, or until its force has vanished, and
        after ``SNAP_THROUGH_S`` of snap-through follows the return.
        """
        if not self.has_work:
            return {
                APPROACH: (self.start, self.bottom),
                RETURN: (self.bottom, self.end),
            }
        worked = self.done
        after = self.done
        if self.has_fracture:
            worked = self.fracture
            after = min(self.fracture + SNAP_THROUGH_S, self.end)
        times = (self.start, self.contact, worked, after, self.end)
        return dict(zip(PHASES, pairwise(times), strict=True))


def height_of(scene: Scene, stage: StageResult) -> Array:
    """Return the height of the output over the ideal bottom dead centre, shape (n,), m."""
    start = scene.ideal.at(np.zeros(1)).output(scene.base_linkage)[0, 0]
    return np.asarray(stage.displacement + start - scene.bottom)


def motion_of_work(scene: Scene, stage: StageResult) -> tuple[Array, Array]:
    """Return height, m, and velocity, m/s, of the point that the work presses on, (n,).

    If a slide tilts, a point beside its middle is higher than the output by the offset
    of the work times the sine of the tilt. Without a series of the joints the tilt is
    unknown and left out.
    """
    height = height_of(scene, stage)
    velocity = stage.velocity
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
    height, velocity = motion_of_work(scene, stage)
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
    height, velocity = motion_of_work(scene, stage)
    missing = np.full((1, 2), math.nan)
    rows = []
    top = process.height
    broken = math.nan if process.fracture is None else top - process.fracture
    contacts = _passes(stage, height, velocity, top, -1.0)
    fractures = _passes(stage, height, velocity, broken, -1.0)
    leavings = _passes(stage, height, velocity, top, 1.0)
    turns = _passes(stage, height, velocity, top + scene.lift, 1.0)

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
    """Return the nominal times, s, and heights, m, of the passes through a level, shape (n, 2).

    The height rises with ``sign`` = 1 and falls with -1.
    """
    off = sign * (height - level)
    rate = sign * velocity
    time = stage.clock
    instants = []
    for k in np.flatnonzero((off[:-1] < 0.0) & (off[1:] >= 0.0)):
        step = time[k + 1] - time[k]
        ends = off[k], rate[k], off[k + 1], rate[k + 1], step
        fraction = min(crossing(*ends), 1.0)
        height_of_pass = level + sign * hermite(*ends, fraction)[0]
        instants.append((time[k] + fraction * step, height_of_pass))
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


def working_strokes(scene: Scene, stage: StageResult) -> list[SampledStroke]:
    """Return the sampled strokes in which the output touches the work."""
    return [stroke for stroke in sampled_strokes(scene, stage) if stroke.has_work]


def means_by_name(values: Mapping[str, Iterable[float]]) -> dict[str, Estimate]:
    """Return the means over the strokes by name, without those that have no value."""
    means = {name: mean_of_strokes(samples) for name, samples in values.items()}
    return {name: mean for name, mean in means.items() if mean is not None}


def mean_of_strokes(values: Iterable[float]) -> Estimate | None:
    """Return the mean over the strokes, values of at least 0; None if all values are nan."""
    samples = np.array([float(value) for value in values if not math.isnan(value)])
    if not samples.size:
        return None
    half = statistics.half_width_of_runs([samples])
    return Estimate.symmetric(float(samples.mean()), half, samples.size).positive
