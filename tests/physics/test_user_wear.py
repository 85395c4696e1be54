"""User wear laws: against Archard's law, the built-in laws and an independent integrator."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bush import COEFFICIENT, bush, worn
from marks import slow
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

import presswear as pw
from presswear.linkage.materials import Materials
from presswear.linkage.wear_law import WearLaw
from presswear.physics.user_wear import UserWear
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction

LAWS = """
import math

def constant(coefficient):
    return coefficient

def fading(depth, coefficient):
    return coefficient * (1.0 + 29.0 * math.exp(-depth / 0.7e-6))

def aged(load_distance, coefficient):
    return coefficient * (1.0 + 4.0 / (1.0 + load_distance / 3e8))

def both(depth, load_distance, coefficient):
    return coefficient * (1.0 + math.exp(-depth / 1e-6) + 1.0 / (1.0 + load_distance / 1e9))

def jumps(depth, coefficient):
    return coefficient * (2.0 if depth < 1e-6 else 0.5)

def power(pressure, coefficient):
    return coefficient * (pressure / 10e6) ** 0.7

def square(pressure, coefficient):
    return coefficient * pressure / 1e5

def steady(pressure, coefficient):
    return coefficient * (pressure / pressure)

def product(depth, pressure, coefficient):
    return coefficient * (pressure / 10e6) ** 0.7 * (1.0 + 19.0 * math.exp(-depth / 6e-6))

def total(depth, pressure, coefficient):
    return coefficient * (1.0 + depth / 1e-6 + pressure / 1e6)

def three(load_distance, pressure, coefficient):
    return coefficient

def negative(depth, coefficient):
    return coefficient * (1.0 - depth / 1e-6)
"""


def law(name: str) -> UserFunction:
    return UserFunction(name, LAWS).trusted()


def user_wear(name: str, share: float = 0.5) -> UserWear:
    return UserWear(WearLaw(1e-15, bearing_share=share, user_law=law(name)))


def both_sides(*depths: float) -> Array:
    return np.array([depths, depths])


@pytest.mark.parametrize("name", ["fading", "aged", "both", "jumps"])
@pytest.mark.parametrize("share", [0.5, 0.2])
def test_depth_is_the_solution_in_any_number_of_blocks(name, share):
    ours = user_wear(name, share)
    function = law(name).in_python()
    used = law(name).parameters("law", ("depth", "load_distance", "coefficient"))
    shares = share, 1.0 - share
    archard = both_sides(3e-6)
    expected = []
    for one in shares:

        def rate(x: float, depth: Array, one: float = one) -> Any:
            state = {
                "depth": float(depth[0]),
                "load_distance": x / (one * 1e-15),
                "coefficient": 1e-15,
            }
            return function(**{key: state[key] for key in used}) / 1e-15

        options = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-18}
        flow = solve_ivp(rate, (0.0, 3e-6), [0.0], max_step=1e-8, **options)
        expected.append(flow.y[:, -1])
    bound = 3e-3 if name == "jumps" else 1e-10  # of SciPy's steps over the jump
    for blocks in (1, 7, 100):
        depth = np.zeros((2, 1))
        for _ in range(blocks):
            depth = depth + ours.worn(depth, archard / blocks)
        assert_allclose(depth, expected, rtol=bound)
        assert_allclose(ours.archard_depth(depth), archard, rtol=1e-9)


@pytest.mark.parametrize(
    "engine",
    ["dae", "exudyn-tree", slow("exudyn-joints")],
)
def test_a_bush_wears_by_a_law_of_the_pressure(engine):
    """A constant law gives Archard's map to round-off, and a power the map of the built-in one."""
    scene = bush(engine=engine)
    pair = Materials(wear_coefficient=COEFFICIENT, bearing_share=0.7)
    bearing = replace(scene.bearing("B"), materials=pair)

    def depth(bins: int = 120, **changes: Any) -> Array:
        changed = replace(bearing, **{"angles": bins, **changes})
        run = worn(replace(scene, bearings={"B": changed}), 1e-15, 2)
        return np.concatenate([run.bush[-1], run.pin[-1]])

    archard = depth()
    assert_allclose(depth(wear_law=law("steady")), archard, rtol=1e-14)
    for name, exponent, reference in (("square", 2.0, 1e5), ("power", 1.7, 10e6)):
        by_power = replace(
            pair, pressure_exponent=exponent, pressure_reference=reference
        )
        # The pressure is a mean over a bin, and the built-in power has no such error.
        for bins, bound in ((120, 0.02), (480, 0.002)):
            built_in = depth(bins, materials=by_power)
            ours = depth(bins, wear_law=law(name))
            assert ours.sum() == pytest.approx(built_in.sum(), rel=bound)
            if bins == archard.size // 2:
                assert np.abs(archard - built_in).max() > 0.1 * built_in.max()


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"wear_law": "total"}, "B.wear_law: total must be a function of depth times"),
        ({"wear_law": "three"}, "three uses pressure and load_distance; allowed is"),
        (
            {"wear_law": "negative"},
            "negative gives 0 1/Pa at depth = 1e-06, coefficient",
        ),
        (
            {"wear_law": "fading", "running_in": 3.0},
            "running_in = 3: with wear_law = user law fading, [0-9a-f]+ allowed is 1",
        ),
        (
            {"wear_law": "power", "conventions": "paper"},
            "with wear_distribution = bin allowed is a law without pressure",
        ),
        ({"wear_law": "rusty"}, "unknown function in wear_law 'rusty'"),
    ],
)
def test_laws_that_are_refused(settings, words, tmp_path):
    file = tmp_path / "laws.py"
    file.write_text(LAWS)
    settings = {**settings, "wear_law": f"{file}:{settings['wear_law']}"}
    with pytest.raises(InputError, match=words):
        pw.scenes.slider_crank(**settings).check_user_laws()


def test_settings_that_a_user_law_does_not_read():
    bearing = pw.scenes.slider_crank(wear_law=law("fading")).bearing("B")
    unread = {"running_in", "running_in_depth", "pressure_exponent"}
    assert unread <= {*bearing.unread}
