"""Figures over the time of a cycle: stroke, response, forces, drives."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given as drawn
from hypothesis import strategies as st
from made_up_result import BOTH, IDEAL, altered, legend_of, made_up, sheet_of
from matplotlib.figure import Figure as Sheet

from presswear.campaign.campaign import run
from presswear.engines.base import Status
from presswear.linkage.drives import Drive, Rise
from presswear.linkage.loads import Blanking
from presswear.linkage.mechanisms import FOUR_BAR
from presswear.recording.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.results.drives import ideal_curves
from presswear.scene.catalog import ideal
from presswear.show.figures import drawings
from presswear.show.figures.drives import within
from presswear.show.figures.motion import Window
from presswear.tools.errors import InputError
from presswear.tools.numbers import readable


def test_the_stroke_is_counted_from_the_ideal_bottom_dead_centre() -> None:
    (axes,) = sheet_of("stroke", made_up(IDEAL, 1)).axes
    *_, ideal = axes.lines
    height = np.asarray(ideal.get_ydata(), dtype=float)
    assert height.min() == pytest.approx(0.0, abs=1e-3)
    assert height.max() == pytest.approx(1e3 * IDEAL.stroke, rel=1e-4)


@pytest.mark.parametrize(
    ("figure", "column", "unit"),
    [("force", "force_max", "N"), ("response", "acceleration_max", "")],
)
def test_the_largest_of_a_panel_is_that_of_its_cycles(figure: str, column: str, unit: str) -> None:
    """Series are thinned: the peak of a cycle need not be in them."""
    result = made_up(IDEAL if figure == "response" else BOTH, 1)
    cycles = result.stages[0].arrays["cycles"]
    cycles[:, (*CYCLE_FIXED, *CYCLE_JOINT).index(column)] = 2000.0, 3000.0
    words = [text.get_text() for axes in sheet_of(figure, result).axes for text in axes.texts]
    assert f"largest 3\u202f000 {unit}" in words[0]


def test_bottoms_are_drawn_stroke_by_stroke_over_the_ideal() -> None:
    """Heights less the ideal one, which is that of the closed form of the press."""
    axes = sheet_of("bottom", made_up(BOTH, 2)).axes
    assert len(axes) == 2
    line = np.asarray(axes[1].get_lines()[0].get_xydata())
    assert line[:, 0].tolist() == [1.0, 2.0]
    assert line[:, 1] == pytest.approx([-712.3459, -812.3459], abs=1e-3)
    assert axes[0].get_ylabel().endswith("less ideal (µm)")
    assert list(drawings(made_up(IDEAL, 1), ["mechanism"]))
    with pytest.raises(InputError, match="nothing to draw as 'bottom'"):
        list(drawings(made_up(IDEAL, 1), ["bottom"]))


@pytest.mark.parametrize(
    ("status", "rows"), [("failed", None), ("completed", 1)], ids=["failed", "too short"]
)
def test_stage_without_motion_is_left_out(status: Status, rows: int | None) -> None:
    result = made_up(BOTH, 2, status)
    arrays = result.stages[1].arrays
    length = arrays["time"].size
    short = {
        name: array[:rows] if len(array) == length else array for name, array in arrays.items()
    }
    result = altered(result, 1, arrays=short)
    assert legend_of(sheet_of("response", result)) == ["ideal", "no wear"]


@pytest.mark.parametrize(
    ("drive", "phase"),
    [
        (Drive("crank", 30.0), "crank angle"),
        (Drive("crank", -30.0), "crank angle"),
        (Drive("crank", 30.0, harmonics=[(0.0, 0.1)]), "phase of the cycle"),
        (Drive("crank", frequency=20.0, rises=[Rise(0.0, 3.0, math.tau)]), "phase of the cycle"),
    ],
)
def test_the_phase_is_a_crank_angle_only_where_a_crank_turns_with_it(
    drive: Drive, phase: str
) -> None:
    linkage = FOUR_BAR.changed(drives=[drive])
    window = Window(0.0, linkage.period, linkage.period, 0.0, linkage.phase, "")
    axes = Sheet().subplots()
    window.label(axes)
    assert axes.get_xlabel() == f"{phase} since the start (degrees)"


def test_short_peaks_leave_the_panels_of_the_drives_and_are_written_there() -> None:
    """A torque of a thousand times the ideal one in a single row of two thousand in a cycle."""
    result = run(replace(ideal(), process=Blanking(), engine="dae", cycles=3))
    (stage,) = result.stages
    exact = ideal_curves(result.scene)["crank 2"].torque
    largest = float(np.abs(exact).max())
    torque = stage.arrays["drive_torque"].copy()
    torque[-100, 0] = -1e3 * largest
    struck = replace(stage, arrays={**stage.arrays, "drive_torque": torque})
    result = replace(result, stages=(struck,))
    (drawing,) = drawings(result, ["drives"])
    axes = drawing.sheet.axes[0]
    low, high = axes.get_ylim()
    assert low < exact.min() < exact.max() < high
    assert high - low < 1.3 * float(np.ptp(exact))
    assert axes.get_title(loc="right") == f"farthest: {readable(-1e3 * largest)} N m"


@drawn(st.floats(0.001, 0.2), st.integers(0, 100))
def test_the_ends_of_most_of_the_time_are_those_of_its_distribution(
    beyond: float, seed: int
) -> None:
    """Of a line from 0 to 1 in steps of any length."""
    time = np.cumsum(np.random.default_rng(seed).uniform(0.0, 2e-4, 10_000))
    time /= time[-1]
    assert within(time, time, beyond) == pytest.approx((beyond, 1.0 - beyond), abs=1e-3)
