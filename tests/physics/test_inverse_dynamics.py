"""Torques of drives and corners of loads in the ideal motion."""

import math
from dataclasses import replace

import numpy as np
import pytest

import presswear as pw
from presswear.linkage.load_laws import OverPosition, OverTime
from presswear.physics.curve_following import motion_of
from presswear.physics.inverse_dynamics import (
    check_drives,
    load_corners,
)
from presswear.tools.errors import InputError


def test_corners_of_loads_are_where_their_tables_have_nodes():
    mechanism = pw.SliderCrank(slide_angle=0.0)
    crank = mechanism.crank_length
    rod = mechanism.rod_length
    speed = mechanism.speed
    linkage = mechanism.linkage()
    period = mechanism.period
    point = linkage.output.attachment
    direction = linkage.output.direction
    loads = (
        pw.Force(
            point,
            direction,
            OverPosition(((-0.02, 1.0), (0.01, 3.0)), outside="hold", zero=0.12),
            "sheet",
        ),
        pw.Moment(
            "crank", OverPosition(((0.3, 0.0), (0.9, 5.0)), outside="hold", zero=7.0)
        ),
        pw.Force(
            point, direction, OverTime(((0.001, 1.0), (0.002, 2.0))), "every cycle"
        ),
        pw.Force(
            point, direction, OverTime(((0.003, 1.0), (0.02, 2.0)), period=0.0), "once"
        ),
    )
    time = np.linspace(0.0, 2.0 * period, 200)
    corners = load_corners(replace(linkage, loads=loads), motion_of(linkage), time)
    # The law of cosines: the crank angle at which the slider is at x, on both sides
    x = np.array([0.1, 0.13])
    angle = np.arccos((x**2 + crank**2 - rod**2) / (2.0 * crank * x))
    angles = np.append(angle, 2.0 * math.pi - angle)
    turns = angles + 2.0 * math.pi * np.arange(2)[:, np.newaxis]
    expected = [*turns.ravel() / speed, 7.3 / speed, 7.9 / speed]
    expected += [0.001, 0.002, period + 0.001, period + 0.002, 0.003, 0.02]
    assert np.sort(corners) == pytest.approx(np.sort(expected), abs=1e-8)


def test_a_limit_is_that_of_the_greatest_torque():
    """A bar on a pin at even speed bears its weight alone: m g r."""
    bar = pw.Bar("crank", length=0.4, mass=2.0)
    weight = 2.0 * 9.81 * 0.2

    def made(limit: float) -> pw.linkage.Linkage:
        drive = pw.Drive("crank", speed=5.0, angle=0.3, torque_limit=limit)
        return pw.assemble([bar], [pw.Pin("O", (0.0, 0.0), "crank.tail")], [drive])

    enough = made(1.001 * weight)
    little = made(0.999 * weight)
    check_drives(enough, motion_of(enough))
    says = r"crank = 3\.92008 N m: the ideal motion needs 3\.924 N m, at 162\.\d degrees of a cycle"
    with pytest.raises(InputError, match=says):
        check_drives(little, motion_of(little))
    with pytest.raises(
        InputError, match="torque_limit of crank = 0 N m: allowed is 1e-06 to"
    ):
        made(0.0)
