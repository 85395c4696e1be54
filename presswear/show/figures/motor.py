"""Figure of motors: speed and torque over the crank angle."""

import math

import numpy as np

from presswear.linkage.drives import Drive
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.show.figures import style
from presswear.show.figures.style import Axes, Drawing, Pen, Shown
from presswear.show.figures.window import draw_with_moments, sampled
from presswear.tools.arrays import Array

_RPM = 30.0 / math.pi  # 1 rad/s in 1/min
_NOMINAL = Pen("nominal speed", style.REFERENCE, (0.0, (4.0, 2.0)), 0.9)
_RATED = Pen("rated torque", style.MUTED, "dotted", 1.2)


def speed_and_torque(result: Result, moving: Shown) -> list[Drawing]:
    """Draw the speed of the first motor and the torque of all motors over the crank angle.

    Empty without a motor. Torques are drawn if they were stored.
    """
    linkage = result.scene.linkage()
    leader = linkage.leader
    if leader is None:
        return []
    has_torque = all("drive_torque" in stage.data.arrays for stage in moving)
    driven = [drive for drive in linkage.drives if drive.motor and has_torque]
    shown, window = sampled(result, moving)
    count = 1 + len(driven)
    sheet, panels, zones = window.rows(count, 0.6 + 1.9 * count)
    nominal = _RPM * abs(leader.speed)

    def speed(stage: StageResult) -> Array:
        return np.asarray(nominal * stage.nominal_rate)

    marks = draw_with_moments(panels[0], result, shown, moving, speed, window)
    panels[0].axhline(nominal, **_NOMINAL.line_style)
    panels[0].set_ylabel(f"speed of {leader.body}\n(1/min)")
    for axes, drive in zip(panels[1:], driven, strict=True):
        _draw_torque(axes, shown, linkage.drives.index(drive), drive)
    window.label(panels, zones)
    has_rated = any(_rated_torque(drive) is not None for drive in driven)
    pens = [*(stage.pen for stage in shown), _NOMINAL]
    if has_rated:
        pens.append(_RATED)
    slowest = 100.0 * float(shown[-1].data.nominal_rate.min())  # %
    return style.finished(
        "motor",
        sheet,
        pens,
        window=window,
        marks=marks.values(),
        slowest=slowest,
        leader=leader,
        has_torque=has_torque,
        has_rated=has_rated,
    )


def _draw_torque(axes: Axes, shown: Shown, column: int, drive: Drive) -> None:
    """Draw the torque of a drive, which has a column in the series, and its rated torque."""
    sense = math.copysign(1.0, drive.mean_speed)  # positive torques drive
    for stage in shown:
        torque = stage.data.arrays["drive_torque"][:, column]
        stage.pen.draw(axes, stage.data.time, sense * torque)
    rated_torque = _rated_torque(drive)
    if rated_torque is not None:
        axes.axhline(rated_torque, **_RATED.line_style)
    style.label_values(axes, f"torque on {drive.body}\n", "N m")


def _rated_torque(drive: Drive) -> float | None:
    """Return the rated torque of a motor at the driven body, N m; None if it has none."""
    motor = drive.motor
    if motor is None or motor.torque is None or not motor.has_slip:
        return None
    return motor.ratio * motor.torque
