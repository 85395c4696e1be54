"""What would run for ever is refused before anything runs, in a line that names the value."""

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.linkage.elements import Bar, Body, Pin
from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.linkage import MOST_TURNS, Linkage
from presswear.linkage.motions import Drive
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import MAX_MASS_RATIO, Scene
from presswear.tools.errors import InputError


def heavy(mass: float) -> list[Body]:
    return [FOUR_BAR.bodies[0], FOUR_BAR.bodies[1], Bar("rocker", 0.12, mass)]


@given(st.lists(st.integers(1, 63), min_size=2, max_size=4))
def test_a_cycle_of_drives_has_few_turns(turns: list[int]) -> None:
    """Whole ratios of any size: no common cycle of more turns than allowed is taken."""
    bodies = [Bar(f"crank {k}", 0.05, 0.3) for k in range(len(turns))]
    linkage = Linkage(
        bodies,
        [Pin(f"O {k}", (0.2 * k, 0.0), f"crank {k}.tail") for k in range(len(turns))],
        [Drive(f"crank {k}", 3000.0 / turn) for k, turn in enumerate(turns)],
    )
    most = math.lcm(*turns) / min(turns)
    if most <= MOST_TURNS:
        assert linkage.period == pytest.approx(2.0 * math.pi * math.lcm(*turns) / 3000.0)
    else:
        with pytest.raises(InputError, match="cycle of linkage"):
            _ = linkage.period


@pytest.mark.parametrize("scene", [wear_times, slider_crank])
def test_every_mechanism_runs_up(scene: Any) -> None:
    """From rest, and behind the run-up as without one."""
    slow, plain = scene(run_up="2"), scene()
    period = plain.mechanism.period
    assert slow.run_up == pytest.approx(4.0 * period)
    assert abs(slow.ideal.at([0.0]).velocity).max() == 0.0
    one = slow.ideal.at([slow.run_up + 0.3 * period]).velocity
    assert one == pytest.approx(plain.ideal.at([0.3 * period]).velocity, rel=1e-9, abs=1e-9)


def test_mass_ratio_is_the_limit() -> None:
    light = FOUR_BAR.bodies[0].mass
    Scene(replace(FOUR_BAR, bodies=heavy(light * MAX_MASS_RATIO))).check()
    with pytest.raises(InputError, match=r"mass of rocker = \S+ kg beside mass of crank = 0\.3 kg"):
        Scene(replace(FOUR_BAR, bodies=heavy(1.1 * light * MAX_MASS_RATIO))).check()
