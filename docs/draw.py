"""Pictures of the documentation that no study draws.

Those that take seconds are drawn when the site is built.  Run:  python docs/draw.py [NAME ...]
"""

import math
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes

import presswear
from presswear.campaign.campaign import run_stage, workers_of
from presswear.campaign.ensemble import ProgressEstimate, Runner
from presswear.campaign.service_life import (
    BlockPlan,
    LifeProblem,
    Refinement,
    SceneHistories,
    crossing,
    next_block,
)
from presswear.campaign.wear_update import initial_depth, update_surfaces
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.linkage.drives import RISES, Drive, Rise
from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, NormalLaw, delivered_restitution
from presswear.linkage.loads import Force, OverPosition
from presswear.linkage.mechanisms import SliderCrank
from presswear.recording.statistics import STARTUP_CYCLES, half_width
from presswear.scene.options import Limit
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.figures.style import LINES, SETTINGS, WIDTH
from presswear.tools.arrays import Array
from presswear.tools.processes import Workers
from presswear.validation import reference_problems as references
from presswear.validation.reference_checks import delivered

matplotlib.use("agg")
COLOURS = [colour for colour, _ in LINES]


def restitution(axes: Axes) -> None:
    """What each normal law gives back: its closed form, and single impacts in-house."""
    engine = InHouse(integration_tolerance=1e-11)
    case = references.Impact(1.0, clearance=1e-4)
    for name, law in DAMPINGS.items():
        if name == KELVIN_VOIGT:
            continue
        nominal = np.linspace(max(law.least, 0.0), 1.0, 200)
        exact = [delivered_restitution(law.factor(float(e))) for e in nominal]
        (line,) = axes.plot(nominal, exact, label=f"{law.title}")
        for e in np.linspace(0.1, 0.9, 5):
            normal = NormalLaw(case.stiffness, 1.5, law.factor(float(e)))
            joint = replace(case.linkage.clearances[0], normal=normal)
            run = engine.simulate(
                replace(case.linkage, clearances=(joint,)), case.start, Plan(4e-3, 1)
            )
            axes.plot(e, delivered(run, case.speed), "o", color=line.get_color(), markersize=4)
    axes.plot([0.0, 1.0], [0.0, 1.0], color="0.6", linewidth=0.8, zorder=0)
    axes.set_xlabel("nominal restitution")
    axes.set_ylabel("delivered restitution")
    axes.legend(frameon=False, title="lines: closed form; dots: one impact in-house")


def motion(axes: Axes) -> None:
    """Acceleration of a drive that rises, dwells and returns, under each law of rises."""
    time = np.linspace(0.0, 1.0, 2001)
    for law in RISES:
        rises = [Rise(0.0, 2.0, 1.0, law), Rise(3.0, 5.0, -1.0, law)]
        drive = Drive("servo", frequency=2.0 * np.pi, rises=rises)
        angle, _, faster = drive.motion(time)
        axes.plot(360.0 * time, faster, label=law)
    axes.plot(360.0 * time, 100.0 * angle, color="0.6", label="angle, 100 times")
    axes.set_xlabel("phase of the cycle, degrees")
    axes.set_ylabel("acceleration, rad/s²")
    axes.legend(frameon=False, title="1 rad up and down in a cycle of 1 s, with dwells")


def load(axes: Axes) -> None:
    """Torque of the crank of a slider-crank that blanks, and that runs free."""
    free = SliderCrank(speed=10.0).linkage()
    # 3 kN at most, against the way out only, and nothing once the part has broken through.
    table = [(0.150, 0.0), (0.151, -2.5e3), (0.158, -3e3), (0.160, -2.9e3)]
    blanking = Force("slider.centre", 0.0, OverPosition(table, sense="along", release=True))
    for label, loads in {"free": (), "blanking": (blanking,)}.items():
        scene = Scene(
            free.changed(loads=list(loads)),
            bearings={},
            wear_updates=0,
            cycles=2,
            drive_torque="on",
        )
        stage = presswear.run(scene, engine="dae").stages[0]
        axes.plot(1e3 * stage.displacement, stage.arrays["drive_torque"][:, 0], label=label)
    axes.set_xlabel("slider from where it starts, mm")
    axes.set_ylabel("torque of the crank, N m")
    axes.legend(frameon=False, title="against the way out, until the part breaks through")


