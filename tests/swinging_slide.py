"""Slide that swings along a wall of its guide, shared by tests of worn walls."""

import math
from dataclasses import replace

import numpy as np

import presswear as pw
from presswear.engines.base import Start
from presswear.linkage.guide_corner import WallMap
from presswear.linkage.linkage import Linkage

L, W, C = 0.4, 0.3, 0.05e-3  # of the slide, m
WIDTH, COEFFICIENT = 0.1, 2e-13  # of the walls, m, and K_d, 1/Pa
MASS = 300.0
PERIOD = 0.1
AMPLITUDE = 0.03
FORCE = 5e3
WALL = WallMap(COEFFICIENT, -0.25, 0.5)


def press_on_wall(time: float) -> float:
    """Force on the slide to the left of its guide, N."""
    return 5e3


def swinging_slide() -> tuple[Linkage, Start]:
    """Return a slide that a spring swings along a wall, on which a force presses it."""
    stiffness = MASS * (2.0 * math.pi / PERIOD) ** 2
    linkage = pw.assemble(
        [pw.Body("slide", MASS)],
        [pw.Guide("guide", "slide", direction=0.5 * math.pi, length=L, width=W)],
        output="slide",
        gravity=0.0,
        cycle=PERIOD,
        springs=[pw.Spring("s", (0.0, -50.0), "slide", stiffness, length=50.0)],
        loads=[pw.Force("slide", math.pi, press_on_wall)],
    )
    bearing = pw.Bearing(clearance=C, width=WIDTH, friction=0.0)
    linkage = pw.Scene(linkage, bearings={"guide": bearing}).linkage()
    corners = tuple(replace(corner, wall=WALL) for corner in linkage.corners)
    linkage = replace(linkage, clearances=corners)
    depth = 0.5 * FORCE / corners[0].normal.stiffness
    return linkage, Start(np.array([-C - depth, AMPLITUDE, 0.0]), np.zeros(3))
