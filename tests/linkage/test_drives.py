"""Motions of drives: rises and tables against closed forms and scipy, servo laws of the press."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import Phase, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import BPoly, CubicSpline

import presswear as pw
from presswear.linkage.drives import Drive
from presswear.linkage.motion_pieces import RISES, Rise, pieces_of
from presswear.physics.curve_following import motion_of
from presswear.physics.drive_motion import run_up_motion
from presswear.tools.arrays import Array

TURN = 2.0 * math.pi

# Greatest velocity and acceleration of a rise by 1 over a length of 1; cam handbooks
# print 2.0 and 6.28, 1.76 and 5.53, 1.88 and 5.77.
FACTORS = {
    "cycloidal": (2.0, TURN),
    "modified-sine": (
        4.0 * math.pi / (4.0 + math.pi),
        4.0 * math.pi**2 / (4.0 + math.pi),
    ),
    "3-4-5": (1.875, 10.0 / math.sqrt(3.0)),
}


def closed_form(law: str, x: Array) -> Array:
    if law == "cycloidal":
        return np.asarray(x - np.sin(TURN * x) / TURN)
    if law == "3-4-5":
        return np.asarray(10.0 * x**3 - 15.0 * x**4 + 6.0 * x**5)
    outer = math.pi * x - 0.25 * np.sin(4.0 * math.pi * x)
    inner = 2.0 + math.pi * x - 2.25 * np.sin((4.0 * math.pi * x + math.pi) / 3.0)
    result = np.where(x < 0.125, outer, np.where(x < 0.875, inner, 4.0 + outer))
    return np.asarray(result / (4.0 + math.pi))


@pytest.mark.parametrize("law", RISES)
def test_a_rise_is_the_law_of_the_handbooks(law):
    begin = 0.7
    end = 2.9
    by = -0.4
    pieces = pieces_of(
        (), (Rise(begin, end, by, law), Rise(4.0, 5.0, -by, "cycloidal"))
    )
    x = np.linspace(0.0, 1.0, 4001)
    value, slope, curvature = pieces.at(begin + (end - begin) * x)
    assert_allclose(value, by * closed_form(law, x), atol=1e-15)
    velocity, acceleration = FACTORS[law]
    unit = by / (end - begin)
    assert np.abs(slope / unit).max() == pytest.approx(velocity, rel=1e-6)
    unit /= end - begin
    assert np.abs(curvature / unit).max() == pytest.approx(acceleration, rel=1e-6)
    # It begins and ends without velocity and acceleration. A dwell follows.
    for level in (slope, curvature):
        assert np.abs(level[[0, -1]]).max() < 1e-14
    dwell = pieces.at(np.linspace(end, 4.0, 20))
    assert_allclose(dwell[0], by, rtol=1e-15)
    assert np.abs(dwell[1:]).max() < 1e-15


part = st.tuples(
    st.floats(0.05, 1.0), st.floats(-2.0, 2.0), st.sampled_from(sorted(RISES))
)


@given(
    st.lists(part, min_size=2, max_size=8),
    st.floats(0.0, 6.0),
    st.sampled_from([0.5, 1.0]),
)
def test_rises_join_smoothly_around_the_cycle(drawn, first, share):
    """Angle, speed and acceleration are continuous between pieces."""
    parts, lifts, laws = zip(*drawn, strict=True)
    ends = first + TURN * np.cumsum([0.0, *parts]) / sum(parts)
    result = [
        Rise(begin, begin + share * (end - begin), by, law)
        for (begin, end), by, law in zip(pairwise(ends), lifts, laws, strict=True)
    ]
    pieces = pieces_of((), tuple(result))
    assert pieces.net == pytest.approx(sum(lifts), abs=1e-12)
    assert np.all(np.diff(pieces.start) > 0.0)
    assert 0.0 <= pieces.start[0] <= pieces.start[-1] < TURN
    h = 1e-9
    before = pieces.at(pieces.start - h)
    after = pieces.at(pieces.start + h)
    shortest = min(rise.end - rise.start for rise in result)
    for level in range(3):
        slope = 400.0 / shortest ** (level + 1)  # largest, of this derivative
        difference = 1e-13 + 2.0 * h * slope
        assert_allclose(before[level], after[level], atol=difference)
    assert abs(pieces.at(np.zeros(1))[0][0]) < 1e-15


row = st.tuples(st.floats(0.01, 1.0), st.floats(-2.0, 2.0))


@given(
    st.lists(row, min_size=3, max_size=40),
    st.floats(0.0, 3.0),
    st.floats(-7.0, 7.0),
    st.floats(-30.0, 1000.0),
)
def test_a_table_is_the_periodic_spline_of_scipy(drawn, first, net, phase):
    """A table that advances in each cycle is a periodic spline plus a constant speed."""
    parts, values = zip(*drawn, strict=True)
    phases = first + TURN * np.cumsum([0.0, *parts[:-1]]) / sum(parts)
    rows = [*zip(phases, values, strict=True), (first + TURN, values[0] + net)]
    pieces = pieces_of(tuple(rows), ())
    knots = np.append(phases, first + TURN)
    level = np.append(values, values[0] + net) - net * knots / TURN
    level[-1] = level[0]
    spline = CubicSpline(knots, level, bc_type="periodic")
    exact = np.array([spline(phase, k) for k in range(3)])
    exact[0] -= spline(0.0)
    size = np.abs([spline(knots, k) for k in range(4)]).max(axis=1)
    size[1:3] += 1.0
    off = np.abs(np.ravel(pieces.at(np.array([phase]))) - exact)
    # A phase of 1000 rad is known to 1e-13 rad.
    assert np.all(off < 1e-12 * (size[:3] + size[1:]))
    assert pieces.net == pytest.approx(net, abs=1e-12)


def test_rows_of_four_are_joined_by_polynomials_of_degree_five():
    """As scipy's, from value and two derivatives at the nodes."""
    phase = np.array([0.2, 1.0, 2.5, 4.0, 5.5])
    data = np.column_stack([np.sin(phase), np.cos(phase), -np.sin(phase)])
    pieces = pieces_of(tuple(map(tuple, np.column_stack([phase, data]).tolist())), ())
    around = np.vstack([data, data[0]])[:, :, np.newaxis]
    exact = BPoly.from_derivatives(np.append(phase, phase[0] + TURN), list(around))
    times = np.linspace(0.2, 0.2 + TURN, 100, endpoint=False)
    value, slope, curvature = pieces.at(times)
    shift = float(exact(TURN)[0])
    assert_allclose(value + shift, exact(times)[:, 0], atol=1e-14)
    assert_allclose(slope, exact.derivative()(times)[:, 0], atol=1e-13)
    assert_allclose(curvature, exact.derivative(2)(times)[:, 0], atol=1e-12)


