"""Presses of other programs: `presslink` 0.0.3 and `mechpress` 0.0.11 on PyPI.

Their kinematics were computed a second time by circles that meet, exact to round-off.
"""

import math
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import presswear as pw
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import ideal_motion
from presswear.tools.errors import AssemblyError

MASS: Any = {"mass": "100 kg"}  # the ideal motion does not depend on it
UP = 0.5 * math.pi


def heights(linkage: Linkage, angles: Any) -> np.ndarray:
    """Return the heights of the slide, m, at crank angles from the start, rad."""
    ideal = ideal_motion(linkage, linkage.period)
    time = np.atleast_1d(angles) * linkage.period / (2.0 * math.pi)
    return ideal.at(time).output(linkage)[:, 0]


def extreme(linkage: Linkage, near: float, sign: float = 1.0) -> tuple[float, float]:
    """Return crank angle, rad, and height, m, of the lowest (or highest) place near an angle."""
    found = minimize_scalar(
        lambda angle: sign * heights(linkage, [angle])[0],
        bounds=(near - 0.15, near + 0.15),
        method="bounded",
        options={"xatol": 1e-9},
    )
    return float(found.x), sign * float(found.fun)


def drawn_press(**slide: Any) -> Linkage:
    """Return an upright slider-crank whose slide is drawn on x = 730 mm."""
    place = slide.pop("centre", ("730 mm", -math.sqrt(0.4**2 - 0.1**2)))
    return pw.assemble(
        bodies=[
            pw.Bar("crank", "100 mm", **MASS),
            pw.Bar("rod", "400 mm", **MASS),
            pw.Body("slide", 1000.0, centre=place),
        ],
        joints=[
            pw.Pin("O", (0.73, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "rod.tail"),
            pw.Pin("B", "rod.head", "slide"),
            pw.Guide("guide", "slide", direction=0.5 * math.pi, **slide),
        ],
        drives=[pw.Drive("crank", speed=math.pi)],
        guess={"rod": math.radians(-105.0)},
    )


def test_the_line_of_a_guide_and_the_slide_are_named():
    assert drawn_press().guides[0].x == 0.73
    message = r"joint guide: its points lie 730 mm apart.* the line \(0, .*\) mm and slide \(730, "
    with pytest.raises(pw.InputError, match=message):
        drawn_press(x=0.0)
    linkage = drawn_press(x="2 m", centre=None)
    with pytest.raises(
        AssemblyError, match=r"the line of guide goes through \(2000, 0\) mm"
    ):
        ideal_motion(linkage, linkage.period)
