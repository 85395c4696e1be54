"""Quantities of a service life, and limits and services as they are read."""
# mypy: disable-error-code="union-attr,operator"

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from refusals import refused

import presswear as pw
from presswear.campaign.life_quantities import (
    levels_of,
    pseudo_levels_of,
    samples_of,
)
from presswear.physics.dead_centre import bottom_of
from presswear.physics.wear import map_shape
from presswear.recording.columns import cycle_column, cycle_columns
from presswear.scene.options import LIFE_QUANTITIES, NEW_OVER_CLEARANCE, Service


def test_quantities_of_surfaces_and_strokes():
    scene = pw.scenes.press_blanking(conventions="refined", replicates=2)
    joints = scene.linkage().clearances
    worn = np.zeros((2, *map_shape(joints)))
    worn[0, 0, 1, 7] = 3e-6  # the pin of A in one bin
    worn[1, 1, 0, :] = 1e-6  # the bearing of C all around
    levels = levels_of(scene, worn, tuple(LIFE_QUANTITIES))
    assert levels["A.depth"].tolist() == [3e-6, 0.0]
    assert levels["C.depth"].tolist() == [0.0, 1e-6]
    around = 2.0 * np.pi * joints[1].bearing_radius * joints[1].width * 1e-6
    assert levels["C.wear_volume"][1] == pytest.approx(around, rel=1e-12, abs=0.0)
    ideal = bottom_of(scene.ideal)
    rows = np.zeros((2, 4, cycle_columns(2, 0)))
    off = np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 5.0, 5.0, 5.0]])
    rows[:, :, cycle_column("bottom_height")] = ideal.height + off
    column = cycle_column("force_max", 1)
    rows[0, :, column] = 10.0, 20.0, 30.0, 40.0
    samples = samples_of(scene, rows)
    assert samples["bdc_error"] == pytest.approx([2.5, 5.0])
    assert samples["bdc_drift"] == pytest.approx([2.5, 5.0])
    assert samples["repeatability"] == pytest.approx([5.0 / 3.0, 0.0])
    assert samples["C.force_max"].tolist() == [25.0, 0.0]
    single = samples_of(scene, rows[:, :1])  # 1 and 5: a history wore out
    assert single["repeatability"] == pytest.approx([8.0, 8.0])
    assert samples["A.force_max"].tolist() == [0.0, 0.0]
    names = {name.partition(".")[2] or name for name in (*levels, *samples)}
    press = pw.scenes.press_off_centre()
    corners = press.linkage().clearances
    flat = np.zeros((1, *map_shape(corners)))
    names |= {"tilt"}  # of guides
    assert names == LIFE_QUANTITIES.keys()
    levels = levels_of(press, flat, tuple(LIFE_QUANTITIES))
    of_guides = [
        f"guide.{key}" for key, one in LIFE_QUANTITIES.items() if "guide" in one.kinds
    ]
    strokes = np.zeros((1, 2, cycle_columns(len(corners), 1)))
    strokes[0, :, cycle_column("force_max", 0)] = 10.0
    strokes[0, 1, cycle_column("force_max", 2)] = 30.0
    samples = samples_of(press, strokes)
    assert samples["guide.force_max"] == 20.0  # of the corner that presses most
    assert {*of_guides, "total_clearance"} == {*levels, "guide.force_max"}


def test_noise_of_the_maps_hardly_makes_the_deepest_place_deeper():
    """Each of eight maps has an even noise of a tenth of its depth in 120 places."""
    scene = pw.scenes.press_blanking(conventions="refined", replicates=8)
    draw = np.random.default_rng(4)
    shape = map_shape(scene.linkage().clearances)
    groove = np.exp(-((np.arange(shape[-1]) - 40.0) ** 2) / 200.0)
    excess = []
    for _ in range(40):
        factors = 1.0 + 0.1 * draw.uniform(-1.0, 1.0, (8, *shape))
        depth = 1e-5 * groove * factors
        pseudo = pseudo_levels_of(scene, depth, ())["A.depth"]
        plain = levels_of(scene, depth, ())["A.depth"]
        excess.append([pseudo.mean() / 1e-5 - 1.0, plain.mean() / 1e-5 - 1.0])
        of_mean_volume = pseudo_levels_of(scene, depth, ())["A.wear_volume"]
        of_volumes = levels_of(scene, depth, ())["A.wear_volume"]
        np.testing.assert_allclose(of_mean_volume, of_volumes, rtol=1e-12)
    of_mean, of_each = np.mean(excess, axis=0)
    assert abs(of_mean) < 0.02 < 0.05 < of_each


