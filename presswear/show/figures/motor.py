"""Figure of motors: speed and torque over the crank angle."""

import math

from presswear.linkage.drives import Drive
from presswear.results.result import Result
from presswear.show.figures import style
from presswear.show.figures.style import Drawing, Pen, Shown
from presswear.show.figures.window import draw_with_moments, sampled

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
    driven = []
    if has_torque:
        driven = [drive for drive in linkage.drives if drive.motor]
    shown, window = sampled(result, moving)
    count = 1 + len(driven)
    sheet, panels, zones = window.rows(count, 0.6 + 1.9 * count)
    nominal = _RPM * abs(leader.speed)
    pairs = zip(shown, moving, strict=True)
    marks = draw_with_moments(
        panels[0], result, pairs, lambda stage: nominal * stage.nominal_rate, window
    )
    panels[0].axhline(nominal, **_NOMINAL.line_style)
    panels[0].set_ylabel(f"speed of {leader.body}\n(1/min)")
    for axes, drive in zip(panels[1:], driven, strict=True):
        column = linkage.drives.index(drive)
        sense = math.copysign(1.0, drive.mean_speed)  # positive torques drive
        for stage in shown:
            driving_torque = sense * stage.data.arrays["drive_torque"][:, column]
            stage.pen.draw(axes, stage.data.time, driving_torque)
        rated_torque = _rated_torque(drive)
        if rated_torque is not None:
            axes.axhline(rated_torque, **_RATED.line_style)
        style.label_values(axes, f"torque on {drive.body}\n", "N m")
    window.label(panels, zones)
    rated_torques = [
        torque for torque in map(_rated_torque, driven) if torque is not None
    ]
    pens = [*(stage.pen for stage in shown), _NOMINAL]
    if rated_torques:
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
        has_rated=bool(rated_torques),
    )


def _rated_torque(drive: Drive) -> float | None:
    """Return the rated torque of a motor at the driven body, N m; None if it has none."""
    motor = drive.motor
    if motor is None or motor.torque is None or not motor.has_slip:
        return None
    return motor.ratio * motor.torque
