"""What would run for ever is refused before anything runs, in a line that names the value."""

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.linkage.elements import Bar, Body, Pin
from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.linkage import CYCLE, MOST_TURNS, Linkage
from presswear.linkage.loads import Harmonics, Moment, OverPosition, OverTime, Spring
from presswear.linkage.motions import Drive
from presswear.linkage.pace import HEAVIER, MOST_STEPS
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError


def heavy(mass: float) -> list[Body]:
    return [FOUR_BAR.bodies[0], FOUR_BAR.bodies[1], Bar("rocker", 0.12, mass)]


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"drives": [Drive("crank", 1e-12)]}, r"cycle of four-bar.* = 6\.28319e\+12 s: allowed is"),
        (
            {"drives": [Drive("crank", 1.0, frequency=5e4, harmonics=[(0.0, 0.1)])]},
            "drive of crank turns 50000 times in it, with 50000 rad/s; allowed are 1000",
        ),
        (
            {"drives": [Drive("crank", 30.0, table=[(0, 0), (3, 0), (3.0001, 1), (6, 0)])]},
            r"greatest speed of the drive of crank = 3e\+05 rad/s: allowed is 3e\+04 rad/s",
        ),
        (
            {"loads": [Moment("rocker", OverTime([(0.0, 1.0)], 2e-9))]},
            r"loads\[0\] = 2e-09 s: in a",
        ),
        (
            {"loads": [Moment("rocker", Harmonics(0.0, 1e6, [(1.0, 0.0)] * 16))]},
            r"frequency of loads\[0\] = 1e\+06 rad/s: in a cycle",
        ),
        (
            {"springs": [Spring("s", "rocker.head", (0.0, 0.0), 1e12, 0.1, 1e12)]},
            r"damping of spring s = 1e\+12 N s/m: in a cycle of 0\.20944 s it takes",
        ),
        ({"bodies": heavy(1e9)}, r"mass of rocker = 1e\+09 kg beside mass of crank = 0\.3 kg"),
    ],
)
def test_what_would_last_for_ever_is_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        Scene(replace(FOUR_BAR, **changes))
    assert len(str(refusal.value).splitlines()) == 1


def test_a_mass_beyond_all_machines_is_refused_where_it_stands() -> None:
    with pytest.raises(
        InputError, match=r"mass of rocker = 1e\+300 kg: allowed is 1e-09 to 1e\+09"
    ):
        heavy(1e300)
    with pytest.raises(InputError, match="repeats = 1e-09 m or rad: allowed is 0, or 1e-06 to"):
        OverPosition([(0.0, 0.0), (5e-10, 1.0)], repeats=1e-9)


@given(st.floats(-12.0, 6.0), st.floats(-9.0, 6.0))
def test_whatever_is_taken_has_few_steps_in_a_cycle(speed: float, period: float) -> None:
    """Times of any size: refused, or a cycle that can be waited for."""
    load = Moment("rocker", OverTime([(0.0, 1.0)], 10.0**period))
    told = ""
    try:
        linkage = replace(FOUR_BAR, drives=[Drive("crank", 10.0**speed)], loads=[load])
        found = Scene(linkage).mechanism.period
    except InputError as refusal:
        told, found = str(refusal), 2.0 * math.pi / 10.0**speed
    fits = 10.0**speed <= 1e5 and CYCLE[0] <= found <= CYCLE[1]
    assert (not told) == (fits and found / 10.0**period <= MOST_STEPS)


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
    assert Scene(replace(FOUR_BAR, bodies=heavy(light * HEAVIER)))
