"""Initial surfaces of a scene: resampled, stored, read from tables, and bad input."""

import json
import math
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from refusals import refused

from presswear.linkage.guide_corner import WALL_BINS
from presswear.linkage.surface import SIDES, Surface, bin_centres
from presswear.scene.catalog import press_off_centre, wear_times
from presswear.scene.files import read_profiles, scene_from
from presswear.scene.scene import Scene

TURN = 2.0 * math.pi


def on(bearing: Any = None, pin: Any = None, **changes: Any) -> Scene:
    return wear_times(surfaces={"A": (bearing, pin)}, **changes)


def smooth(angle: Any) -> Any:
    return 1e-5 * (1.0 + np.cos(angle - 0.4))


def test_depths_on_the_scenes_own_bins_are_taken_as_they_are():
    depth = np.random.default_rng(3).uniform(0.0, 1e-5, 360)
    points = np.column_stack([bin_centres(360), depth])
    turned = np.roll(points, 77, axis=0) + np.array([TURN, 0.0])
    for side in (depth, Surface(depth), depth.tolist(), points, turned):
        (bearing, pin) = on(side).surfaces["A"]
        assert_allclose(bearing.depth, depth, rtol=0.0, atol=0.0)
        assert pin == Surface()
    joint = on(None, depth).linkage().clearances[0]
    assert (joint.bearing_surface, joint.pin_surface) == (Surface(), Surface(depth))


@settings(deadline=None, max_examples=60)
@given(st.lists(st.floats(0.0, 1e-4), min_size=16, max_size=120), st.integers(16, 400))
def test_the_worn_volume_of_equal_bins_stays(depth, angles):
    if max(depth) == 0.0:
        return
    result = on(depth, angles=angles).surfaces["A"][0].depth
    assert result.size == angles
    assert result.min() >= 0.0
    assert result.max() <= max(depth) * (1.0 + 1e-9)
    assert abs(result.mean() - np.mean(depth)) <= 1e-12 * max(depth)


def test_a_scene_on_given_surfaces_is_stored_and_read_the_same():
    scene = on(smooth(bin_centres(100)), smooth(bin_centres(360)))
    again = Scene.from_dict(json.loads(json.dumps(scene.as_dict())))
    assert again == scene
    assert (
        again.surfaces["A"][0].depth.tobytes() == scene.surfaces["A"][0].depth.tobytes()
    )
    assert scene != wear_times()
    assert on(np.zeros(360), None) == wear_times()
    finer = replace(scene, bearings=replace(scene.bearings, angles=720))
    assert finer.surfaces["A"][1].depth.size == 720


NARROW = np.column_stack([np.linspace(0.0, 6e-5, 90)] * 2)
CLOSED = np.column_stack([np.linspace(0.0, TURN, 91), np.full(91, 1e-6)])


@pytest.mark.parametrize(
    ("surfaces", "message"),
    [
        (5, "surfaces = 5: bearing and pin by joint are expected"),
        ({"B": (None, None)}, "unknown joint in surfaces 'B'; known are A, C"),
        ({"A": np.ones(360)}, "surfaces of A: a pair, bearing and pin, is expected"),
        ({"C": (None, "deep")}, "pin at C: finite depths, or rows of angle and depth"),
        ({"C": (None, [[0.0], [1.0, 2.0]])}, "pin at C: finite depths"),
        (
            {"A": (np.full(360, 0.9e-3), None)},
            "depth 0.9 mm at 0.5 deg: allowed is 0 to 0.8 mm",
        ),
        (
            {"A": (None, np.full(360, -1e-6))},
            "pin at A: depth -0.001 mm at 0.5 deg: allowed is 0",
        ),
        ({"A": (np.full(360, math.nan), None)}, "bearing at A: finite depths"),
        ({"A": (np.ones((3, 3, 3)), None)}, "bearing at A: finite depths"),
        (
            {"A": (np.full(15, 1e-6), None)},
            "bearing at A: 15 angles, none between 12 and 36 deg",
        ),
        (
            {"A": (NARROW, None)},
            "90 angles, none between 0.00343775 and 360 deg; allowed is a gap of 22.5 deg",
        ),
        ({"A": (CLOSED, None)}, "bearing at A: the angle 0 deg occurs twice"),
    ],
)
def test_surfaces_that_do_not_fit_are_refused_in_one_line(surfaces, message):
    with refused(re.escape(message)):
        wear_times(surfaces=surfaces)


FLAT = np.zeros(WALL_BINS)


