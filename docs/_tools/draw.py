"""Draw pictures of the documentation:  python docs/_tools/draw.py [NAME ...]

The build of the site draws all but ``life``, which takes minutes.
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
from presswear.campaign.campaign import run_stage
from presswear.campaign.refinement import Refinement
from presswear.campaign.runner import Runner
from presswear.campaign.runs import workers_of
from presswear.campaign.service_life import BlockPlan, LifeProblem, next_block
from presswear.campaign.wear_histories import WearHistories
from presswear.campaign.wear_update import initial_depth
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.linkage.drives import Drive
from presswear.linkage.load_laws import OverPosition
from presswear.linkage.loads import Force
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.motion_pieces import RISES, Rise
from presswear.linkage.normal_law import (
    DAMPINGS,
    KELVIN_VOIGT,
    NormalLaw,
    delivered_restitution,
)
from presswear.linkage.process import Blanking
from presswear.recording.statistics import STARTUP_CYCLES, half_width
from presswear.scene.options import Limit
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.figures.style import LINES, SETTINGS, WIDTH
from presswear.tools.arrays import Array
from presswear.tools.processes import Workers
from presswear.validation import reference_problems as references

matplotlib.use("agg")
COLOURS = [colour for colour, _ in LINES]


def restitution(axes: Axes) -> None:
    """Draw the delivered restitution of each normal law: closed form and single impacts."""
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
            axes.plot(
                e,
                references.delivered(run, case.speed),
                "o",
                color=line.get_color(),
                markersize=4,
            )
    axes.plot([0.0, 1.0], [0.0, 1.0], color="0.6", linewidth=0.8, zorder=0)
    axes.set_xlabel("nominal restitution")
    axes.set_ylabel("delivered restitution")
    axes.legend(frameon=False, title="lines: closed form; dots: one impact in-house")


def motion(axes: Axes) -> None:
    """Draw the acceleration of a drive that rises, dwells and returns, for each law."""
    time = np.linspace(0.0, 1.0, 2001)
    for law in RISES:
        rises = [Rise(0.0, 2.0, 1.0, law), Rise(3.0, 5.0, -1.0, law)]
        drive = Drive("servo", frequency=2.0 * np.pi, rises=rises)
        angle, _, acceleration = drive.motion(time)
        axes.plot(360.0 * time, acceleration, label=law)
    axes.plot(360.0 * time, 100.0 * angle, color="0.6", label="angle, 100 times")
    axes.set_xlabel("phase of the cycle, degrees")
    axes.set_ylabel("acceleration, rad/s²")
    axes.legend(frameon=False, title="1 rad up and down in a cycle of 1 s, with dwells")


def load(axes: Axes) -> None:
    """Draw the crank torque of a slider-crank with and without a blanking load."""
    free = SliderCrank(slide_angle=0.0, speed=10.0).linkage()
    # 3 kN at most, against the outward motion only, and zero after the fracture
    table = [(0.150, 0.0), (0.151, -2.5e3), (0.158, -3e3), (0.160, -2.9e3)]
    blanking = Force(
        "slider.centre", 0.0, OverPosition(table, sense="along", release=True)
    )
    for label, loads in {"free": (), "blanking": (blanking,)}.items():
        scene = Scene(
            free.changed(loads=list(loads)),
            bearings={},
            wear_updates=0,
            cycles=2,
            drive_torque="on",
        )
        stage = presswear.run(scene, engine="dae").stages[0]
        axes.plot(
            1e3 * stage.displacement, stage.arrays["drive_torque"][:, 0], label=label
        )
    axes.set_xlabel("displacement of the slider, mm")
    axes.set_ylabel("torque of the crank, N m")
    axes.legend(
        frameon=False, title="load against the outward motion, up to the fracture"
    )


def blanking(axes: Axes) -> None:
    """Draw the force of blanking over the depth, with the keys of the process."""
    process = Blanking(400e3, 3.5e-3, 2e-3, rise=0.2e-3, snap=0.15e-3, cushion=40e3)
    depth, force = np.array(process.curve).T * [[1e3], [1e-3]]
    rise, fracture, done = depth[1:]
    top = 1e-3 * process.force
    cushion = 1e-3 * process.cushion
    height = 1e3 * process.height
    thickness = 1e3 * process.thickness
    axes.plot(
        [*depth, height],
        [*force, 0.0],
        label=f"sheet: {process.work:.0f} J in a stroke",
    )
    axes.plot(
        [0.0, rise, height], [0.0, cushion, cushion], label="cushion: acts in addition"
    )
    widths = {  # start and end, mm, level of the arrow, kN, and place of the name
        "rise ": (0.0, rise, 1.08 * top, 0.0, "right"),
        "plateau × thickness": (
            rise,
            fracture,
            1.08 * top,
            0.5 * (rise + fracture),
            "center",
        ),
        " snap": (fracture, done, 1.08 * top, done, "left"),
        "thickness": (
            rise,
            rise + thickness,
            1.3 * top,
            rise + 0.5 * thickness,
            "center",
        ),
        "height": (0.0, height, -0.15 * top, 0.5 * height, "center"),
    }
    arrow = {"arrowstyle": "<->", "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 6.0}
    for name, (start, end, level, place, side) in widths.items():
        axes.annotate("", (start, level), (end, level), arrowprops=arrow)
        axes.text(place, level + 0.01 * top, name, ha=side, va="bottom")
    axes.vlines(depth, force, 1.08 * top, color="0.6", linestyle=":")
    axes.set(xlim=(-0.5, height + 0.1), ylim=(-0.25 * top, 1.5 * top))
    axes.set_xlabel(
        "depth, mm, from the point where the work is touched to bottom dead centre"
    )
    axes.set_ylabel("force, kN")
    axes.legend(frameon=False, loc="center right")


UNTIL = Limit("depth", "A", 1e-5)
# Wear of a cycle, or of a jump, relative to the clearance
STEPS = (5e-3, 2e-3, 1e-3, 5e-4)
REFERENCE_STEP = 1.25e-4
REPLICATES = 4
JUMP = 10  # cycles of the mean map that a jump multiplies


def life(axes: Axes) -> None:
    """Draw the error of a life of wear-times: cycle by cycle, and in jumps of ten cycles."""
    scene = changed(
        presswear.scenes.wear_times(), {"conventions": "refined", "engine": "dae"}
    )
    scene = replace(scene, replicates=REPLICATES)
    with workers_of(scene, None) as workers:
        reference = np.log(_steps(scene, REFERENCE_STEP, workers)[1])
        truth = float(reference.mean())
        print(
            f"reference: {math.exp(truth):.4g} strokes ± {half_width(reference):.2g} relative"
        )
        for label, run in {
            "cycle by cycle": _steps,
            "jumps of ten cycles": _jumps,
        }.items():
            results = [run(scene, step, workers) for step in STEPS]
            cycles = [count for count, _ in results]
            errors = np.array([np.log(lives) - truth for _, lives in results])
            for count, error in zip(cycles, errors, strict=True):
                print(
                    f"{label}: {count} cycles per replicate, error of mean {error.mean():+.3f}, "
                    f"one replicate {np.sqrt((error**2).mean()):.3f}"
                )
            (line,) = axes.loglog(
                cycles, np.sqrt((errors**2).mean(axis=1)), "o-", label=label
            )
            axes.loglog(
                cycles, np.abs(errors.mean(axis=1)), "o:", color=line.get_color()
            )
    axes.set_xlabel("simulated cycles until A is worn 10 µm deep")
    axes.set_ylabel("relative error of the life")
    axes.legend(frameon=False, title="solid: one replicate (rms); dotted: mean of four")


def _steps(scene: Scene, step: float, workers: Workers) -> tuple[int, Array]:
    """Return the cycles of a replicate and the life of each, with one update per cycle."""
    # Where the mean has crossed this limit, each replicate has crossed the one that is
    # asked for.
    beyond = replace(UNTIL, value=1.5 * UNTIL.value)
    problem = LifeProblem((beyond,), (), 1e12, 1.0, 1_000_000)
    histories = WearHistories(Runner(scene, workers), initial_depth(scene), problem)
    level = Refinement(step, 1)
    while isinstance(plan := next_block(problem, level), BlockPlan):
        level = replace(
            level, blocks=(*level.blocks, histories.advance((level,), plan))
        )
        lives = [level.crossing([UNTIL], np.array([k])) for k in range(REPLICATES)]
        if np.all(np.isfinite(lives)):
            break
    return sum(block.cycles for block in level.blocks[1:]), np.array(lives)


def _jumps(scene: Scene, step: float, workers: Workers) -> tuple[int, Array]:
    """Return the same for jumps that multiply the mean map of ten cycles on fixed surfaces."""
    worn = initial_depth(scene)
    strokes = [0.0]
    jumps = 0
    depth = [np.zeros(scene.replicate_count)]
    joint = scene.linkage().clearances[0]
    while np.any(depth[-1] < UNTIL.value):
        seeded = replace(
            scene,
            cycles=STARTUP_CYCLES + JUMP,
            seed=jumps,
            wear_updates=0,
            purpose="wear",
        )
        maps = run_stage(seeded, worn, workers=workers)[1].added_by_run()
        share = step * joint.clearance / float(maps[:, 0].mean(axis=0).max())
        worn = worn + share * maps
        jumps += 1
        strokes.append(strokes[-1] + share)
        depth.append(worn[:, 0].max(axis=(1, 2)))
    depths = np.array(depth).T
    lives = [np.interp(UNTIL.value, values, strokes) for values in depths]
    return JUMP * jumps, np.array(lives)


PICTURES: dict[str, Callable[[Axes], None]] = {
    "restitution": restitution,
    "motion": motion,
    "load": load,
    "blanking": blanking,
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
