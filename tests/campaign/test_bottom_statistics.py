"""Statistics of bottom dead centre: of made-up strokes, of the ideal press, and as kept."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from presswear.campaign.campaign import run
from presswear.campaign.stage_statistics import bottom_statistics
from presswear.linkage.drives import Drive, Dwell
from presswear.linkage.elements import Bar, Pin
from presswear.linkage.linkage import assemble
from presswear.linkage.mechanisms import GEOMETRIES, Press
from presswear.physics.ideal import bottom_of
from presswear.recording.statistics import STARTUP_CYCLES, pooled
from presswear.results.press_analysis import bottom_errors, rise
from presswear.scene.catalog import clearance_c, ideal, wear_times
from presswear.scene.scene import Scene
from presswear.show.report_tables import stage_tables
from presswear.tools.arrays import Array


@dataclass
class Strokes:
    """What is asked of a recorder."""

    height: Array
    time: Array

    @property
    def cycles(self) -> Array:
        return self.height[:, np.newaxis]

    def each_cycle(self, name: str) -> Array:
        found: Array = getattr(self, name.removeprefix("bottom_"))
        return found


def made(scene: Scene, count: int, seed: int, off: float = 0.0) -> Any:
    """Strokes about 0.7 mm too low, 2 ms early."""
    draw, bottom = np.random.default_rng(seed), bottom_of(scene.ideal)
    assert bottom is not None
    height = bottom.height - 7e-4 + off + 4e-5 * draw.normal(size=count)
    time = bottom.time - 2e-3 + 1e-3 * draw.normal(size=count)
    time += scene.run_up + scene.mechanism.period * np.arange(count)
    return cast(Any, Strokes(height, time))


def test_made_up_strokes_give_their_numbers_back() -> None:
    scene = wear_times()
    runs = [made(scene, 12, seed) for seed in range(4)]
    found = bottom_statistics(scene, runs)
    assert found is not None
    bottom = bottom_of(scene.ideal)
    assert bottom is not None
    settled = np.array([own.height[STARTUP_CYCLES:] for own in runs])
    assert found.strokes == settled.size == 40
    expected = pooled([own.height - bottom.height for own in runs])[0]
    error = found.error
    assert error.mean == pytest.approx(expected.mean, rel=1e-9)
    assert error.half_width == pytest.approx(expected.half_width, rel=1e-9)
    assert error.mean == pytest.approx(-7e-4, abs=3e-5)
    assert found.height.mean == pytest.approx(settled.mean(), rel=1e-12)
    deviation = settled.std(axis=1, ddof=1)
    scatter, delay_scatter = found.standard_deviation, found.delay_standard_deviation
    assert scatter is not None
    assert scatter.mean == pytest.approx(np.sqrt(np.mean(deviation**2)))
    assert scatter.low is not None
    assert scatter.high is not None
    assert scatter.low < 4e-5 < scatter.high
    assert found.range_strokes == 10
    assert found.range is not None
    assert found.range.mean == pytest.approx(np.ptp(settled, axis=1).mean())
    assert found.range_of_all == pytest.approx(np.ptp(settled))
    assert found.delay is not None
    assert found.delay_angle is not None
    assert found.delay.mean == pytest.approx(-2e-3, abs=5e-4)
    turn = found.delay_angle.mean / found.delay.mean
    assert turn == pytest.approx(2.0 * np.pi / scene.mechanism.period)
    assert delay_scatter is not None
    assert delay_scatter.mean == pytest.approx(1e-3, rel=0.4)


def test_starts_on_surfaces_of_their_own_widen_the_mean_and_not_the_scatter() -> None:
    """How far machines are apart is no matter of how one of them repeats itself."""
    scene = wear_times()
    apart = [made(scene, 12, seed, 3e-4 * seed) for seed in range(4)]
    together = [made(scene, 12, seed) for seed in range(4)]
    found = [bottom_statistics(scene, *runs) for runs in ((together,), (together, apart), (apart,))]
    widths = [own.error.half_width for own in found if own is not None]
    scatters = [own.standard_deviation for own in found if own is not None]
    assert widths[0] is not None
    assert widths[1] is not None
    assert widths[1] > 5.0 * widths[0]
    assert scatters[0] is not None
    assert scatters[2] is not None
    assert scatters[2].mean == pytest.approx(scatters[0].mean, rel=1e-9)


@pytest.mark.parametrize("geometry", ["standard", "swapped"])
def test_ideal_press_is_accurate_and_repeats_itself(geometry: str) -> None:
    """Of the swapped one the first bottom lies before the start: of a cycle there is no stroke."""
    scene = replace(ideal(), mechanism=Press(geometry=GEOMETRIES[geometry]), engine="dae", cycles=4)
    stage = run(scene).stages[0]
    assert stage.bdc.strokes == 2
    assert abs(stage.bdc.error.mean) < 1e-12
    assert stage.bdc.range_of_all < 1e-12
    assert stage.bdc.delay is not None
    assert abs(stage.bdc.delay.mean) < 1e-10
    (strokes,) = bottom_errors(scene, stage)
    assert strokes[0].tolist() == ([1, 2, 3, 4] if geometry == "standard" else [2, 3, 4])
    assert np.abs(strokes[1]).max() < 1e-12
    alone = run(replace(scene, cycles=1)).stages[0]
    assert (alone.statistics.bdc is not None) == (geometry == "standard")


def test_stages_keep_them_in_memory_and_on_disk(tmp_path: Path) -> None:
    scene = clearance_c(cycles=4, wear_updates=1, replicates=2, engine="dae")
    held, stored = (run(scene, folder, jobs=1) for folder in (None, tmp_path / "run"))
    for one, other in zip(held.stages, stored.stages, strict=True):
        assert one.bdc == other.bdc
        assert one.bdc.strokes == 4
    unworn, worn = stored.stages
    found = rise(worn, unworn)
    assert found is not None
    means = [own.bdc.error for own in (worn, unworn)]
    assert found.mean == means[0].mean - means[1].mean
    assert found.high is not None
    half = np.linalg.norm([own.half_width or np.nan for own in means])
    assert found.high - found.mean == pytest.approx(half)
    assert rise(worn, worn) is not None
    numbers = [rows for _, rows in bottom_errors(scene, unworn)]
    settled = np.concatenate([rows[STARTUP_CYCLES:] for rows in numbers])
    assert settled.mean() == pytest.approx(means[1].mean, rel=1e-9)


def test_what_stands_has_no_bottom() -> None:
    linkage = assemble(
        bodies=[Bar("bar", length=0.2, mass=1.0)],
        joints=[Pin("O", (0.0, 0.0), "bar.centre")],
        drives=[Drive("bar", speed=5.0)],
    )
    stage = run(Scene(mechanism=linkage, wear_updates=0, cycles=2, engine="dae")).stages[0]
    assert stage.statistics.bdc is None
    assert rise(stage, stage) is None
    assert bottom_errors(Scene(mechanism=linkage, wear_updates=0), stage) == []


@pytest.mark.parametrize("part", [0.04, 1.0 / 9.0])
@pytest.mark.parametrize("cycles", [1, 4])
def test_what_dwells_at_its_bottom_is_not_late(part: float, cycles: int) -> None:
    """The ideal slider stands there for that part of a cycle: no instant of it is the bottom."""
    press = Press(servo=Dwell(part=part))
    scene = replace(ideal(), mechanism=press, engine="dae", cycles=cycles)
    stage = run(scene).stages[0]
    assert stage.bdc.delay is None
    # It leaves slowly, and is looked at 1440 times in a cycle.
    stays = stage.bdc.ideal_dwell / press.period
    assert part - 2.0 / 1440.0 < stays < part + 0.01
    result = run(scene)
    table = stage_tables(result)["bottom"]
    assert table is not None
    labels = [row[0] for _, rows in table.groups for row in rows]
    assert "dwell of the ideal motion (ms)" in labels
    plain = run(replace(scene, mechanism=Press())).stages[0].bdc
    assert plain.delay is not None
    assert plain.ideal_dwell < 0.002 * press.period
    wide = made(wear_times(), 12, seed=1)
    wide.height += 10.0 * (wide.height - wide.height.mean())
    found = bottom_statistics(wear_times(), [wide])
    assert found is not None
    assert found.standard_deviation is not None
    assert found.standard_deviation.mean > 2e-4
    assert found.delay is not None
