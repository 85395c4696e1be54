"""Presses of other programs: `presslink` 0.0.3 and `mechpress` 0.0.11 on PyPI.

Their kinematics were computed a second time by circles that meet, exact to round-off.
"""

import cmath
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


def knuckle_joint_press(**slide: Any) -> Linkage:
    """Return the press of 630 t: its slide is drawn on x = 730 mm."""
    rocker_at = complex(0.73, 0.7375)
    a = complex(0.1875)
    b = meeting(a, rocker_at, 0.92, 0.83, side=-1.0)
    end = complex(0.73, b.imag - math.sqrt(0.83**2 - (b.real - 0.73) ** 2))
    lengths = {
        "crank": "187.5 mm",
        "rod": "920 mm",
        "rocker": "830 mm",
        "link": "830 mm",
    }
    return pw.assemble(
        name="knuckle joint",
        bodies=[
            *(pw.Bar(name, length, **MASS) for name, length in lengths.items()),
            pw.Body("slide", 1000.0, centre=slide.pop("centre", ("730 mm", end.imag))),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "rod.tail"),
            pw.Pin("B", "rod.head", "rocker.head"),
            pw.Pin("P", (0.73, 0.7375), "rocker.tail"),
            pw.Pin("C", "rocker.head", "link.head"),
            pw.Pin("D", "link.tail", "slide"),
            pw.Guide("guide", "slide", direction=UP, **slide),
        ],
        drives=[pw.Drive("crank", speed=math.pi)],
        guess={
            "rod": cmath.phase(b - a),
            "rocker": cmath.phase(b - rocker_at),
            "link": cmath.phase(b - end),
        },
    )


def meeting(
    p: complex, q: complex, from_p: float, from_q: float, side: float
) -> complex:
    """Return the place at two distances, on the left (1) or right (-1) of the line p to q."""
    along = (abs(q - p) ** 2 + from_p**2 - from_q**2) / (2.0 * abs(q - p))
    across = side * math.sqrt(from_p**2 - along**2)
    return p + complex(along, across) * (q - p) / abs(q - p)


def test_link_drive_of_2500_t():
    """Bottom -2609.99985 mm at 270.0392 degrees, stroke 1004.93291 mm."""
    crank = complex(0.26)
    rocker_at = complex(-1.175, -0.375)
    swing = meeting(crank, rocker_at, 0.8, 0.9, side=-1.0)
    plate = cmath.phase(swing - crank)
    corner = cmath.rect(1.175, math.radians(134.0))
    down = crank + cmath.rect(1.0, plate) * corner
    slide = complex(0.0, down.imag - math.sqrt(1.175**2 - down.real**2))
    linkage = pw.assemble(
        name="link drive",
        bodies=[
            pw.Bar("crank", "260 mm", **MASS),
            pw.Body(
                "plate", 500.0, 50.0, {"B": (0.8, 0.0), "C": (corner.real, corner.imag)}
            ),
            pw.Bar("rocker", "900 mm", **MASS),
            pw.Bar("rod", "1175 mm", **MASS),
            pw.Body("slide", 1000.0),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "crank.tail"),
            pw.Pin("A", "crank.head", "plate"),
            pw.Pin("B", "plate.B", "rocker.head"),
            pw.Pin("P", (-1.175, -0.375), "rocker.tail"),
            pw.Pin("C", "plate.C", "rod.head"),
            pw.Pin("D", "rod.tail", "slide"),
            pw.Guide("guide", "slide", direction=UP),
        ],
        drives=[pw.Drive("crank", speed=25.0 * math.pi / 30.0)],
        guess={
            "plate": plate,
            "rocker": cmath.phase(swing - rocker_at),
            "rod": cmath.phase(down - slide),
        },
    )
    angle, bottom = extreme(linkage, math.radians(270.0))
    assert 1e3 * bottom == pytest.approx(-2609.99985, abs=1e-5)
    assert math.degrees(angle) == pytest.approx(270.0392, abs=1e-4)
    turn = np.linspace(0.0, 2.0 * math.pi, 721)
    _, top = extreme(linkage, float(turn[heights(linkage, turn).argmax()]), -1.0)
    assert 1e3 * (top - bottom) == pytest.approx(1004.93291, abs=2e-5)


def test_knuckle_joint_press_of_630_t():
    """Two equal bottoms, 24.24 degrees apart, 13.63 um below the place between them."""
    linkage = knuckle_joint_press()
    assert linkage.guides[0].x == 0.73
    turn = np.linspace(0.0, 2.0 * math.pi, 3601)
    height = heights(linkage, turn)
    low = np.flatnonzero((height[1:-1] < height[:-2]) & (height[1:-1] < height[2:])) + 1
    (first, bottom), (second, other) = (extreme(linkage, float(turn[k])) for k in low)
    assert bottom == pytest.approx(other, abs=1e-9)
    assert bottom == pytest.approx(0.7375 - 1.66, abs=1e-9)  # rocker and link in line
    assert math.degrees(second - first) == pytest.approx(24.24, abs=5e-3)
    between = heights(linkage, np.linspace(first, second, 201)).max()
    assert 1e6 * (between - bottom) == pytest.approx(13.63, abs=5e-3)


def test_the_line_of_a_guide_and_the_slide_are_named():
    message = r"joint guide: its points lie 730 mm apart.* the line \(0, .*\) mm and slide \(730, "
    with pytest.raises(pw.InputError, match=message):
        knuckle_joint_press(x=0.0)
    linkage = knuckle_joint_press(x="2 m", centre=None)
    with pytest.raises(
        AssemblyError, match=r"the line of guide goes through \(2000, 0\) mm"
    ):
        ideal_motion(linkage, linkage.period)