JOINTS = {"A": 1e-4, "B": 2e-4}


@given(
    st.sampled_from(sorted(LIFE_QUANTITIES.keys() - {"tilt"})),  # of guides
    st.sampled_from(("", *JOINTS)),
    st.floats(1e-9, 1e6),
    st.text(" ", max_size=3),
)
def test_limits_are_read(name, joint, value, blank):
    unit, of_joint, *_ = LIFE_QUANTITIES[name]
    text = f"{blank}{joint + '.' if joint else ''}{name}{blank}>{blank}{value!r} {unit}{blank}"
    if joint and not of_joint:
        with refused("is of the whole mechanism"):
            pw.Life(until=text).limits(JOINTS, {})
        return
    if name in NEW_OVER_CLEARANCE and value <= NEW_OVER_CLEARANCE[name] * max(
        JOINTS.values()
    ):
        return
    limits = pw.Life(until=text).limits(JOINTS, {})
    joints = [joint] if joint else list(JOINTS) if of_joint else [""]
    assert [(limit.joint, limit.value) for limit in limits] == [
        (each, value) for each in joints
    ]


def test_limits_in_the_words_of_makers():
    text = "A.clearance >= 0.30 mm, diametral_clearance > 2.5 x new, B.radial_clearance > 3×new"
    limits = pw.Life(until=text).limits(JOINTS, {})
    assert [limit.key for limit in limits] == [
        "A.radial_clearance",
        "A.diametral_clearance",
        "B.diametral_clearance",
        "B.radial_clearance",
    ]
    values = [limit.value for limit in limits]
    assert values == pytest.approx([0.3e-3, 2.5 * 2e-4, 2.5 * 4e-4, 3 * 2e-4])


def test_services_are_read_in_the_order_of_strokes():
    life = pw.Life(replaced="A@2e6, B@4e6", rotated=" B@1e6")
    expected = [
        Service("B", 1e6, True),
        Service("A", 2e6, False),
        Service("B", 4e6, False),
    ]
    assert list(life.services(tuple(JOINTS), ())) == expected


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"until": "depth 5 um"}, "NAME > VALUE is expected"),
        ({"until": "A.depth > 0,3 mm"}, r"use a decimal point, '0\.3'"),
        ({"until": "dept > 5 um"}, "did you mean depth"),
        ({"until": "D.depth > 5 um"}, "joint with clearance in until"),
        (
            {"until": "A.diametral_clearance > 0.19 mm"},
            "allowed is above 0.2 mm, that of the new joint",
        ),
        ({"until": "A.clearance > 0.9 x new"}, "until: radial_clearance"),
        ({"until": "A.clearance > 1 mm 2 x new"}, "VALUE x new is expected"),
        ({"until": "A.play > 1 mm"}, "The radial play of a pin is its clearance"),
        ({"until": "A.depth > 2 x new"}, "'x new' is allowed for clearance, radial_c"),
        (
            {"replaced": "A2e6"},
            r"replaced = 'A2e6': JOINT@STROKES is expected, such as",
        ),
        ({"rotated": "C@2e6"}, "joint with clearance in rotated"),
        ({"replaced": "A@2e6", "at_most": 1e6}, "allowed is below at_most = 1e"),
    ],
)
def test_bad_lives_are_refused(settings, message):
    life = pw.Life(**settings)
    with refused(message):
        life.limits(JOINTS, {}) and life.services(tuple(JOINTS), ())
