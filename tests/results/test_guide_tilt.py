"""Tilt of a slide in its guide: closed forms, and each number by another path."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import io
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from refusals import refused
from rich.console import Console
from upright_press import upright_crank

import presswear as pw
from presswear.cli.run_observer import RunObserver
from presswear.cli.terminal import progress_bar
from presswear.linkage.guide_corner import CORNERS, largest_tilt
from presswear.results.corners import corner_paths, tilt_series
from presswear.results.guide_tilt import (
    _load_of,
    guide_tilts,
    self_locking,
)
from presswear.show.limits import limit_lines
from presswear.show.stage_tables import stage_tables
from presswear.show.warnings import warnings

L = 0.4
C = 0.05e-3
FORCE = 100e3
OFFSET = 0.06


def press(offset: float = OFFSET, friction: float = 0.1) -> pw.Scene:
    """Upright press of 100 kN that cuts beside the middle of its slide."""
    crank = upright_crank(guide_length=L, guide_width=0.3)
    bearing = pw.Bearing(C, width=0.1, friction=friction, restitution=0.8)
    sheet = pw.Blanking(
        force=FORCE, height=5e-3, thickness=3e-3, rise=0.2e-3, snap=0.15e-3
    )
    process = replace(sheet, offset=offset)
    return pw.Scene(
        crank,
        bearings={"guide": bearing},
        process=process,
        wear_updates=0,
        cycles=2,
    )


@pytest.fixture(scope="module")
def result():
    return pw.run(press())


@pytest.fixture(scope="module")
def tilt(result):
    return guide_tilts(result.scene, result.stages[0])["guide"]


def test_two_opposite_corners_hold_the_work_at_the_fracture(result, tilt):
    """Each corner sinks in by F a / (L K), which adds to the clearance: 2 (c + d) / L."""
    (corner, *_) = result.scene.linkage().corners
    depth = FORCE * OFFSET / L / corner.normal.stiffness
    assert tilt.fracture.mean == pytest.approx(2.0 * (C + depth) / L, rel=5e-3)


def test_tilts_are_those_of_the_film(result, tilt):
    """The film has the angle of the slide, 500 times in a cycle."""
    stage = result.stages[0]
    (guide,) = result.scene.loose_guides
    film = stage.film
    column = 3 * result.scene.linkage().index(guide.body) + 2
    angle = film.position[:, column] - guide.angle
    rows = np.interp(film.time, stage.time, tilt_series(stage, guide))
    assert np.abs(angle).max() > 2e-4
    assert rows == pytest.approx(angle, abs=2e-6)
    strokes = result.strokes(0)
    for name, instant in (("touch", "contact"), ("fracture", "fracture")):
        # The only complete stroke begins half a turn after the start.
        time = getattr(strokes, instant)[0, 0]
        after = int(np.searchsorted(film.time, time))
        low, high = np.sort(np.abs(angle[after - 1 : after + 1]))
        # The slide rattles from wall to wall between two frames.
        assert low - 5e-6 < getattr(tilt, name).mean < high + 5e-6
    whole = (film.time > 0.5) & (film.time < 1.5)
    assert tilt.greatest.mean >= np.abs(angle[whole]).max() - 1e-7


def test_the_friction_loss_is_that_of_the_energy_balance(result, tilt):
    """Only the second cycle is sampled. Without wear the loss comes from the series."""
    stage = result.stages[0]
    corners = [stage.joints[f"guide {corner}"] for corner in CORNERS]
    loads = [_load_of(stage.time, corner, 0.1) for corner in corners]
    total: Any = stage.diagnostics["friction_loss_J"]
    assert sum(load.loss(0.0, 2.0) for load in loads) == pytest.approx(total, rel=0.01)
    second = sum(load.loss(1.0, 2.0) for load in loads)
    assert tilt.friction_loss.mean == pytest.approx(second, rel=0.01)


def test_shares_and_corner_force_by_the_rows(result, tilt):
    stage = result.stages[0]
    joints = [stage.joints[f"guide {corner}"] for corner in CORNERS]
    for shares in (tilt.time_shares, tilt.load_shares):
        assert sum(share.mean for share in shares.values()) == pytest.approx(1.0)
    rows = (stage.time >= 0.5) & (stage.time <= 1.5)
    time = stage.time[rows]
    left_front, left_back, right_front, right_back = (
        joint.penetration[rows] > 0.0 for joint in joints
    )
    is_opposite = (left_front & right_back) | (left_back & right_front)
    opposite = is_opposite.astype(float)
    share = float(np.trapezoid(opposite, time)) / (time[-1] - time[0])
    name = "two opposite corners"
    assert tilt.time_shares[name].mean == pytest.approx(share, abs=2e-3)
    load = np.sum([joint.force[rows, 0] for joint in joints], axis=0)
    part = np.trapezoid(opposite * load, time) / np.trapezoid(load, time)
    assert tilt.load_shares[name].mean == pytest.approx(float(part), abs=0.03)
    peaks = [joint.each_cycle("force_max") for joint in joints]
    assert tilt.corner_force.mean == pytest.approx(np.max(peaks, axis=0)[-1])


def test_the_report_has_the_tilt(result):
    lines = limit_lines(result.scene, result.stages[0])
    (line,) = [line for line in lines if line.number.name == "Tilt of the slide"]
    assert (line.limit, line.verdict.word) == ("50 µm/m", "above the limit")
    jams = replace(result, scene=press(offset=1.0, friction=0.21))
    assert any("self-locking" in line for line in warnings(jams))
    assert not any("self-locking" in line for line in warnings(result))


def test_the_walls_wear_by_the_load_distance_of_their_corners(result):
    """Worn volume is K_d times the load distance; the slide tilts to one side."""
    stage = result.stages[0]
    (guide,) = result.scene.loose_guides
    walls = stage.statistics.walls["guide"]
    coefficient = result.scene.bearing("guide").materials.wear_coefficient
    place, depth = stage.wall_wear("guide")
    area = 0.1 * (place[1] - place[0])
    for side, depth_of_side in zip(("left", "right"), depth, strict=True):
        corners = [stage.joints[f"guide {side} {end}"] for end in ("front", "back")]
        # Only the second cycle is sampled.
        load = sum(corner.each_cycle("load_distance")[-1] for corner in corners)
        volume = walls[side].volume_per_cycle.mean
        assert volume == pytest.approx(coefficient * load, rel=1e-9)
        assert area * depth_of_side.sum() == pytest.approx(volume, rel=1e-12)
        assert walls[side].depth_per_cycle.mean == depth_of_side.max() > 0.0
        assert walls[side].place == place[depth_of_side.argmax()]
    # The work presses the slide into two opposite corners at the bottom of the stroke.
    bottom = -0.64 - guide.y
    assert walls["left"].place == pytest.approx(bottom + 0.5 * L, abs=0.01)
    assert walls["right"].place == pytest.approx(bottom - 0.5 * L, abs=0.01)


def test_printed_stages_have_the_wear_of_the_walls(result):
    stage = result.stages[0]
    walls = stage.statistics.walls["guide"]
    console = Console(file=io.StringIO(), width=200)
    RunObserver(progress_bar(console), result.scene).on_stage(stage)
    assert isinstance(console.file, io.StringIO)
    lines = console.file.getvalue().splitlines()
    (line,) = [line for line in lines if "wear per" in line]
    for side in ("left", "right"):
        volume = walls[side].volume_per_cycle.scaled(1e15)
        assert f"{side} wall of guide {volume}" in line
    assert "guide left front" not in line


def test_the_report_has_the_wear_of_the_walls(result):
    table = f"{stage_tables(result)['guide']}"
    assert "deepest wear of the left wall per million strokes" in table
    place, depth = result.stages[0].wall_wear("guide")
    (axes,) = result.plot("walls")
    for line, depth_of_side in zip(axes.lines, depth, strict=True):
        assert np.asarray(line.get_xdata()) == pytest.approx(1e3 * place)
        assert np.asarray(line.get_ydata()) == pytest.approx(1e12 * depth_of_side)
    with refused("slide"):
        result.stages[0].wall_wear("slide")


def test_figures_have_the_tilt_and_the_paths_between_the_walls(result):
    stage = result.stages[0]
    (guide,) = result.scene.loose_guides
    assert largest_tilt(guide, C) == pytest.approx(2.500234445e-4, rel=1e-9)
    axes = result.plot("tilt")[0]  # the second panel shows the working zone
    time, tilt = axes.lines[0].get_data()
    series = 1e6 * tilt_series(stage, guide)
    assert tilt == pytest.approx(np.interp(np.asarray(time), stage.time, series))
    lines = [np.asarray(line.get_ydata()) for line in axes.lines]
    levels = {round(float(line[0]), 6) for line in lines if line.size == 2}
    assert levels == {-250.023445, -50.0, 50.0, 250.023445}
    front, back = result.plot("corners")
    paths = corner_paths(stage, guide)
    assert (paths["left front"] - paths["left back"]) / L == pytest.approx(
        1e-6 * series
    )
    for panel, corner in ((front, "left front"), (back, "left back")):
        drawn = [np.asarray(line.get_xdata()) for line in panel.lines]
        path = -1e6 * paths[corner]
        assert drawn[0].size > 1000
        assert np.isin(drawn[0], path).all()
        walls = sorted(float(line[0]) for line in drawn if line.size == 2)
        assert walls == pytest.approx([-50.0, 50.0])
    ideal = replace(result, scene=replace(result.scene, joints="none", bearings={}))
    with refused("nothing to draw"):
        ideal.plot("tilt")


def test_self_locking_from_half_the_length_over_the_offset():
    assert self_locking(press()) == {}
    assert self_locking(press(offset=1.0, friction=0.19)) == {}
    limits = self_locking(press(offset=-1.0, friction=0.21))
    assert limits["guide"] == pytest.approx((0.21, 0.2))
