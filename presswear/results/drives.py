"""Drives of a stage: torque and power of the run, beside those of rigid joints."""

from typing import NamedTuple

import numpy as np

from presswear.recording.columns import DRIVE_CYCLE, names_of
from presswear.recording.statistics import Estimate
from presswear.results.drive_duty import (
    DriveCurve,
    DriveDuty,
    drive_curves,
    duties_of,
    farthest_from_zero,
)
from presswear.results.rigid_joints import ideal_drives, rubbing_drives
from presswear.results.sampled_cycles import drive_numbers, durations
from presswear.results.stage import StageResult
from presswear.results.strokes import mean_of_strokes
from presswear.scene.scene import Scene


class DriveResult(NamedTuple):
    """Duty and peaks of a drive in a stage, beside its duty with rigid joints."""

    duty: DriveDuty  # duty in the run, integrated over all steps
    ideal: DriveDuty  # duty with rigid joints without friction
    # duty with rigid joints with the friction of their bearings, if any
    rubbing: DriveDuty | None
    # largest in magnitude of a cycle, mean over cycles, N m
    peak_torque: Estimate | None
    peak_power: Estimate | None  # W


def drives_of(scene: Scene, stage: StageResult) -> dict[str, DriveResult]:
    """Return the drives of a stage by their bodies; empty if torques were not stored.

    Raises UntrustedLaw if the ideal torques need source code that is stored in a result.
    """
    if "drive_torque" not in stage.arrays or not stage.arrays["cycles"].size:
        return {}
    ideal = ideal_drives(scene)
    rubbing = rubbing_drives(scene)
    settling = stage.statistics.settling
    is_uneven = stage.statistics.high_bumps or (settling and settling.is_mixture)
    by_cycle = drive_numbers(scene, stage)
    numbers: dict[str, dict[str, float]] = {}
    peaks = {}
    for k, body in enumerate(ideal):
        columns = dict(zip(names_of(DRIVE_CYCLE), by_cycle[:, k].T, strict=True))
        torque = mean_of_strokes(np.abs(columns["torque_peak"]))
        power = mean_of_strokes(np.abs(columns["power_peak"]))
        if is_uneven:
            torque = torque and torque.without_interval
            power = power and power.without_interval
        peaks[body] = torque, power
        numbers[body] = {}
        for name, values in columns.items():
            number_of = farthest_from_zero if name.endswith("peak") else np.mean
            numbers[body][name] = float(number_of(values))
    period = scene.mechanism.period
    if stage.has_clock:
        period = float(durations(scene, stage).mean())
    duties = duties_of(numbers, period)
    return {
        body: DriveResult(duties[body], ideal[body], rubbing.get(body), *peaks[body])
        for body in ideal
    }


def curves_of(scene: Scene, stage: StageResult) -> dict[str, DriveCurve]:
    """Return the curves of the drives of a stage by their bodies.

    Torque and power are empty if torques were not stored.
    """
    torque = stage.arrays.get("drive_torque")
    linkage = scene.mechanism.linkage()
    if not stage.has_clock:
        return drive_curves(linkage, scene.ideal.at(stage.time), torque)
    curves = {}
    for k, drive in enumerate(linkage.drives):
        angle = stage.arrays["drive_angle"][:, k]
        speed = stage.arrays["drive_speed"][:, k]
        stored = np.zeros(0) if torque is None else torque[:, k]
        power = stored * speed[: stored.size]
        curves[drive.body] = DriveCurve(stage.time, angle, stored, power, speed)
    return curves
