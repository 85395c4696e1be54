"""Loads of motors in the sampled cycles of a stage: speed, torque and energy."""

import math
from dataclasses import dataclass

import numpy as np

from presswear.linkage.drives import Drive
from presswear.recording.columns import (
    GIVEN,
    RETURNED,
    TORQUE,
    TORQUE_PEAK,
    TORQUE_SQUARE,
)
from presswear.recording.statistics import Estimate
from presswear.results.result import Result
from presswear.results.sampled_cycles import drive_numbers, durations
from presswear.results.stage import StageResult
from presswear.results.strokes import SampledStroke, mean_of_strokes, working_strokes
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

ALLOWED_DROP = 0.2  # drop by the work that press makers allow, relative to the speed
# Speed at which a motor has recovered from the work, relative to the speed at the touch
RECOVERED = 0.99


@dataclass(frozen=True)
class MotorLoad:
    """Load of a motor with a rated torque, means over the sampled cycles and strokes.

    The slip loss is the integral of T (omega_0 - omega), which heats the rotor. T is the
    torque on the driven body, omega its speed and omega_0 its speed without load.
    """

    work: Estimate  # net work on the driven body in a cycle, J
    slip_loss: Estimate  # loss in a cycle, J
    rms_fraction: Estimate  # rms torque over the rated torque
    # peak over breakdown torque; None: no breakdown torque
    peak_fraction: Estimate | None


@dataclass(frozen=True)
class LeaderSpeed:
    """Speed of the first motor, means over the sampled cycles and strokes."""

    stroke_rate: Estimate  # cycles in a second, 1/s
    # speed at the touch of the work, part of the nominal speed; None: no work
    touch: Estimate | None
    # greatest drop from the touch until the force of the work has vanished, part of the
    # speed at the touch; None: no work
    drop: Estimate | None
    # angle of the leader from the touch until the speed is RECOVERED again, rad; None: it
    # does not fall below, or does not recover in the recorded strokes
    recovery: Estimate | None


def leader_speed(scene: Scene, stage: StageResult) -> LeaderSpeed | None:
    """Return the speed of the first motor; None without a motor or a complete cycle."""
    if not (stage.has_clock and stage.has_sound_cycles):
        return None
    leader = scene.linkage().leader
    assert leader is not None, "only a leader has a clock"
    rate = mean_of_strokes(1.0 / durations(scene, stage))
    assert rate is not None
    rows = [_drop_of(stage, stroke) for stroke in working_strokes(scene, stage)]
    touches, drops, recoveries = np.array(rows).reshape(-1, 3).T
    recovery = mean_of_strokes(abs(leader.speed) * recoveries)
    return LeaderSpeed(rate, mean_of_strokes(touches), mean_of_strokes(drops), recovery)


def _drop_of(stage: StageResult, stroke: SampledStroke) -> tuple[float, float, float]:
    """Return the speed at the touch, its drop, and the nominal time until it recovers, s.

    The speed is relative to the nominal speed, the drop to the speed at the touch. The drop
    ends at the smallest speed in the rows of the series, which include the instants at
    which the force of the work begins, breaks and vanishes. The time is NaN if the speed
    stays above RECOVERED, or does not recover.
    """
    clock = stage.clock
    speed = stage.nominal_rate
    before = float(np.interp(stroke.contact, clock, speed))
    first, last = np.searchsorted(clock, [stroke.contact, stroke.done])
    during = speed[first : last + 2]  # includes the first row after the force vanished
    drop = max(1.0 - float(during.min(initial=before)) / before, 0.0)
    has_recovered = (clock >= stroke.done) & (speed >= RECOVERED * before)
    if drop <= 1.0 - RECOVERED or not has_recovered.any():
        return before, drop, math.nan
    touch = float(stage.nominal_of(np.array(stroke.contact)))
    return before, drop, float(stage.time[has_recovered][0]) - touch


def period_in(scene: Scene, stage: StageResult) -> float:
    """Return the mean duration of the sampled cycles of a stage, s.

    Without a motor, or without a complete cycle, it is the nominal duration.
    """
    speed = leader_speed(scene, stage)
    if speed is None:
        return float(scene.mechanism.period)
    return 1.0 / speed.stroke_rate.mean


def mean_period(result: Result) -> float:
    """Return the mean duration of a cycle in the last stage that did not fail, s."""
    sound = [stage for stage in result.stages if not stage.failed]
    if not sound:
        return float(result.scene.mechanism.period)
    return period_in(result.scene, sound[-1])


def motor_loads(scene: Scene, stage: StageResult) -> dict[str, MotorLoad]:
    """Return the loads of motors with a rated torque by body; empty without one."""
    if not (stage.has_clock and stage.has_sound_cycles):
        return {}
    drives = scene.linkage().drives
    duration = durations(scene, stage)
    numbers = drive_numbers(scene, stage)
    return {
        drive.body: _load_of(drive, numbers[:, k], duration)
        for k, drive in enumerate(drives)
        if drive.motor is not None and drive.motor.has_slip
    }


def saturated_servos(scene: Scene, stage: StageResult) -> dict[str, float]:
    """Return the torque limits of the servos that reach them, N m, by body."""
    drives = scene.linkage().drives
    if not (drives and stage.has_sound_cycles):
        return {}
    numbers = drive_numbers(scene, stage)
    return {
        drive.body: drive.torque_limit
        for k, drive in enumerate(drives)
        if drive.motor is not None
        and drive.torque_limit is not None
        and np.abs(numbers[:, k, TORQUE_PEAK]).max() >= drive.torque_limit
    }


def _load_of(drive: Drive, numbers: Array, duration: Array) -> MotorLoad:
    """Return the load of a motor from its numbers, (cycles, columns), and durations, s."""
    motor = drive.motor
    assert motor is not None
    assert motor.torque is not None
    rated = motor.ratio * motor.torque
    work = numbers[:, GIVEN] - numbers[:, RETURNED]
    loss = drive.no_load_speed * numbers[:, TORQUE] - work
    mean_work = mean_of_strokes(work)
    mean_loss = mean_of_strokes(loss)
    rms = mean_of_strokes(np.sqrt(numbers[:, TORQUE_SQUARE] / duration) / rated)
    assert mean_work is not None
    assert mean_loss is not None
    assert rms is not None
    peak = None
    if motor.breakdown is not None:
        greatest = np.abs(numbers[:, TORQUE_PEAK])
        peak = mean_of_strokes(greatest / (rated * motor.breakdown))
    return MotorLoad(mean_work, mean_loss, rms, peak)
