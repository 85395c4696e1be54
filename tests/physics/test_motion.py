"""Motions of drives: the same in every engine, derivatives of each other, exact."""

import math
import tomllib
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.campaign.starts import start_of
from presswear.engines.base import Plan
from presswear.linkage.elements import Linkage
from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.motions import Drive
from presswear.linkage.slider_crank import SliderCrank
from presswear.linkage.written import read, toml_of, written
from presswear.physics.assembly import motion_of as ideal_of
from presswear.physics.motion import drive_motion, is_steady, motions_of
from presswear.scene.scene import Scene
from presswear.tools.compiled import Records
from presswear.tools.errors import InputError

amplitudes = st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
fourier = st.builds(
    Drive,
    st.just("crank"),
    st.floats(-50.0, 50.0),
    st.floats(-3.0, 3.0),
    st.floats(0.1, 50.0),
    st.lists(amplitudes, max_size=5),
)


def packed(drive: Drive, run_up: int = 0) -> Records:
    """A drive of the four-bar as the kernels see it."""
    return motions_of(replace(FOUR_BAR, drives=[drive], run_up=run_up))[0]


@given(fourier, st.floats(0.0, 10.0))
def test_a_fourier_series_is_summed_as_it_is_written(drive: Drive, t: float) -> None:
    """Against its complex form, whose derivatives are exact."""
    k = 1.0 + np.arange(len(drive.harmonics))
    c = np.array([complex(a, -b) for a, b in drive.harmonics])
    waves = c * np.exp(1j * k * drive.frequency * t)
    rates = 1j * k * drive.frequency
    turned = drive.speed * t + (waves - c.real).real.sum()
    exact = turned, drive.speed + (rates * waves).real.sum(), (rates**2 * waves).real.sum()
    scale = 1.0 + np.abs(c).sum() * (1.0 + 5.0 * drive.frequency * np.array([1.0, t])).max()
    for level, (one, other) in enumerate(zip(drive_motion(packed(drive), t), exact, strict=True)):
        bound = 1e-13 * scale * (1.0 + 5.0 * drive.frequency) ** level * (1.0 + abs(drive.speed))
        assert one == pytest.approx(other, abs=bound)
    found = [float(level[0]) for level in drive.motion(np.array([t]))]
    found[0] -= drive.angle
    np.testing.assert_allclose(found, drive_motion(packed(drive), t), rtol=1e-12, atol=1e-9)
    assert is_steady(FOUR_BAR, drive) == (not drive.harmonics)
    assert not is_steady(replace(FOUR_BAR, run_up=1), drive)


def test_what_is_no_motion_is_refused() -> None:
    with pytest.raises(InputError, match="frequency of crank = 0 rad/s: with harmonics"):
        Drive("crank", harmonics=[(0.1, 0.0)])
    with pytest.raises(InputError, match="harmonics of crank: 17 are given; allowed are 0 to 16"):
        Drive("crank", 1.0, harmonics=[(0.0, 0.0)] * 17)
    with pytest.raises(InputError, match="drive of crank: finite numbers"):
        Drive("crank", math.nan)


UNEVEN = replace(
    FOUR_BAR, drives=[Drive("crank", 30.0, 0.2, harmonics=[(0.1, 0.3), (0.0, -0.05), (0.02, 0.0)])]
)
ROCKING = replace(
    SliderCrank().linkage(),
    drives=[Drive("crank", angle=0.5, frequency=40.0, harmonics=[(0.0, 0.8)])],
)


def test_the_cycle_is_that_of_the_harmonics() -> None:
    assert UNEVEN.period == pytest.approx(2.0 * math.pi / 30.0)
    assert ROCKING.period == pytest.approx(2.0 * math.pi / 40.0)
    two = replace(UNEVEN, drives=[Drive("crank", 30.0, 0.2, 10.0, [(0.0, 0.1)])])
    assert two.period == pytest.approx(2.0 * math.pi / 10.0)


def test_the_slider_follows_a_crank_that_rocks() -> None:
    """x = r cos a + sqrt(l^2 - r^2 sin^2 a) of any angle a(t), and its derivatives."""
    time = np.linspace(0.0, ROCKING.period, 200)
    motion = ideal_of(ROCKING).at(time)
    r, rod = SliderCrank().crank_length, SliderCrank().rod_length
    a, w, e = ROCKING.drives[0].motion(time)
    root = np.sqrt(rod**2 - (r * np.sin(a)) ** 2)
    np.testing.assert_allclose(motion.position[:, 6], r * np.cos(a) + root, atol=1e-14)
    slope = -r * np.sin(a) - r**2 * np.sin(a) * np.cos(a) / root
    bend = -r * np.cos(a) - r**2 * np.cos(2.0 * a) / root
    bend -= r**4 * (np.sin(a) * np.cos(a)) ** 2 / root**3
    np.testing.assert_allclose(motion.velocity[:, 6], slope * w, atol=1e-12)
    np.testing.assert_allclose(motion.acceleration[:, 6], slope * e + bend * w**2, atol=1e-10)


@pytest.mark.parametrize("linkage", [UNEVEN, ROCKING], ids=["four-bar", "slider-crank"])
def test_harmonics_are_written_and_read_back(linkage: Linkage) -> None:
    assert read(written(linkage), "here") == linkage
    data = tomllib.loads(toml_of(linkage))["mechanism"]
    assert read(data, "here", units=True) == linkage


@pytest.mark.parametrize("linkage", [UNEVEN, ROCKING], ids=["four-bar", "slider-crank"])
@pytest.mark.parametrize(
    ("engine", "joints", "bound"),
    [
        ("dae", "none", 1e-7),
        ("exudyn-joints", "none", 1e-5),
        ("dae", "B", 1e-7),
        ("exudyn-tree", "B", 1e-7),
        ("exudyn-joints", "B", 1e-5),
    ],
)
def test_every_engine_follows_an_uneven_drive(
    linkage: Linkage, engine: str, joints: str, bound: float
) -> None:
    """Without clearance the closed motion; with it the drive, and an energy that adds up."""
    scene = Scene(mechanism=linkage, joints=joints, wears=0, engine=engine)
    period = scene.mechanism.period
    run = scene.solver.over(period).simulate(scene.linkage(), start_of(scene), Plan(period, 1))
    assert run.status == "completed"
    end = scene.ideal.at(np.array([run.time]))
    column = 2 if joints == "B" else slice(None)
    assert np.abs(run.end.position - end.position[0])[column].max() < bound
    assert np.abs(run.end.velocity - end.velocity[0])[column].max() < 1e2 * bound
    if joints == "B":
        residual = abs(float(run.diagnostics["energy_residual_J"]))
        assert residual < 10.0 * bound * float(run.diagnostics["drive_exchange_J"])
