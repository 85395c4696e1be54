"""Torque, power and energy of the drives in a stage, beside those of ideal joints."""

# ruff: noqa: N815 - units end the names

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from presswear.physics.inverse import needed_torques
from presswear.recording.observe import CYCLE_DRIVE
from presswear.recording.statistics import Estimate, after_startup
from presswear.results.stage import StageResult
from presswear.results.tonnage import tonnage_of
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

ENERGY_BOUND = 1e-6
"""Energy that may not add up at the tolerances of a trajectory, part of what drives exchanged."""
_NEWTON = 3
"""Steps of Newton's method to a bend of the force of the work."""
_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(3)
_PIECES, _BEFORE = 720, 90
"""Pieces of a cycle over which ideal torques are summed, by Gauss with three places in each, and
those of the cycle before it, through which laws of loads are followed.
"""


@dataclass(frozen=True)
class Duty:
    """A quantity of a drive over the settled cycles of all starts.

    Attributes
    ----------
    mean, rms, peak : float
        Over time; the peak is the value farthest from zero, with its sign.
    """

    mean: float
    rms: float
    peak: float


@dataclass(frozen=True)
class Share:
    """Parts of one drive in the sums over all drives; 0 where the sum is 0.

    Attributes
    ----------
    rms_torque, peak_power, energy : float
        Of the rms torques, the peaks of power without their signs, and the energies given.
    """

    rms_torque: float
    peak_power: float
    energy: float


@dataclass(frozen=True)
class DriveDuty:
    """What is asked of one drive.

    Attributes
    ----------
    torque : Duty
        N m.
    power : Duty
        W.
    given_J, returned_J : float
        Energy that the drive gives in a cycle, and that the linkage gives back to it.
    share : Share
        Its part beside the other drives.
    """

    torque: Duty
    power: Duty
    given_J: float
    returned_J: float
    share: Share = Share(0.0, 0.0, 0.0)

    @property
    def work_J(self) -> float:  # noqa: N802 - J is the unit
        """Energy given less energy returned in a cycle."""
        return self.given_J - self.returned_J


@dataclass(frozen=True)
class DriveCurve:
    """A drive over time.

    Attributes
    ----------
    time, angle, torque, power : ndarray, shape (n,)
        s; of its body, rad; given to its body, N m and W, both empty where not stored.
    """

    time: Array
    angle: Array
    torque: Array
    power: Array


@dataclass(frozen=True)
class DriveResult:
    """One drive in a stage.

    Attributes
    ----------
    recorded : DriveCurve
        At the times of the series.
    duty, ideal : DriveDuty
        Of the run, integrated step by step, whatever rows are kept; and of the linkage with all
        joints closed.
    """

    recorded: DriveCurve
    duty: DriveDuty
    ideal: DriveDuty


@dataclass(frozen=True)
class Energy:
    """Energy of a part: of one stroke, which is one cycle.

    Attributes
    ----------
    process_J : Estimate or None
        Work that the process takes, over the recorded settled strokes.
    process_ideal_J : float or None
        The same with all joints closed, without a cushion, which gives back what it takes.
    drives_J : Estimate
        Net work of all drives, over the settled cycles of all starts.
    drives_ideal_J : float
    residual_part : float
        Energy of the whole stage that does not add up, part of what the drives exchanged; runs
        at the tolerances of a trajectory stay below ``ENERGY_BOUND``, for wear at some 1e-5.
    """

    process_J: Estimate | None
    process_ideal_J: float | None
    drives_J: Estimate
    drives_ideal_J: float
    residual_part: float


def drives_of(scene: Scene, stage: StageResult) -> dict[str, DriveResult]:
    """The drives of a stage by their bodies.

    None where torques were not stored, or no cycle is whole.

    Raises
    ------
    UntrustedLaw
        If the ideal torques would need source code stored in a result; so for all below.
    """
    if "drive_torque" not in stage.arrays or not stage.arrays["cycles"].size:
        return {}
    start, period = stage.arrays["cycle_start"], scene.mechanism.period
    # Behind the starts of the first set stand those on surfaces of their own.
    replicates = [stage.drive_cycles[start == k] for k in range(scene.draws)]
    cycles = np.concatenate([after_startup(own) for own in replicates])
    recorded, ideal = curves_of(scene, stage), ideal_drives(scene)
    duties = _shared(
        {body: _duty_of_cycles(cycles[:, k], period) for k, body in enumerate(recorded)}
    )
    return {body: DriveResult(own, duties[body], ideal[body]) for body, own in recorded.items()}


def ideal_drives(scene: Scene) -> dict[str, DriveDuty]:
    """What the drives of the linkage with all joints closed need in a cycle, by their bodies."""
    curves, weights = _ideal(scene)
    return _shared({body: _duty(own, weights) for body, own in curves.items()})


def ideal_curves(scene: Scene) -> dict[str, DriveCurve]:
    """Drives over a cycle behind the run-up with all joints closed, by their bodies."""
    return _ideal(scene)[0]


def energy_of(scene: Scene, stage: StageResult) -> Energy | None:
    """Energy of a part made in a stage; None where the stage failed before a cycle was whole."""
    work, exchange = stage.statistics.drive_work_per_cycle, stage.statistics.energy_exchanged
    if work is None:
        return None
    residual = abs(stage.statistics.energy_residual)
    tonnage = tonnage_of(scene, stage)
    return Energy(
        None if tonnage is None else tonnage.work_J,
        None if scene.process is None else scene.process.work,
        work,
        sum(own.work_J for own in ideal_drives(scene).values()),
        residual / exchange if exchange > 0.0 else 0.0,
    )


