"""A guide that does not fit the drawing of its slide is refused with both lines."""

import math
from typing import Any

import pytest

import presswear as pw
from presswear.linkage.linkage import Linkage
from presswear.physics.ideal import ideal_motion
from presswear.tools.errors import AssemblyError

MASS: Any = {"mass": "100 kg"}  # the ideal motion does not depend on it


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
