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

from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.linkage.laws import DAMPINGS, KELVIN_VOIGT, NormalLaw, delivered_restitution
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


PICTURES: dict[str, Callable[[Axes], None]] = {"restitution": restitution}

if __name__ == "__main__":
    for title, draw in PICTURES.items():
        with plt.rc_context({**SETTINGS, "axes.prop_cycle": cycler(color=COLOURS)}):
            figure, axes = plt.subplots(figsize=(WIDTH, 0.6 * WIDTH), layout="constrained")
            draw(axes)
            figure.savefig(HERE / f"{title}.png", dpi=120)
            plt.close(figure)
