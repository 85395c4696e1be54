"""Figure of the drives: the torque and the power that each gives."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from presswear.results.drives import curves_of, ideal_curves
from presswear.results.result import Result
from presswear.show.figures.motion import IDEAL, moving_stages, settled
from presswear.show.figures.style import WIDTH, Drawing, Pen, Sheet, Stages, legend
from presswear.tools.numbers import readable

Array = NDArray[np.float64]

_BEYOND = 0.005
"""Part of the time that may lie over the panel, and as much under it."""


def drive_work(result: Result, stages: Stages) -> list[Drawing]:
    """Torque and power of each drive over the phase of the cycle, beside those of ideal joints.

    Only where torques were stored, and ideal ones need no source code stored in the result.
    """
    scene = result.scene
    shown = [
        stage for stage in moving_stages(result, stages) if "drive_torque" in stage.data.arrays
    ]
    drives = [drive.body for drive in scene.mechanism.linkage().drives]
    if not shown or not drives or scene.has_untrusted_loads:
        return []
    shown, window = settled(result, shown)
    sheet = Sheet(figsize=(WIDTH, 0.6 + 1.9 * len(drives)), layout="constrained")
    grid = sheet.subplots(len(drives), 2, squeeze=False, sharex=True)
    ran = [(stage.pen, stage.data.time, curves_of(scene, stage.data)) for stage in shown]
    ideal = ideal_curves(scene)
    cycles = np.arange(np.ceil((window.end - window.begin) / window.period))
    for row, drive in zip(grid, drives, strict=True):
        own = ideal[drive]
        time = own.time - scene.run_up - window.period
        time = np.add.outer(window.begin + window.period * cycles, time).ravel()
        for axes, name, unit in zip(row, ("torque", "power"), ("N m", "W"), strict=True):
            lines = [(pen, when, getattr(found[drive], name)) for pen, when, found in ran]
            _draw(axes, lines, (time, np.tile(getattr(own, name), cycles.size)), unit)
            axes.set_ylabel(f"{name} ({unit})")
        row[0].set_title(drive, loc="left", fontweight="bold")
    for axes in grid[-1]:
        window.label(axes)
    sheet.align_ylabels()
    legend(sheet, [IDEAL, *(stage.pen for stage in shown)], "outside upper center")
    caption = (
        f"Torque that each drive gives to its body, counterclockwise, and power, over "
        f"{window.words}; dashed with ideal joints. Panels hold the ideal and all but "
        f"{200.0 * _BEYOND:g} % of the time: peaks of impacts go beyond them, the farthest from "
        "zero as written there, in the order of the legend. Largest torques stand at a "
        "glance, means in the table of the drives."
    )
    return [Drawing("drives.png", "Torque and power of the drives", caption, sheet)]


def _draw(
    axes: Axes, lines: Sequence[tuple[Pen, Array, Array]], ideal: tuple[Array, Array], unit: str
) -> None:
    """Draw lines over time, the ideal one on top, in a panel that short peaks leave."""
    low, high = float(ideal[1].min()), float(ideal[1].max())
    for pen, time, values in lines:
        pen.draw(axes, time, values, linewidth=0.7)
        least, most = within(time, values, _BEYOND)
        low, high = min(low, least), max(high, most)
    IDEAL.draw(axes, *ideal, linewidth=0.9)
    margin = 0.08 * (high - low)
    axes.set_ylim(low - margin, high + margin)
    farthest = (readable(float(own[np.abs(own).argmax()])) for _, _, own in lines)
    axes.set_title(f"farthest: {', '.join(farthest)} {unit}", loc="right", fontsize="small")


def within(time: Array, values: Array, beyond: float) -> tuple[float, float]:
    """Ends between which a sampled quantity stays but for a part of the time at either.

    Parameters
    ----------
    time, values : ndarray, shape (n,)
    beyond : float
        That part.
    """
    weights = np.gradient(time)
    order = np.argsort(values)
    part = np.cumsum(weights[order]) / weights.sum()
    least, most = np.searchsorted(part, (beyond, 1.0 - beyond))
    return float(values[order[least]]), float(values[order[min(most, order.size - 1)]])
