"""Final motions: shares, half-lives of maps with known escape rate, starts, kicks, a machine."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import csv
import math
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from refusals import refused

import presswear as pw
from presswear.analysis import kicks, settle
from presswear.analysis.final_motions import (
    FAILED,
    IRREGULAR,
    Runs,
    Watch,
    evaluate,
    proportion,
)
from presswear.analysis.kicks import Kick, least_speed, leaves
from presswear.analysis.pins import (
    crossing_speeds,
    eccentricities,
    kick_pins,
    spread_starts,
)
from presswear.analysis.settle import _row as empty_row
from presswear.analysis.settling_tables import summary, write_tables
from presswear.campaign.replicates import start_of
from presswear.engines.base import Start
from presswear.linkage.mechanisms import SliderCrank
from presswear.physics.constraints import constraints_of
from presswear.recording.settling import (
    REPEATED,
    half_life,
    least_half_life,
)
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.show.figures.settling import drawings_of
from presswear.tools.arrays import Array

SCENE = pw.Scene(
    SliderCrank(speed=1000.0 * math.pi / 30.0, slide_angle=0.0),
    bearings={"B": pw.Bearing(clearance=5e-4)},
)


def test_limit_of_the_half_life_is_exceeded_in_95_of_100_cases():
    """The rate is such that no run settles with a probability of 5 %."""
    rate = math.log(2.0) / least_half_life([], [50, 102])
    assert math.exp(
        -rate * (50 + 102 - 2 * (STARTUP_CYCLES + REPEATED))
    ) == pytest.approx(0.05)
    assert half_life([], [50, 102]) is None
    # Starts that settle within the start-up were never irregular.
    assert half_life([1, 2], []) is None
    assert half_life([1, 2, 12], [32]) == half_life([12], [32])


def test_shares_have_exact_intervals():
    """Clopper and Pearson: closed forms at the ends, and the coverage of one share."""
    assert proportion(0, 24).high == pytest.approx(1.0 - 0.025 ** (1.0 / 24.0))
    assert proportion(24, 24).low == pytest.approx(0.025 ** (1.0 / 24.0))
    assert (proportion(0, 24).low, proportion(24, 24).high) == (0.0, 1.0)
    chance = [math.comb(24, k) * 0.3**k * 0.7 ** (24 - k) for k in range(25)]
    each = [proportion(k, 24) for k in range(25)]
    holds = [one.low <= 0.3 <= one.high for one in each]
    assert 0.95 <= float(np.dot(chance, holds)) <= 0.99


def rows_of(settled: list[int], place: list[float]) -> Runs:
    rows = np.concatenate([empty_row(1, 3) for _ in settled])
    rows["index"] = np.arange(len(settled))
    rows["settled"] = settled
    rows["cycles"] = 40
    rows["period"] = [1 if motion >= 0 else 0 for motion in settled]
    rows["signature"][:, 0] = place
    rows["peak_force"][:, 0] = 100.0 + np.array(place)
    return rows.view(np.recarray)


def test_shares_of_known_basins():
    """Starts below 0.3 rest at 0, those above at 1; two are irregular and one failed."""
    start = (np.arange(40) + 0.5) / 40.0
    settled = [5] * 40 + [IRREGULAR] * 2 + [FAILED]
    place = [*np.where(start < 0.3, 0.0, 1.0), 0.5, 0.5, 0.0]
    kick = Kick("B", 0.02, 0.018, 90)
    result = evaluate(rows_of(settled, place), ("B",), {12: (kick,)}, None)
    assert [motion.starts for motion in result.motions] == [28, 12, 2]
    assert [motion.share.mean for motion in result.motions] == [
        28 / 42,
        12 / 42,
        2 / 42,
    ]
    assert [motion.period for motion in result.motions] == [1, 1, None]
    assert [motion.peak_force["B"] for motion in result.motions] == pytest.approx(
        [101.0, 100.0, 100.5]
    )
    assert [motion.least_kick for motion in result.motions] == [kick, None, None]
    assert (result.failed, result.irregular) == (1, 2)
    assert result.half_life == half_life([5] * 40, [40, 40])
    cycles, share = result.unsettled()
    assert_allclose(share[cycles < 5.0], 1.0)
    assert_allclose(share[cycles >= 5.0], 2 / 42)


def test_starts_fill_the_phase_space_of_the_clearance():
    linkage = SCENE.linkage()
    ideal = start_of(SCENE)
    starts = spread_starts(SCENE, 256)
    # The largest acceleration of a centre of mass is that of the slider at its outer
    # dead centre.
    crank = SCENE.mechanism
    assert isinstance(crank, SliderCrank)
    ratio = crank.crank_length / crank.rod_length
    acceleration = crank.crank_length * crank.speed**2 * (1.0 + ratio)
    assert crossing_speeds(SCENE)[0] == pytest.approx(
        math.sqrt(4.0 * acceleration * 5e-4)
    )
    for each, most in (
        (starts.eccentricity, 5e-4),
        (starts.velocity, crossing_speeds(SCENE)[0]),
    ):
        radius = np.hypot(*each[:, 0].T) / most
        assert_allclose(
            np.quantile(radius**2, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.02
        )
        assert_allclose(each.mean(axis=0), 0.0, atol=0.02 * most)
    assert_array_equal(spread_starts(SCENE, 8).velocity, starts.velocity[:8])
    start = starts.start(3, linkage, ideal)
    assert_allclose(
        eccentricities(linkage, start.position), starts.eccentricity[3], atol=1e-12
    )
    phi, phi_t, *_ = constraints_of(linkage).evaluate(
        0.0, start.position, start.velocity
    )
    assert np.abs(phi).max() < 1e-12
    assert np.abs(phi_t).max() < 1e-9
    assert_allclose(pin_velocity(start), starts.velocity[3, 0], atol=1e-9)


def pin_velocity(start: Start) -> Array:
    """Return the velocity of the slider minus that of the end of the rod, m/s."""
    rod = SCENE.linkage().index("rod")
    slider = SCENE.linkage().index("slider")
    angle = start.position[3 * rod + 2]
    spin = start.velocity[3 * rod + 2]
    arm = 0.5 * 0.12 * spin * np.array([-math.sin(angle), math.cos(angle)])
    return np.asarray(
        start.velocity[3 * slider : 3 * slider + 2]
        - start.velocity[3 * rod : 3 * rod + 2]
        - arm
    )


def test_a_kick_changes_the_velocity_of_the_pin_alone():
    linkage = SCENE.linkage()
    start = spread_starts(SCENE, 1).start(0, SCENE.linkage(), start_of(SCENE))
    change = np.array([[0.03, -0.02]])
    kicked = kick_pins(linkage, start, change)
    assert_allclose(pin_velocity(kicked) - pin_velocity(start), change[0], atol=1e-12)
    assert_array_equal(kicked.position, start.position)
    crank = 3 * linkage.index("crank")
    assert_allclose(
        kicked.velocity[crank : crank + 3],
        start.velocity[crank : crank + 3],
        atol=1e-12,
    )


@pytest.mark.parametrize("threshold", [0.013, 2.0, 1e-9])
def test_least_speed_of_a_threshold(threshold):
    """The sixth of eight directions is the most sensitive one, by a tenth."""
    returns, rattles, case = least_speed(
        lambda k, v: v > threshold * (1.1 - 0.1 * (k == 5)), 8, 1.0
    )
    if threshold > 1.0:
        assert (returns, rattles) == (1.0, None)
        return
    if threshold < kicks.WEAKEST:
        assert (returns, rattles <= kicks.WEAKEST) == (0.0, True)
        return
    assert case == 5
    assert returns <= threshold < rattles
    assert rattles / returns == pytest.approx(2.0**0.125)


def test_a_slider_crank_comes_to_rest(tmp_path, monkeypatch):
    """An independent simulator has 293 to 303 N, and returns after kicks of 0.006 m/s."""
    monkeypatch.setattr(kicks, "STATES", 1)
    monkeypatch.setattr(kicks, "FACTORS", (2.0,))
    monkeypatch.setattr(settle, "STATES", 1)
    # Half of the starts rattle for 34 cycles, one in a thousand for 340.
    watch = Watch(4, 340)
    result = settle.compute(SCENE, watch, tmp_path, start_of, jobs=1)
    (settled,) = result.values
    motion = settled.motions[0]
    assert motion.period == 1
    assert 293.0 < motion.peak_force["B"] < 303.0
    least = motion.least_kick
    assert 0.006 < least.returns < least.rattles
    assert "came to rest on the same motion" in summary(result, settled)[0]
    drawing = drawings_of(result)[0]
    assert len(drawing.sheet.axes) == 2
    files = write_tables(result, tmp_path)
    starts = list(csv.DictReader(files[0].read_text().splitlines()))
    assert [float(row["B_eccentricity_x (m)"]) for row in starts] == pytest.approx(
        spread_starts(SCENE, 4).eccentricity[:, 0, 0].tolist()
    )
    # Nothing runs again, and a missing start alone would.
    monkeypatch.setattr(settle, "run_start", None)
    monkeypatch.setattr(settle, "run_kicks", None)
    again = settle.compute(SCENE, watch, tmp_path, start_of, jobs=1)
    assert again.values[0].motions == settled.motions
    with refused("final motions with another watch"):
        settle.compute(SCENE, Watch(4, 61), tmp_path, start_of, jobs=1)


def test_an_interrupted_computation_is_resumed(tmp_path):
    scene = pw.scenes.slider_crank()
    watch = Watch(3, 14)
    whole = settle.compute(scene, watch, tmp_path / "whole", start_of, jobs=1)

    def stop(step: str, share: float) -> None:
        if step.startswith("start 2"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        settle.compute(
            scene, watch, tmp_path / "parts", start_of, jobs=1, on_progress=stop
        )
    assert len(settle.load(tmp_path / "parts").values[0].runs) == 1
    fewer = settle.compute(scene, Watch(2, 14), tmp_path / "parts", start_of, jobs=1)
    assert len(fewer.values[0].runs) == 2
    parts = settle.compute(scene, watch, tmp_path / "parts", start_of, jobs=1)
    assert parts.values[0].runs.tobytes() == whole.values[0].runs.tobytes()
    sentence = summary(whole, whole.values[0])[0]
    assert sentence.startswith(
        "none of 3 starts settled in 14 cycles: half-life longer than 1.4 "
    )


def test_failed_kicks_count_as_rattle(monkeypatch):
    failed = SimpleNamespace(simulate=lambda *case: SimpleNamespace(status="failed"))
    monkeypatch.setattr(kicks, "ENGINE", failed)
    assert leaves(SCENE.linkage(), start_of(SCENE), np.zeros((1, 3)))


@pytest.mark.parametrize(("starts", "cycles"), [(0, 300), (4, 11)])
def test_senseless_numbers_are_refused(starts, cycles):
    with refused("must be at least"):
        Watch(starts, cycles)


def test_scenes_without_final_motions_are_refused(tmp_path):
    with refused("no motion is free"):
        settle.compute(pw.scenes.ideal(), Watch(), tmp_path / "a", start_of)
    rising = pw.Scene(SliderCrank(run_up=3))
    with refused("run_up=0"):
        settle.compute(rising, Watch(), tmp_path / "b", start_of)
    tilting = pw.scenes.press_off_centre()
    with refused("allowed is no clearance of guide: starts"):
        settle.compute(tilting, Watch(), tmp_path / "c", start_of)
