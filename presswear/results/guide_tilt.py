"""Tilt of a slide in a guide with clearance, in the sampled strokes of a stage."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.guide_corner import CORNERS
from presswear.linkage.joints import Guide
from presswear.recording.columns import cycle_column
from presswear.recording.statistics import Estimate
from presswear.results.corners import tilt_series
from presswear.results.joint_result import JointResult
from presswear.results.sampled_cycles import sampled_cycles
from presswear.results.stage import StageResult
from presswear.results.strokes import (
    SampledStroke,
    mean_of_strokes,
    means_by_name,
    sampled_strokes,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

# Press makers ask for a tilt under load of at most 20 to 50 um/m.
LEAST_ALLOWED_TILT = 20e-6  # rad
ALLOWED_TILT = 50e-6  # rad
STATES = ("free", "one corner", "one face", "two opposite corners", "other")
_FREE, _CORNER, _FACE, _OPPOSITE, _OTHER = range(len(STATES))
_MIN_ROWS = 8  # a contact with fewer rows is too short for the series to show its force
# Instants at which the force of a short contact is computed, fractions of its duration
_PARTS = np.linspace(0.0, 1.0, 17)[1:-1]


@dataclass(frozen=True)
class GuideTilt:
    """Tilt and load of a slide in a guide, means over the sampled strokes.

    Tilts are sizes, rad, of either sign. The load of a state is the integral over time
    of the normal forces of all corners. Without a series of the joints only the corner
    force is available.
    """

    corner_force: Estimate | None  # greatest normal force of all corners in a cycle, N
    touch: Estimate | None = None  # at the touch of the work; None: no work
    fracture: Estimate | None = None  # None: nothing breaks
    bottom: Estimate | None = None  # at bottom dead centre of the ideal motion
    greatest: Estimate | None = None  # in a stroke
    # by STATES that occur
    time_shares: Mapping[str, Estimate] = field(default_factory=dict)
    load_shares: Mapping[str, Estimate] = field(default_factory=dict)
    # in a stroke, J; mean over the sampled cycles
    friction_loss: Estimate | None = None

    @property
    def at_work(self) -> Mapping[str, Estimate]:
        """Tilts that press makers limit, by the description of the instant."""
        tilts = {
            "the fracture": self.fracture,
            "the touch of the work": self.touch,
            "bottom dead centre": self.bottom,
        }
        return {instant: tilt for instant, tilt in tilts.items() if tilt is not None}

    @property
    def working(self) -> Estimate | None:
        """Tilt at the fracture, else at the touch, else at bottom dead centre; rad."""
        return next(iter(self.at_work.values()), None)

    @property
    def is_excessive(self) -> bool:
        """True if a tilt at the work is above what press makers ask for."""
        return any(tilt.mean > ALLOWED_TILT for tilt in self.at_work.values())


def guide_tilts(scene: Scene, stage: StageResult) -> dict[str, GuideTilt]:
    """Return the tilts of slides by guide; empty without a guide with clearance."""
    if not stage.has_sound_cycles:
        return {}
    return {guide.name: _tilt_of(scene, stage, guide) for guide in scene.loose_guides}


def _tilt_of(scene: Scene, stage: StageResult, guide: Guide) -> GuideTilt:
    forces_of_cycles = _of_corners(scene, stage, guide, "force_max")
    force = mean_of_strokes(forces_of_cycles.max(axis=1))
    if not stage.has_joint_series:
        return GuideTilt(force)
    strokes = sampled_strokes(scene, stage)
    time = stage.clock
    size = np.abs(tilt_series(stage, guide))

    def tilt_at(instants: list[float]) -> Estimate | None:
        """Return the mean tilt at instants; missing instants are nan."""
        tilts = np.interp(instants, time, size)
        return mean_of_strokes(tilts[np.isfinite(instants)])

    greatest = []
    for stroke in strokes:
        rows = (time >= stroke.start) & (time <= stroke.end)
        greatest.append(size[rows].max(initial=0.0))
    joints = [stage.joints[f"{guide.name} {corner}"] for corner in CORNERS]
    friction = scene.bearing(guide.name).friction
    loads = [_load_of(time, joint, friction) for joint in joints]
    distances = _of_corners(scene, stage, guide, "load_distance")
    loss = _friction_loss(joints, distances, time)
    if loss is None:
        loss = mean_of_strokes(_loss_in(stroke, loads) for stroke in strokes)
    time_shares, load_shares = _shares(loads, strokes)
    return GuideTilt(
        corner_force=force,
        touch=tilt_at([stroke.contact for stroke in strokes]),
        fracture=tilt_at([stroke.fracture for stroke in strokes]),
        bottom=tilt_at([stroke.bottom for stroke in strokes]),
        greatest=mean_of_strokes(greatest),
        time_shares=time_shares,
        load_shares=load_shares,
        friction_loss=loss,
    )


def _of_corners(scene: Scene, stage: StageResult, guide: Guide, name: str) -> Array:
    """Return a number of each corner in the sampled cycles, shape (cycles, corners)."""
    columns = []
    for corner in CORNERS:
        number = stage.joint_names.index(f"{guide.name} {corner}")
        columns.append(cycle_column(name, number))
    return sampled_cycles(scene, stage)[:, columns]


def _friction_loss(
    joints: list[JointResult], distances: Array, time: Array
) -> Estimate | None:
    """Return the energy that friction takes in a cycle, J, mean over cycles.

    It is the load distance of each corner, shape (cycles, corners), times its mean
    coefficient of friction. None without wear, because then it is not integrated.
    """
    if not distances.any():
        return None
    coefficients = []
    for joint in joints:
        normal, tangential = joint.force.T
        loss = np.trapezoid(-tangential * joint.sliding, time)
        distance = np.trapezoid(normal * np.abs(joint.sliding), time)
        coefficients.append(float(loss / distance) if distance > 0.0 else 0.0)
    return mean_of_strokes(distances @ coefficients)


class _Load(NamedTuple):
    """Normal force of a corner over time, linear between the times, and its friction power."""

    spans: Array  # touchdown and separation of each contact, s, shape (k, 2)
    time: Array  # s, shape (n,)
    force: Array  # N
    power: Array  # W

    def at(self, times: Array) -> Array:
        """Return the force at some times, N."""
        return np.asarray(np.interp(times, self.time, self.force))

    def loss(self, start: float, end: float) -> float:
        """Return the energy that friction takes between two times, J."""
        inside = self.time[(self.time > start) & (self.time < end)]
        times = np.array([start, *inside, end])
        return float(np.trapezoid(np.interp(times, self.time, self.power), times))


def _load_of(time: Array, joint: JointResult, friction: float) -> _Load:
    """Return the load of a corner from the series and the list of its contacts.

    The force is zero outside of the contacts. A contact with few rows, a light impact,
    is half a wave of a sine up to its peak force, with Coulomb's friction.
    """
    spans = joint.spans(time, float(time[-1]))
    first, last = np.searchsorted(time, spans.T, side="right")
    is_short = last - first < _MIN_ROWS
    rows = _rows_between(first[~is_short], last[~is_short], time.size)
    peaks = joint.contact("peak_force")
    # A contact that continues at the end of the series has no recorded peak force.
    short = np.flatnonzero(is_short[: peaks.size])
    begin, end = spans[short].T
    inner = begin[:, np.newaxis] + np.outer(end - begin, _PARTS)
    waves = np.outer(peaks[short], np.sin(np.pi * _PARTS)).ravel()
    speeds = np.abs(np.interp(inner.ravel(), time, joint.sliding))
    ends = spans.ravel()
    zero = np.zeros(ends.size)
    power = -joint.force[rows, 1] * joint.sliding[rows]
    times = np.concatenate([ends, inner.ravel(), time[rows]])
    order = np.argsort(times, kind="stable")
    forces = np.concatenate([zero, waves, joint.force[rows, 0]])
    powers = np.concatenate([zero, friction * waves * speeds, power])
    return _Load(spans, times[order], forces[order], powers[order])


def _rows_between(
    first: NDArray[np.int64], last: NDArray[np.int64], size: int
) -> NDArray[np.bool_]:
    """Return whether each of ``size`` rows lies in a range ``first[k]:last[k]``."""
    changes = np.zeros(size + 1)  # of the number of ranges that contain a row
    np.add.at(changes, first, 1.0)
    np.add.at(changes, last, -1.0)
    return np.cumsum(changes[:-1]) > 0.0


def _loss_in(stroke: SampledStroke, loads: list[_Load]) -> float:
    """Return the energy that friction takes at all corners in a stroke, J."""
    return sum(load.loss(stroke.start, stroke.end) for load in loads)


def _shares(
    loads: list[_Load], strokes: list[SampledStroke]
) -> tuple[dict[str, Estimate], dict[str, Estimate]]:
    """Return the shares of time and of load of each state that occurs."""
    knots = np.unique(np.concatenate([load.time for load in loads]))
    time_shares: list[Array] = []
    load_shares: list[Array] = []
    for stroke in strokes:
        inside = knots[(knots > stroke.start) & (knots < stroke.end)]
        edges = np.array([stroke.start, *inside, stroke.end])
        middle = 0.5 * (edges[1:] + edges[:-1])
        step = np.diff(edges)
        state = _states([_is_within(load.spans, middle) for load in loads])
        force = np.sum([load.at(middle) for load in loads], axis=0)
        time_shares.append(_share_of_states(state, step))
        load_shares.append(_share_of_states(state, step * force))
    return _means(time_shares), _means(load_shares)


def _share_of_states(state: NDArray[np.int64], weight: Array) -> Array:
    """Return the part of a weight in each state; zeros if the weight is zero."""
    sums = np.bincount(state, weight, len(STATES)).astype(np.float64)
    return sums / sums.sum() if sums.sum() > 0.0 else sums


def _means(rows: list[Array]) -> dict[str, Estimate]:
    """Return the means over strokes, a row each, of the states that occur."""
    columns = np.array(rows).reshape(-1, len(STATES)).T
    by_state = dict(zip(STATES, columns, strict=True))
    means = means_by_name({name: c for name, c in by_state.items() if c.any()})
    for name, mean in means.items():
        if mean.high is not None:  # a share is at most 1
            means[name] = replace(mean, high=min(mean.high, 1.0))
    return means


def _is_within(spans: Array, times: Array) -> NDArray[np.bool_]:
    """Return whether each time lies in one of some spans, which are in order."""
    if not len(spans):
        return np.zeros(times.size, dtype=np.bool_)
    place = np.searchsorted(spans[:, 0], times, side="right") - 1
    return np.asarray((place >= 0) & (times < spans[place, 1]))


def _states(closed: list[NDArray[np.bool_]]) -> NDArray[np.int64]:
    """Return the numbers of the states of a slide from its closed corners."""
    left_front, left_back, right_front, right_back = closed
    count = np.sum(closed, axis=0)
    is_face = (left_front & left_back) | (right_front & right_back)
    is_opposite = (left_front & right_back) | (left_back & right_front)
    state = np.full(count.size, _OTHER)
    state[count == 0] = _FREE
    state[count == 1] = _CORNER
    state[(count == 2) & is_face] = _FACE
    state[(count == 2) & is_opposite] = _OPPOSITE
    return state


def self_locking(scene: Scene) -> dict[str, tuple[float, float]]:
    """Return the guides that off-centre work jams, with their friction and its limit.

    Two opposite corners bear the force F of the work at a distance a, with F a / L each.
    Their friction exceeds F if its coefficient is above the limit L / (2 a).
    """
    offset = 0.0 if scene.process is None else abs(scene.process.offset)
    body = scene.base_linkage.output.body
    limits = {}
    for guide in scene.loose_guides:
        friction = scene.bearing(guide.name).friction
        length, _ = guide.size
        if guide.body == body and 2.0 * offset * friction > length:
            limits[guide.name] = friction, length / (2.0 * offset)
    return limits