@pytest.mark.parametrize(
    ("surfaces", "message"),
    [
        (
            {"guide left front": (None, None)},
            "unknown joint in surfaces 'guide left front'; known are guide",
        ),
        ({"guide": FLAT}, "surfaces of guide: a pair, left and right, is expected"),
        (
            {"guide": (None, np.ones(360))},
            "right at guide: 360 depths; allowed are 1000",
        ),
        ({"guide": (FLAT - 1e-6, None)}, "left at guide: depth -0.001 mm in bin 0"),
        ({"guide": (FLAT + 0.6e-3, None)}, "in bin 0: allowed is 0 to 0.5 mm"),
    ],
)
def test_walls_that_do_not_fit_are_refused_in_one_line(surfaces, message):
    with refused(re.escape(message)):
        press_off_centre(surfaces=surfaces)


def test_walls_of_a_scene_are_stored():
    depth = np.linspace(0.0, 1e-5, WALL_BINS)
    scene = press_off_centre(surfaces={"guide": (depth, FLAT)})
    again = Scene.from_dict(json.loads(json.dumps(scene.as_dict())))
    assert again == scene
    corners = again.linkage().corners
    sides = {corner.side: corner.bearing_surface for corner in corners}
    assert np.array_equal(sides[1.0].depth, depth)
    assert not sides[-1.0].is_worn


HEADER = "joint,side,angle (deg),depth (um)"


def table(header: str, rows: Any) -> str:
    return "\n".join([header, *(",".join(map(str, row)) for row in rows)])


def test_a_table_of_profiles_is_read_in_any_unit_and_order(tmp_path):
    angle = np.arange(0.0, 360.0, 4.0)
    depth = 1e6 * smooth(np.radians(angle))
    rows = [(side, *row) for side in SIDES for row in zip(angle, depth, strict=True)]
    first = table(f"# of a roundness tester\n{HEADER}", [("A", *row) for row in rows])
    turned = [(1e-3 * d, "A", np.radians(a), side) for side, a, d in rows[::-1]]
    second = table('"depth [mm]", joint ,angle rad,side', turned)
    result = []
    for name, text in (("one.csv", first), ("two.csv", second)):
        (tmp_path / name).write_text(text)
        result.append(wear_times(surfaces=read_profiles(tmp_path / name)).surfaces["A"])
    for one, other in zip(*result, strict=True):
        assert_allclose(one.depth, other.depth, rtol=1e-12)
        assert_allclose(one.depth, smooth(bin_centres(360)), rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", ": it has no rows; a header such as joint,side,angle (deg),depth (um)"),
        (HEADER, ": it has no rows"),
        ("joint,side,angle,depth (um)\nA,pin,5,1", ", line 2: angle = '5' has no unit"),
        (
            "joint,side,angle (turn),depth (um)\nA,pin,0,1",
            "line 2: angle = '0 turn': unknown unit",
        ),
        ("joint,side,angle (deg)\nA,pin,0", ": columns joint, side, angle: a header"),
        (
            "joint,side,side,angle (deg),depth (um)\nA,pin,pin,0,1",
            ": columns joint, side, side, a",
        ),
        (f"{HEADER}\nA,pin,0", ", line 2: 3 values for 4 columns"),
        (
            f"{HEADER}\nA,pin,0,1\n\nA,bearng,0,1",
            ", line 4: unknown side 'bearng'; did you mean",
        ),
        (f"{HEADER}\nA,pin,0,deep", ", line 2: depth = 'deep um' is not a number"),
    ],
)
def test_a_wrong_table_is_refused(text, says, tmp_path):
    file = tmp_path / "worn.csv"
    file.write_text(text)
    with refused(re.escape(f"{file}") + ".*" + re.escape(says)):
        read_profiles(file)
    with refused(r"no such file; did you mean worn\.csv\?"):
        read_profiles(tmp_path / "wron.csv")


def test_a_file_of_a_scene_may_name_a_table(tmp_path):
    angle = np.arange(0.0, 360.0, 5.0)
    rows = [("C", "bearing", a, 3.0) for a in angle]
    (tmp_path / "worn.csv").write_text(table(HEADER, rows))
    file = tmp_path / "mine.toml"
    text = 'mechanism = "press"\nsurfaces = "worn.csv"\n[settings]\njoints = "AC"\n'
    file.write_text(text)
    scene = scene_from(file)
    assert_allclose(scene.surfaces["C"][0].depth, 3e-6, rtol=1e-12)
    assert scene.origins["surfaces"] == "worn.csv"
    for wrong, says in (
        (
            text.replace("worn.csv", "worn"),
            "surfaces = 'worn': a name that ends in .csv",
        ),
        (text.replace('"AC"', '"A"'), "worn.csv: unknown joint in surfaces 'C'"),
        (
            f'{text}clearance = "0.2 um"\n',
            "worn.csv: bearing at C: depth 0.003 mm at 0 deg",
        ),
    ):
        file.write_text(wrong)
        with refused(f"^{re.escape(str(file))}: {re.escape(says)}"):
            scene_from(file)
