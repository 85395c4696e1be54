"""Running-in: the flow of its differential equation, in any number of blocks."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import presswear as pw
from presswear.physics.running_in import (
    RunningIn,
    archard_depth,
    depth_laws_of,
    worn_off,
)
from presswear.tools.errors import InputError

NEW = np.zeros(1)


@pytest.mark.parametrize("ratio", [0.05, 0.5, 1.0, 3.0, 1000.0])
def test_depth_is_the_solution_of_the_equation_in_any_number_of_blocks(
    ratio,
):
    law = RunningIn(ratio, 0.7e-6)
    archard = 2e-6

    def rate(_: float, depth: np.ndarray) -> np.ndarray:
        return 1.0 + (ratio - 1.0) * np.exp(-depth / law.depth)

    options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-18, "first_step": 1e-12}
    expected = solve_ivp(rate, (0.0, archard), NEW, **options).y[:, -1]
    for blocks in (1, 7, 1000):
        depth = NEW
        for _ in range(blocks):
            depth = depth + law.worn(depth, np.array([archard / blocks]))
        assert depth == pytest.approx(expected, rel=1e-9)
        assert law.archard_depth(depth) == pytest.approx(archard, rel=1e-9)


def test_bumps_wear_as_new_surfaces():
    law = RunningIn(0.2, 1e-6)
    added = np.array([1e-9])
    assert law.worn(np.array([-5e-6]), added) == pytest.approx(0.2e-9, rel=1e-3)


def test_each_side_of_each_joint_runs_in_by_its_depth():
    law = RunningIn(10.0, 1e-6)
    depth = np.zeros((2, 2, 3))
    depth[0, 1] = [0.0, 1e-6, 1e-3]
    added = np.full(depth.shape, 1e-12)
    worn = worn_off((law, None), depth, added)
    np.testing.assert_array_equal(worn[1], added[1])
    assert worn[0, 0] == pytest.approx(1e-11, rel=1e-4)
    expected = 1e-12 * (1.0 + 9.0 * np.exp([0.0, -1.0, -1e3]))
    assert worn[0, 1] == pytest.approx(expected, rel=1e-4)
    assert worn_off((None, None), depth, added) is added
    assert archard_depth((None, None), depth) is depth


def test_settings_of_running_in():
    """Its depth is the roughness where none is given, and is read only with a ratio."""
    (joint,) = pw.scenes.slider_crank().linkage().clearances
    assert depth_laws_of([joint]) == (None,)
    scene = pw.scenes.slider_crank(running_in=30.0, roughness="0.8 um")
    (joint,) = scene.linkage().clearances
    assert depth_laws_of([joint]) == (RunningIn(30.0, 0.8e-6),)
    assert "roughness" not in scene.bearing("B").unread
    scene = pw.scenes.slider_crank(running_in=30.0, running_in_depth="2 um")
    (joint,) = scene.linkage().clearances
    assert depth_laws_of([joint]) == (RunningIn(30.0, 2e-6),)
    assert "roughness" in scene.bearing("B").unread
    assert "running_in_depth" in pw.scenes.slider_crank().bearing("B").unread


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("running_in", 0.0, "running_in = 0: allowed is 0.01 to 10000"),
        ("running_in", 2e4, "running_in = 20000: allowed is 0.01 to 10000"),
        (
            "running_in_depth",
            "2 mm",
            "running_in_depth = 2 mm: allowed is 1e-06 to 1 mm",
        ),
        ("running_in_depth", "2 s", "running_in_depth"),
    ],
)
def test_bad_settings_are_refused(key, value, message):
    with pytest.raises(InputError, match=message):
        pw.scenes.slider_crank(**{"running_in": 10.0} | {key: value})
