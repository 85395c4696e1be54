"""Statistics of bottom dead centre: of known strokes, of the press, and with stiffer joints."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import stiff_joints

from presswear.campaign.bottom_statistics import bottom_statistics, equal_bottoms
from presswear.campaign.runs import run
from presswear.linkage.bodies import Bar, Body
from presswear.linkage.drives import Drive
from presswear.linkage.joints import Guide, Pin
from presswear.linkage.linkage import assemble
from presswear.linkage.press import GEOMETRIES, Press
from presswear.linkage.servos import Dwell
from presswear.physics.dead_centre import bottom_of
from presswear.recording.statistics import STARTUP_CYCLES, pooled
from presswear.results.bottom_dead_centre import bottom_errors, rise
from presswear.scene.catalog import ideal, wear_times
from presswear.scene.scene import Scene
from presswear.show.stage_tables import stage_tables


def strokes_of(scene: Scene, seed: int, off: float = 0.0, scatter: float = 4e-5) -> Any:
    """Return a recorder of twelve strokes about 0.7 mm too low, 2 ms early."""
    draw = np.random.default_rng(seed)
    bottom = bottom_of(scene.ideal)
    height = bottom.height - 7e-4 + off + scatter * draw.normal(size=12)
    time = bottom.time - 2e-3 + 1e-3 * draw.normal(size=12)
    time += scene.run_up + scene.mechanism.period * np.arange(12)
    rows = {"bottom_height": height, "bottom_time": time}
    return SimpleNamespace(
        height=height, cycles=height, each_cycle=lambda name, joint=None: rows[name]
    )


def test_statistics_of_known_strokes():
    scene = wear_times()
    runs = [strokes_of(scene, seed) for seed in range(4)]
    statistics = bottom_statistics(scene, runs)
    bottom = bottom_of(scene.ideal)
    samples = np.array([run.height[STARTUP_CYCLES:] for run in runs])
    assert statistics.strokes == samples.size == 40
    expected = pooled([run.height - bottom.height for run in runs])[0]
    assert statistics.error.mean == pytest.approx(expected.mean, rel=1e-9)
    assert statistics.error.half_width == pytest.approx(expected.half_width, rel=1e-9)
    assert statistics.error.mean == pytest.approx(-7e-4, abs=3e-5)
    assert statistics.height.mean == pytest.approx(samples.mean(), rel=1e-12)
    scatter = statistics.standard_deviation
    delay = statistics.delay
    assert scatter.mean == pytest.approx(np.sqrt(np.mean(samples.var(axis=1, ddof=1))))
    assert scatter.low < 4e-5 < scatter.high
    assert statistics.range_strokes == 10
    assert statistics.range.mean == pytest.approx(np.ptp(samples, axis=1).mean())
    assert statistics.range_of_all == pytest.approx(np.ptp(samples))
    assert delay.mean == pytest.approx(-2e-3, abs=5e-4)
    turn = statistics.delay_angle.mean / delay.mean
    assert turn == pytest.approx(2.0 * np.pi / scene.mechanism.period)
    assert statistics.delay_standard_deviation.mean == pytest.approx(1e-3, rel=0.4)


def test_independent_replicates_widen_the_mean_and_not_the_scatter():
    """Differences between machines do not change the repeatability of each of them."""
    scene = wear_times()
    alone = [strokes_of(scene, seed, 3e-4 * seed) for seed in range(4)]
    together = [strokes_of(scene, seed) for seed in range(4)]
    close, wide = (bottom_statistics(scene, together, runs) for runs in ((), alone))
    assert wide.error.half_width > 5.0 * close.error.half_width
    scatters = (
        each.standard_deviation for each in (close, bottom_statistics(scene, alone))
    )
    first, second = scatters
    assert second.mean == pytest.approx(first.mean, rel=1e-9)


@pytest.mark.parametrize("geometry", list(GEOMETRIES))
def test_ideal_press_is_accurate_and_repeats_itself(geometry):
    """The first bottom of the swapped one lies before the start: one cycle has no stroke."""
    scene = replace(
        ideal(), mechanism=Press(geometry=GEOMETRIES[geometry]), engine="dae", cycles=4
    )
    stage = run(scene).stages[0]
    assert stage.bdc.strokes == 2
    assert abs(stage.bdc.error.mean) < 1e-12
    assert stage.bdc.range_of_all < 1e-12
    assert abs(stage.bdc.delay.mean) < 1e-10
    (strokes,) = bottom_errors(scene, stage)
    assert strokes[0].tolist() == ([2, 3, 4] if geometry == "swapped" else [1, 2, 3, 4])
    assert np.abs(strokes[1]).max() < 1e-12
    alone = run(replace(scene, cycles=1)).stages[0]
    assert (alone.statistics.bdc is None) == (geometry == "swapped")


def test_output_at_rest_has_no_bottom():
    linkage = assemble(
        bodies=[Bar("bar", length=0.2, mass=1.0)],
        joints=[Pin("O", (0.0, 0.0), "bar.centre")],
        drives=[Drive("bar", speed=5.0)],
    )
    stage = run(
        Scene(mechanism=linkage, wear_updates=0, cycles=2, engine="dae")
    ).stages[0]
    assert stage.statistics.bdc is None
    assert rise(stage, stage) is None
    assert bottom_errors(Scene(mechanism=linkage, wear_updates=0), stage) == []


@pytest.mark.parametrize("part", [0.04, 1.0 / 9.0])
@pytest.mark.parametrize("cycles", [1, 4])
def test_dwell_at_the_bottom_has_no_delay(part, cycles):
    """The ideal slider rests there for that part of a cycle: no instant of it is the bottom."""
    press = Press(servo=Dwell(part=part))
    scene = replace(ideal(), mechanism=press, engine="dae", cycles=cycles)
    bdc = run(scene).stages[0].bdc
    assert bdc.delay is None
    # It leaves slowly, and is examined 1440 times in a cycle.
    assert part - 2.0 / 1440.0 < bdc.ideal_dwell / press.period < part + 0.01
    plain = run(replace(scene, mechanism=Press())).stages[0].bdc
    assert plain.delay is not None
    assert plain.ideal_dwell < 0.002 * press.period


def knuckle_press() -> Scene:
    """Knuckle-joint press of 630 t: two equal bottoms 24.24 degrees apart, 13.63 um between them.

    The bottoms are where rocker and link are in line; numbers by exact kinematics.
    """
    long = {"rod": 0.92, "rocker": 0.83, "link": 0.83}
    linkage = assemble(
        bodies=[
            Bar("crank", length=0.1875, mass=100.0),
            *(Bar(name, length=length, mass=200.0) for name, length in long.items()),
            Body("slide", mass=2000.0),
        ],
        joints=[
            Pin("O", (0.0, 0.0), "crank.tail"),
            Pin("A", "crank.head", "rod.tail"),
            Pin("B", "rod.head", "rocker.head"),
            Pin("C", (0.73, 0.7375), "rocker.tail"),
            Pin("D", "rocker.head", "link.tail"),
            Pin("E", "link.head", "slide"),
            Guide("guide", "slide", x=0.73, direction=np.pi / 2.0),
        ],
        drives=[Drive("crank", speed=np.pi)],
        guess={"rod": 0.0, "rocker": -np.pi / 2.0, "link": -np.pi / 2.0},
        output="slide",
    )
    return Scene(linkage, joints="E", wear_updates=0, cycles=5, engine="dae")


def test_stroke_with_two_equal_bottoms_has_no_delay():
    scene = knuckle_press()
    bottom = bottom_of(scene.ideal)
    degrees = 360.0 / scene.mechanism.period
    (first, height), (second, other) = bottom.minima
    assert degrees * (second - first) == pytest.approx(24.24, abs=0.01)
    assert (height, other) == pytest.approx((-0.9225, -0.9225), abs=1e-12)
    between = np.linspace(first, second, 1001)
    places = scene.ideal.at(between).output(scene.base_linkage)[:, 0]
    assert places.max() - height == pytest.approx(13.63e-6, abs=5e-9)
    # Each stroke of a run is lowest at one of them, by chance or by clearance and
    # loads.
    bdc = bottom_statistics(scene, [strokes_of(scene, 1, scatter=1e-6)])
    assert bdc.equal_bottoms == pytest.approx((first, second))
    assert bdc.delay is bdc.delay_angle is bdc.delay_standard_deviation is None


def test_bottoms_that_are_told_apart_leave_the_delay():
    bottom = bottom_of(knuckle_press().ideal)
    assert bottom is not None
    (first, height), (second, _) = bottom.minima
    apart = replace(
        bottom, time=first, minima=((first, height), (second, height + 2e-6))
    )
    near_first = np.full(9, 1e-3)
    near_second = np.full(9, second - first + 1e-3)
    assert equal_bottoms(apart, near_first, 1e-6) == ()
    assert equal_bottoms(apart, near_first, 3e-6) == (first, second)
    # Clearance can make the higher bottom the lower one.
    assert equal_bottoms(apart, near_second, 1e-6) == (first, second)


def test_two_equal_bottoms_are_named_in_the_report():
    scene = knuckle_press()
    result = run(scene)
    assert result.stages[0].bdc.delay is None
    named = "at 160.66 and 184.90 degrees of crank angle since the start (892.54 and 1027.22 ms)"
    table = stage_tables(result)["bottom"]
    rows = {row[0]: row for _, group in table.groups for row in group}
    assert not any(name.startswith("delay") for name in rows)
    assert rows["equal bottoms of the ideal stroke"][1] == named


@pytest.mark.slow
def test_a_stiff_joint_becomes_ideal_in_every_figure(capsys):
    """Places with order 1; forces and torques with about 1/2, the half power of a gap that opens.

    Where a joint's force passes zero at an even rate a pin crosses its clearance c in a
    time of c^(1/3) and arrives with c^(2/3); such an impact is of c^(4/5) K^(2/5), here
    c^(1/2).
    """
    stiff_joints.main()
    rows = [re.split(r"  +", line) for line in capsys.readouterr().out.splitlines()]
    found = {row[0]: [float(value) for value in row[1:]] for row in rows}
    assert len(found) == 10
    for name, (*values, order) in found.items():
        lowest, highest = (0.95, 1.05) if name.endswith("(m)") else (0.1, 1.1)
        assert lowest < order < highest, name
        assert values[-1] < 0.5 * values[0], name
