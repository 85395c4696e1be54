"""Torque and power of the drives, from what a stage recorded."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from presswear.record.sampling import STARTUP_CYCLES
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Duty:
    """A quantity of a drive over the recorded cycles that are samples, or all if none is whole.

    Attributes
    ----------
    mean, rms, peak : float
        Over time; the peak is the value farthest from zero, with its sign.
    """

    mean: float
    rms: float
    peak: float


@dataclass(frozen=True)
class DriveResult:
    """One drive in a stage.

    Attributes
    ----------
    torque, power : ndarray, shape (n,)
        Given to its body at the times of the series, N m and W.
    torque_duty, power_duty : Duty
    """

    torque: Array
    power: Array
    torque_duty: Duty
    power_duty: Duty


def drives_of(scene: Scene, stage: StageResult) -> dict[str, DriveResult]:
    """The drives of a stage by their bodies; none where torques were not stored."""
    if "drive_torque" not in stage.arrays or stage.time.size < 2:
        return {}
    linkage, time = scene.mechanism.linkage(), stage.time
    velocity = scene.ideal.at(time).velocity
    period = scene.mechanism.period
    count = int((float(time[-1]) - scene.run_up) / period + 1e-3)
    rows = slice(None)
    if count > 0:
        first = min(STARTUP_CYCLES, count - 1)
        ends = scene.run_up + period * np.array([first, count])
        begin, end = np.searchsorted(time, ends - 1e-9 * period)
        rows = slice(int(begin), int(end) + 1)
    found = {}
    for k, drive in enumerate(linkage.drives):
        torque = stage.arrays["drive_torque"][:, k]
        power = torque * velocity[:, 3 * linkage.index(drive.body) + 2]
        duties = [_duty(time[rows], values[rows]) for values in (torque, power)]
        found[drive.body] = DriveResult(torque, power, *duties)
    return found


def _duty(time: Array, values: Array) -> Duty:
    """Numbers of a sampled quantity, by the trapezoidal rule."""
    duration = float(time[-1] - time[0])
    return Duty(
        float(np.trapezoid(values, time)) / duration,
        float(np.sqrt(np.trapezoid(values**2, time) / duration)),
        float(values[np.abs(values).argmax()]),
    )