def curves_of(scene: Scene, stage: StageResult) -> dict[str, DriveCurve]:
    """The drives over the series, by their bodies; without stored torques those are empty."""
    torque = stage.arrays.get("drive_torque")
    return _curves(scene, stage.time, torque)


def _curves(scene: Scene, time: Array, torque: Array | None) -> dict[str, DriveCurve]:
    """Drives by their bodies from their torques, shape (n, drives), N m."""
    linkage, motion = scene.mechanism.linkage(), scene.ideal.at(time)
    found = {}
    for k, drive in enumerate(linkage.drives):
        place = 3 * linkage.index(drive.body) + 2
        own = np.zeros(0) if torque is None else torque[:, k]
        power = own * motion.velocity[: own.size, place]
        found[drive.body] = DriveCurve(time, motion.position[:, place], own, power)
    return found


@lru_cache(maxsize=16)
def _ideal(scene: Scene) -> tuple[dict[str, DriveCurve], Array]:
    """Drives over a cycle of the ideal motion, and the weights of its instants, s."""
    begin, period = scene.run_up, scene.mechanism.period
    before, cycle = (np.linspace(0.0, period, count + 1) for count in (_BEFORE, _PIECES))
    edges = begin + np.concatenate([before, period + cycle[1:]])
    edges = np.unique(np.concatenate([edges, _bends(scene, edges)]))
    curves, _ = _summed(scene, edges)
    # What is given and what is returned bend where the power of a drive changes its sign.
    cycle = edges[-1 - next(iter(curves.values())).time.size // _PLACES.size :]
    turns = [_zeros(cycle, own.power) for own in curves.values()]
    return _summed(scene, np.unique(np.concatenate([edges, *turns])))


def _summed(scene: Scene, edges: Array) -> tuple[dict[str, DriveCurve], Array]:
    """Ideal drives and weights of the instants in the last cycle between some edges, s."""
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    time = (middle[:, np.newaxis] + half[:, np.newaxis] * _PLACES).ravel()
    torque = needed_torques(scene.loaded, scene.ideal, time)
    own = time > edges[-1] - scene.mechanism.period
    return _curves(scene, time[own], torque[own]), np.outer(half, _WEIGHTS).ravel()[own]


def _zeros(edges: Array, values: Array) -> Array:
    """Instants, s, at which parabolas through the values in each piece are zero."""
    a, b, c = np.linalg.solve(np.vander(_PLACES), values.reshape(-1, _PLACES.size).T)
    with np.errstate(divide="ignore", invalid="ignore"):
        far = -0.5 * (b + np.copysign(np.sqrt(b * b - 4.0 * a * c), b))
        found = [far / a, c / far]
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    return np.concatenate([(middle + half * part)[np.abs(part) < 1.0] for part in found])


def _bends(scene: Scene, time: Array) -> Array:
    """Instants, s, at which the ideal stroke passes a place where the force of the work bends."""
    process = scene.process
    if process is None:
        return np.zeros(0)
    ideal = scene.ideal.at(time).output(scene.loaded)
    depth = process.height - (ideal[:, 0] - scene.bottom)
    found = []
    for level, _ in process.curve:
        for k in np.flatnonzero((depth[:-1] < level) != (depth[1:] < level)):
            low, high = time[k], time[k + 1]
            now = low + (high - low) * (level - depth[k]) / (depth[k + 1] - depth[k])
            for _ in range(_NEWTON):
                place, speed, _ = scene.ideal.at(np.array([now])).output(scene.loaded)[0]
                if speed == 0.0:
                    break
                off = process.height - (place - scene.bottom) - level
                now = min(max(now + off / speed, low), high)
            found.append(now)
    return np.array(found)


def _duty_of_cycles(cycles: Array, period: float) -> DriveDuty:
    """Return the numbers of a drive from those of its cycles, shape (n, columns CYCLE_DRIVE)."""
    mean = dict(zip(CYCLE_DRIVE, cycles.mean(axis=0).tolist(), strict=True))

    def peak(name: str) -> float:
        values = cycles[:, CYCLE_DRIVE.index(name)]
        return float(values[np.abs(values).argmax()])

    def rms(name: str) -> float:
        return math.sqrt(mean[name] / period)

    given, returned = mean["work_given"], mean["work_returned"]
    return DriveDuty(
        Duty(mean["torque_integral"] / period, rms("torque_square_integral"), peak("torque_peak")),
        Duty((given - returned) / period, rms("power_square_integral"), peak("power_peak")),
        given,
        returned,
    )


def _duty(curve: DriveCurve, weights: Array) -> DriveDuty:
    """Numbers of a drive from the weights, s, of its instants in a sum over a cycle."""

    def duty(values: Array) -> Duty:
        duration = float(weights.sum())
        return Duty(
            float(weights @ values) / duration,
            math.sqrt(float(weights @ values**2) / duration),
            float(values[np.abs(values).argmax()]),
        )

    given, returned = (float(weights @ np.maximum(sign * curve.power, 0.0)) for sign in (1.0, -1.0))
    return DriveDuty(duty(curve.torque), duty(curve.power), given, returned)


def _shared(duties: Mapping[str, DriveDuty]) -> dict[str, DriveDuty]:
    """The same with the share of each."""

    def parts(number: Callable[[DriveDuty], float]) -> dict[str, float]:
        total = sum(abs(number(own)) for own in duties.values())
        return {
            body: abs(number(own)) / total if total > 0.0 else 0.0 for body, own in duties.items()
        }

    rms = parts(lambda own: own.torque.rms)
    peak = parts(lambda own: own.power.peak)
    energy = parts(lambda own: own.given_J)
    return {
        body: replace(own, share=Share(rms[body], peak[body], energy[body]))
        for body, own in duties.items()
    }
