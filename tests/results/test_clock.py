"""Results by the nominal time: of a leader that turns evenly they are those without one."""

from dataclasses import replace

import numpy as np
import pytest
from refusals import refused

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
def results():
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


def test_places_in_the_cycle_and_durations(results):
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


def test_tables_hold_the_clock(results):
    with refused("with a motor alone"):
        results[0].stages[0].each_cycle("duration")
    assert "clock" not in table_of(results[0], 0)
    table = table_of(results[1], 0)
    assert np.array_equal(table["clock"], results[1].stages[0].clock)
    assert np.array_equal(
        table["crank_speed"], results[1].stages[0].arrays["drive_speed"][:, 0]
    )