def test_a_drive_that_indexes_stands_still_in_its_dwells():
    """The crank makes a quarter turn in each cycle, which gives its mean speed."""
    drive = Drive(
        "crank", frequency=8.0, angle=0.3, rises=[Rise(0.0, 2.0, 0.25 * TURN, "3-4-5")]
    )
    assert drive.mean_speed == pytest.approx(2.0)
    cycle = TURN / 8.0
    dwell = np.array([0.7, 1.7, 2.7, 3.7, 4.7]) * cycle
    angle, speed, acceleration = drive.motion(dwell)
    assert_allclose(angle, 0.3 + 0.25 * TURN * np.arange(1, 6), rtol=1e-15)
    assert np.abs(speed).max() < 1e-14
    assert np.abs(acceleration).max() < 1e-13


def test_a_run_up_is_smooth_and_ends_in_step():
    """Speed and acceleration are derivatives; the run-up of 4 s costs 2 s of motion."""
    time = np.linspace(-0.5, 6.0, 200)
    h = 1e-5

    def motion_at(times: Array) -> Array:
        return np.transpose([run_up_motion(4.0, t) for t in times])

    levels = motion_at(time)
    slope = (motion_at(time + h) - motion_at(time - h)) / (2.0 * h)
    for level in (0, 1):
        assert_allclose(slope[level], levels[level + 1], atol=1e-9)
    late = time > 4.0
    assert_array_equal(levels[0][late], time[late] - 2.0)
    assert run_up_motion(4.0, 0.0) == (0.0, 0.0, 0.0)


IDEAL = pw.scenes.ideal()
W = pw.Press().speed

SOME = settings(max_examples=4, deadline=None, phases=[Phase.explicit, Phase.generate])


@SOME
@given(
    st.floats(0.02, 0.12),
    st.floats(0.075, 0.09),
    st.floats(115.0, 125.0),
    st.sampled_from(["cycloidal", "modified-sine", "3-4-5"]),
)
def test_slider_dwells_as_requested(part, stroke, bottom, law):
    dwell = pw.linkage.Dwell(
        part=part, stroke=stroke, bottom=math.radians(bottom), law=law
    )
    press = pw.Press(servo=dwell)
    ideal = motion_of(press)
    bottom = ideal.at(np.array([dwell.bottom / W])).output(press.linkage())[0, 0]
    whole = ideal.at(ideal.times).output(press.linkage())[:, 0]
    away = np.abs((W * ideal.times - dwell.bottom + math.pi) % TURN - math.pi) / math.pi
    rise = np.clip((away - part) / (1.0 - part), 0.0, 1.0)
    exact = bottom + stroke * closed_form(law, rise)
    assert_allclose(whole, exact, rtol=0.0, atol=2e-9 * stroke)
    crank = ideal.at(ideal.times).position[:, 3 * press.linkage().index("crank 7") + 2]
    assert np.ptp(crank) < math.pi


@SOME
@given(st.floats(0.05, 0.12), st.floats(4e-3, 7e-3), st.floats(0.3e-3, 1e-3))
def test_the_speed_is_constant_in_the_work(speed, height, end):
    """Polynomials of degree five join it; near 0.04 m/s some curves are out of reach."""
    forming = pw.linkage.Forming(speed=speed, height=height, end=end)
    press = pw.Press(servo=forming)
    ideal = motion_of(press)
    stopping = 2.0 * end / speed
    half = math.pi / W
    slowing = stopping + (height - end) / speed
    top = [forming.stroke, 0.0, 0.0]
    rest = [0.0, 0.0, 0.0]
    curve = BPoly.from_derivatives(
        [-half, -slowing, -stopping, 0.0, half],
        [top, [height, -speed, 0.0], [end, -speed, 0.0], rest, top],
    )
    whole = ideal.at(ideal.times).output(press.linkage())[:, 0]
    time = (ideal.times - forming.bottom / W + half) % (2.0 * half) - half
    assert_allclose(whole - whole.min(), curve(time), rtol=0.0, atol=1e-8)
