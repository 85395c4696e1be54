"""Results by the nominal time: of a leader that turns evenly they are those without one."""

import re
from collections.abc import Iterator
from dataclasses import asdict, replace

import numpy as np
import pytest
from matplotlib.lines import Line2D

import presswear as pw
from presswear.analysis.contact_modes import over_nominal_time, timeline_of
from presswear.analysis.periods import impacts_of
from presswear.analysis.spectra import spectra_of
from presswear.linkage.linkage import Linkage
from presswear.results.drives import curves_of
from presswear.results.export import table_of

SETTINGS = {"cycles": 4, "wear_updates": 0, "replicates": 1, "drive_torque": "on"}


def run() -> pw.Result:
    scene = pw.scenes.slider_crank(joints="B", **SETTINGS)
    return pw.run(scene, engine="dae", jobs=1)


@pytest.fixture(scope="module")
def results() -> Iterator[tuple[pw.Result, pw.Result]]:
    """Results without a leader, and with the prescribed crank as one."""
    with pytest.MonkeyPatch.context() as patch:
        plain = run()
        leader = property(lambda self: self.drives[0] if self.drives else None)
        patch.setattr(Linkage, "leader", leader)
        yield plain, run()


def numbers(value: object) -> list[float]:
    if isinstance(value, dict):
        return [one for item in value.values() for one in numbers(item)]
    if isinstance(value, tuple | list):
        return [one for item in value for one in numbers(item)]
    return [float(value)] if isinstance(value, float) else []


def test_statistics_are_those_without_a_leader(
    results: tuple[pw.Result, pw.Result],
):
    plain, led = (result.stages[0] for result in results)
    period = results[0].scene.mechanism.period
    assert led.each_cycle("duration") == pytest.approx(period, rel=1e-12)
    assert led.clock == pytest.approx(led.time, abs=1e-12)
    # What follows from the first touchdowns is the same before chaos sets in.
    for name in ("bottom_time", "bottom_height", "velocity_max"):
        assert led.each_cycle(name)[:2] == pytest.approx(
            plain.each_cycle(name)[:2], rel=1e-7
        )
    bottoms = [stage.statistics.bdc for stage in (led, plain)]
    led_bottom, plain_bottom = (numbers(asdict(one)) for one in bottoms if one)
    assert led_bottom == pytest.approx(plain_bottom, rel=1e-2, abs=1e-5)
    with pytest.raises(pw.InputError, match="with a motor alone"):
        plain.each_cycle("duration")


def test_places_in_the_cycle_and_durations(
    results: tuple[pw.Result, pw.Result],
):
    """A clock that runs half as fast moves durations and frequencies, and no place."""
    scene = results[1].scene
    stage = results[1].stages[0]
    period = scene.mechanism.period
    contacts = stage.arrays["B_contacts"].copy()
    contacts[:, :2] *= 2.0  # touchdown and separation
    slowed = {"clock": 2.0 * stage.clock, "nominal_rate": 0.5 * stage.nominal_rate}
    slowed["drive_speed"] = 0.5 * stage.arrays["drive_speed"]
    arrays = {**stage.arrays, **slowed, "B_contacts": contacts}
    slow = replace(stage, arrays=arrays)
    assert slow.nominal_of(slow.clock) == pytest.approx(slow.time, abs=1e-12)
    beyond = np.array([-1e-3, 2.001 * stage.clock[-1]])
    assert np.isnan(slow.nominal_of(beyond)).all()
    assert np.isnan(slow.clock_of(np.array([-1e-3, 1.001 * stage.time[-1]]))).all()
    for one, other in zip(
        impacts_of(scene, stage, "B"), impacts_of(scene, slow, "B"), strict=True
    ):
        assert other == pytest.approx(one, abs=1e-9)
    lines = [timeline_of(scene, one, "B") for one in (stage, slow)]
    assert lines[1].durations.sum() == pytest.approx(2.0 * lines[0].durations.sum())
    shares = [
        over_nominal_time(scene, one, line).over_phase(period, 36)
        for one, line in zip((stage, slow), lines, strict=True)
    ]
    assert shares[1] == pytest.approx(shares[0], abs=1e-9)
    spectra = [spectra_of(scene, one)["B"] for one in (stage, slow)]
    assert spectra[1].frequency == pytest.approx(0.5 * spectra[0].frequency)
    assert spectra[1].order == pytest.approx(spectra[0].order)
    power = [curves_of(scene, one)["crank"].power for one in (stage, slow)]
    assert power[1] == pytest.approx(0.5 * power[0], rel=1e-6)
    # the contact resonance, and the cycle, twice as slow
    places = [
        [np.asarray(line.get_xdata()) for line in resonance_lines(result)]
        for result in (results[1], replace(results[1], stages=(slow,)))
    ]
    assert len(places[0]) == 1
    assert places[1][0] == pytest.approx(places[0][0], rel=1e-6)


def resonance_lines(result: pw.Result) -> list[Line2D]:
    """Return the lines of the contact resonance in the figure of spectra."""
    axes = result.plot("spectrum")
    return [one for panel in axes for one in panel.lines if one.get_linestyle() == "-."]


def test_shares_of_contact_modes_are_of_the_clock(
    results: tuple[pw.Result, pw.Result],
):
    """A crank that is slow while its pin flies makes the free flight longer."""
    stage = results[1].stages[0]
    period = results[1].scene.mechanism.period
    scale = 0.9 * period / (2.0 * np.pi)

    def slowed(time: np.ndarray) -> np.ndarray:
        return np.asarray(time + scale * np.sin(2.0 * np.pi * time / period))

    contacts = stage.arrays["B_contacts"].copy()
    contacts[:, :2] = slowed(contacts[:, :2])
    moved = {"clock": slowed(stage.time), "B_contacts": contacts}
    uneven = replace(stage, arrays={**stage.arrays, **moved})
    result = replace(results[1], stages=(uneven,))
    (axes,) = (one for one in result.plot("modes") if one.get_title(loc="left"))
    # A contact that lasts at the end is not stored as one.
    pressed = stage.time[stage.arrays["B_penetration"] > 0.0]
    closed = stage.arrays["B_contacts"][:, :2]
    lasting = pressed[pressed > closed[-1, 1] + 1e-9]
    if lasting.size:
        closed = np.vstack([closed, [lasting[0], 4.0 * period]])
    ends = np.clip(closed, 2.0 * period, 4.0 * period)
    clock, nominal = (
        100.0 - 100.0 * float(np.diff(by(ends), axis=1).sum()) / (2.0 * period)
        for by in (slowed, np.asarray)
    )
    (shown,) = re.findall(r"free ([\d.]+)", axes.get_title(loc="left"))
    assert float(shown) == pytest.approx(clock, abs=0.02)
    assert abs(clock - nominal) > 0.5


def test_tables_hold_the_clock(results: tuple[pw.Result, pw.Result]):
    assert "clock" not in table_of(results[0], 0)
    table = table_of(results[1], 0)
    assert np.array_equal(table["clock"], results[1].stages[0].clock)
    assert np.array_equal(
        table["crank_speed"], results[1].stages[0].arrays["drive_speed"][:, 0]
    )
