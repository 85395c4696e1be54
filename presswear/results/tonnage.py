"""Tonnage and shock of the strokes of a stage: forces of the work and of the joints."""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from presswear.recording.statistics import Estimate
from presswear.results.joint_result import JointResult
from presswear.results.stage import StageResult
from presswear.results.strokes import (
    PHASES,
    SNAP_THROUGH_S,
    SampledStroke,
    mean_of_strokes,
    means_by_name,
    motion_of_work,
    process_force,
    sampled_strokes,
)
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array


@dataclass(frozen=True)
class JointTonnage:
    """Forces between pin and bearing of a joint, means over the sampled strokes, N.

    The fields after ``peak_by_phase`` are None if the work does not break.
    """

    peak_by_phase: Mapping[str, Estimate]  # greatest force in each phase
    # greatest force in the direction of the impulse from contact to fracture
    working_force: Estimate | None
    # greatest force against this direction, within SNAP_THROUGH_S after the fracture
    reversed_force: Estimate | None
    # reversed force over working force of a stroke
    reversed_fraction: Estimate | None
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
    # rms difference of the acceleration of the output from that of the ideal motion, m/s^2,
    # during SNAP_THROUGH_S before the contact
    vibration_before: Estimate | None
    # and during SNAP_THROUGH_S after the fracture
    vibration_after: Estimate | None


def tonnage_of(scene: Scene, stage: StageResult) -> Tonnage | None:
    """Return tonnage and shock in a stage; None if it failed or no stroke is complete."""
    strokes = [] if stage.failed else sampled_strokes(scene, stage)
    if not strokes:
        return None
    series = stage.joints if stage.has_joint_series else {}
    time = stage.clock
    joints = {
        name: joint_tonnage(time, joint, strokes) for name, joint in series.items()
    }
    force = process_force(scene, stage)
    if force is None:
        return Tonnage(len(strokes), None, None, joints, None, None)
    height, _ = motion_of_work(scene, stage)
    rows = [_rows(time, stroke.start, stroke.end) for stroke in strokes]
    peak = mean_of_strokes(float(force[stroke].max()) for stroke in rows)
    # The force is linear in height between two rows.
    work = mean_of_strokes(
        -float(np.trapezoid(force[stroke], height[stroke])) for stroke in rows
    )
    # Accurate to 1e-8 of the greatest acceleration, far below what contacts add.
    ideal = scene.ideal_slider(stage.time, closed=False)
    deviation = stage.acceleration - ideal[:, 2]
    window = SNAP_THROUGH_S
    broken = [stroke for stroke in strokes if stroke.has_fracture]
    before = mean_of_strokes(
        _rms(time, deviation, stroke.contact - window, stroke.contact)
        for stroke in broken
    )
    after = mean_of_strokes(
        _rms(time, deviation, stroke.fracture, stroke.fracture + window)
        for stroke in broken
    )
    return Tonnage(len(strokes), peak, work, joints, before, after)


def joint_tonnage(
    time: Array, joint: JointResult, strokes: list[SampledStroke]
) -> JointTonnage:
    """Return the forces of a joint in sampled strokes."""
    size = np.hypot(*joint.force.T)
    # In contacts with a small force a series has few rows. Their peaks are stored.
    touchdown, separation, peak = map(
        joint.contact, ("touchdown", "separation", "peak_force")
    )
    peaks: dict[str, list[float]] = {name: [] for name in PHASES}
    for stroke in strokes:
        for name, (start, end) in stroke.phases.items():
            values = size[(time >= start) & (time < end)]
            if values.size:
                of_contacts = peak[(touchdown >= start) & (separation < end)]
                largest = of_contacts.max(initial=float(values.max()))
                peaks[name].append(float(largest))
    # Vectors are complex numbers, x + i y. The force of the pin on its bearing is turned
    # from normal and tangential components to global directions. The tangential force is
    # stored as it acts on the pin, so that it changes its sign.
    vector = np.array([1.0, 1j])
    direction = np.exp(1j * np.angle(joint.eccentricity @ vector))
    force = joint.force @ vector.conj() * direction
    broken = [stroke for stroke in strokes if stroke.has_fracture]
    reversals = [_reversal(time, force, stroke) for stroke in broken]
    working, reverse, delay = np.array(reversals).reshape(-1, 3).T
    loaded = working > 0.0
    fraction = reverse[loaded] / working[loaded]
    return JointTonnage(
        means_by_name(peaks),
        mean_of_strokes(working),
        mean_of_strokes(reverse),
        mean_of_strokes(fraction),
        mean_of_strokes(delay),
    )


def _reversal(
    time: Array, force: Array, stroke: SampledStroke
) -> tuple[float, float, float]:
    """Return the greatest working force and, after the fracture, the greatest reversed one, N.

    The third number is the time from the fracture to the first reversed force, s; nan
    if there is none within ``SNAP_THROUGH_S``. ``force`` holds vectors as complex
    numbers, shape (n,), N.
    """
    before = _rows(time, stroke.contact, stroke.fracture)
    end = min(stroke.fracture + SNAP_THROUGH_S, stroke.end)
    after = _rows(time, stroke.fracture, end)
    impulse = complex(np.trapezoid(force[before], time[before]))
    if impulse == 0.0:
        return 0.0, 0.0, math.nan
    along = (force * impulse.conjugate()).real / abs(impulse)
    against = np.maximum(-along[after], 0.0)
    working = float(along[before].max())
    if not np.any(against > 0.0):
        return working, 0.0, math.nan
    first = int((against > 0.0).argmax())
    delay = float(time[after][first]) - stroke.fracture
    return working, float(against.max()), delay


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
