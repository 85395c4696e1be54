"""Pictures of the documentation that no study draws.

Run:  python docs/draw.py
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes

import presswear
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, NormalLaw, delivered_restitution
from presswear.linkage.loads import Force, OverPosition
from presswear.linkage.motions import RISES, Drive, Rise
from presswear.linkage.slider_crank import SliderCrank
from presswear.scene.scene import Scene
from presswear.show.figures.style import LINES, SETTINGS, WIDTH
from presswear.trials.verify import references
from presswear.trials.verify.verify import delivered

HERE = Path(__file__).parent
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
        scene = Scene(replace(free, loads=loads), bearings={}, wears=0, cycles=2, drive_torque="on")
        stage = presswear.run(scene, engine="dae").stages[0]
        axes.plot(1e3 * stage.displacement, stage.arrays["drive_torque"][:, 0], label=label)
    axes.set_xlabel("slider from where it starts, mm")
    axes.set_ylabel("torque of the crank, N m")
    axes.legend(frameon=False, title="against the way out, until the part breaks through")


PICTURES: dict[str, Callable[[Axes], None]] = {
    "restitution": restitution,
    "motion": motion,
    "load": load,
}

if __name__ == "__main__":
    for title, draw in PICTURES.items():
        with plt.rc_context({**SETTINGS, "axes.prop_cycle": cycler(color=COLOURS)}):
            figure, axes = plt.subplots(figsize=(WIDTH, 0.6 * WIDTH), layout="constrained")
            draw(axes)
            figure.savefig(HERE / f"{title}.png", dpi=120)
            plt.close(figure)