UNTIL = Limit("depth", "A", 1e-5)
CHANGES = (5e-3, 2e-3, 1e-3, 5e-4)
"""Parts of the clearance that a cycle, or a jump, takes off."""
TINY = 1.25e-4
STARTS = 4
JUMP = 10
"""Cycles of which a jump multiplies the mean map."""


def life(axes: Axes) -> None:
    """Error of a life of wear-times over cycles: cycle by cycle, and in jumps of ten cycles."""
    scene = changed(presswear.scenes.wear_times(), {"conventions": "refined", "engine": "dae"})
    scene = replace(scene, replicates=STARTS)
    with workers_of(scene, None) as workers:
        right = np.log(_steps(scene, TINY, workers)[1])
        truth = float(right.mean())
        print(f"tiny steps: {math.exp(truth):.4g} strokes, {half_width(right):.2g} of it")
        for label, run in {"cycle by cycle": _steps, "jumps of ten cycles": _jumps}.items():
            found = [run(scene, change, workers) for change in CHANGES]
            cycles = [own[0] for own in found]
            off = np.array([np.log(own[1]) - truth for own in found])
            for place, error in zip(cycles, off, strict=True):
                print(
                    f"{label}: {place} cycles of each start, off by {error.mean():+.3f}, one "
                    f"start by {np.sqrt((error**2).mean()):.3f}"
                )
            (line,) = axes.loglog(cycles, np.sqrt((off**2).mean(axis=1)), "o-", label=label)
            axes.loglog(cycles, np.abs(off.mean(axis=1)), "o:", color=line.get_color())
    axes.set_xlabel("simulated cycles until A is worn 10 µm deep")
    axes.set_ylabel("error of the life, part of it")
    axes.legend(frameon=False, title="whole: root mean square of one start; dotted: mean of four")


def _steps(scene: Scene, change: float, workers: Workers) -> tuple[int, Array]:
    """Cycles of each start, and the life of each, where each cycle takes a part off."""
    runner = Runner(scene, ProgressEstimate(scene, ()), workers)
    histories = SceneHistories(runner, initial_depth(scene), ())
    problem = LifeProblem((UNTIL,), (), 1e12, 1.0, 1_000_000)
    own = Refinement(change, 1)
    while isinstance(plan := next_block(problem, own), BlockPlan):
        own = replace(own, blocks=(*own.blocks, histories.advance(1, own.blocks, plan)))
        each = [crossing(own.blocks, UNTIL, np.array([k])) for k in range(scene.replicate_count)]
        if np.all(np.isfinite(each)):
            break
    return sum(block.cycles for block in own.blocks[1:]), np.array(each)


def _jumps(scene: Scene, change: float, workers: Workers) -> tuple[int, Array]:
    """The same where each jump multiplies the mean map of ten cycles on surfaces that stay."""
    worn, strokes, jumps = initial_depth(scene), [0.0], 0
    depth = [np.zeros(scene.replicate_count)]
    joint = scene.linkage().clearances[0]
    while np.any(depth[-1] < UNTIL.value):
        seeded = replace(
            scene, cycles=STARTUP_CYCLES + JUMP, seed=jumps, wear_updates=0, purpose="wear"
        )
        maps = run_stage(seeded, 0, worn, workers=workers)[1].added_by_run()
        share = change * joint.clearance / float(maps[:, 0].mean(axis=0).max())
        worn = update_surfaces(worn, share * maps)
        jumps += 1
        strokes.append(strokes[-1] + share)
        depth.append(worn[:, 0].max(axis=(1, 2)))
    each = [
        np.interp(UNTIL.value, np.array(depth)[:, k], strokes) for k in range(scene.replicate_count)
    ]
    return JUMP * jumps, np.array(each)


PICTURES: dict[str, Callable[[Axes], None]] = {
    "restitution": restitution,
    "motion": motion,
    "load": load,
    "life": life,
}


def save(name: str, folder: Path) -> None:
    """Draw a picture into a folder."""
    with plt.rc_context({**SETTINGS, "axes.prop_cycle": cycler(color=COLOURS)}):
        figure, axes = plt.subplots(figsize=(WIDTH, 0.6 * WIDTH), layout="constrained")
        PICTURES[name](axes)
        figure.savefig(folder / f"{name}.png", dpi=120)
        plt.close(figure)


if __name__ == "__main__":
    for title in sys.argv[1:] or PICTURES:
        save(title, Path.cwd())
