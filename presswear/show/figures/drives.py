"""Figure of the drives: the torque and the power that each gives."""

import numpy as np

from presswear.results.drives import curves_of, ideal_curves
from presswear.results.result import Result
from presswear.show.figures.motion import IDEAL, moving_stages, settled
from presswear.show.figures.style import WIDTH, Drawing, Sheet, Stages, legend


def drive_work(result: Result, stages: Stages) -> list[Drawing]:
    """Torque and power of each drive over the phase of the cycle, beside those of ideal joints.

    Only where torques were stored.
    """
    scene = result.scene
    shown = [
        stage for stage in moving_stages(result, stages) if "drive_torque" in stage.data.arrays
    ]
    drives = [drive.body for drive in scene.mechanism.linkage().drives]
    if not shown or not drives:
        return []
    shown, window = settled(result, shown)
    sheet = Sheet(figsize=(WIDTH, 0.6 + 1.5 * len(drives)), layout="constrained")
    grid = sheet.subplots(len(drives), 2, squeeze=False, sharex=True)
    for stage in shown:
        works = curves_of(scene, stage.data)
        for row, drive in zip(grid, drives, strict=True):
            for axes, values in zip(row, (works[drive].torque, works[drive].power), strict=True):
                stage.pen.draw(axes, stage.data.time, values, linewidth=0.8)
    ideal = ideal_curves(scene)
    cycles = np.arange(np.ceil((window.end - window.begin) / window.period))
    for row, drive in zip(grid, drives, strict=True):
        own = ideal[drive]
        time = own.time - scene.run_up - window.period
        time = np.add.outer(window.begin + window.period * cycles, time).ravel()
        for axes, values in zip(row, (own.torque, own.power), strict=True):
            IDEAL.draw(axes, time, np.tile(values, cycles.size), linewidth=0.7)
    for row, drive in zip(grid, drives, strict=True):
        row[0].set_title(drive, loc="left", fontweight="bold")
        row[0].set_ylabel("torque (N m)")
        row[1].set_ylabel("power (W)")
    for axes in grid[-1]:
        window.label(axes)
    sheet.align_ylabels()
    legend(sheet, [IDEAL, *(stage.pen for stage in shown)], "outside upper center")
    caption = (
        f"Torque that each drive gives to its body, counterclockwise, and power, over "
        f"{window.words}; dashed with ideal joints. Means and largest values are in the table of "
        "the drives."
    )
    return [Drawing("drives.png", "Torque and power of the drives", caption, sheet)]
