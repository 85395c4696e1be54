"""Growth of the wear: laws of wear in closed form under an engine that does nothing else."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from fake_engine import FakeEngine, Seen, use
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray

import presswear as pw
from presswear.campaign.campaign import run_campaign
from presswear.campaign.wear_update import FIRST_PASS, WearUpdate, wear_error, wear_per_cycle
from presswear.linkage.surface import bin_centres
from presswear.physics.wear import worn_volume
from presswear.recording.statistics import STARTUP_CYCLES, MapBatches, half_width, mean_map
from presswear.results.result import load
from presswear.results.stage import SIDES, JointResult
from presswear.scene.bearing import CONVENTIONS
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene

Array = NDArray[np.float64]

CLEARANCE = 0.8e-3
CYCLES = 6
REPRESENTED = 4e6
RATE = 0.05 * CLEARANCE / REPRESENTED
"""Depth of one cycle where it is deepest: a wear of a twentieth of the clearance, m."""

SCENE = replace(
    wear_times(),
    cycles=CYCLES,
    wear_updates=2,
    replicates=2,
    cycles_per_update=REPRESENTED,
    extrapolation="steps",
)
SHAPE = np.stack([np.exp(np.cos(bin_centres(360)) - 1.0), 0.3 + 0.2 * np.sin(bin_centres(360))])
"""Of wear over bearing and pin; its largest value is that of the bearing, near 1."""


def constant(run: int, depth: Array) -> Array:
    return np.stack([RATE * SHAPE, 0.4 * RATE * SHAPE])


def uneven(run: int, depth: Array) -> Array:
    """Rates that come and go from run to run, as in a chaotic motion."""
    return constant(run, depth) * (1.0, 0.3, 2.7, 0.9)[run % 4]


def exponential(run: int, depth: Array) -> Array:
    """dh/dN = a + b h: grows to a (exp(b N) - 1) / b."""
    return RATE * SHAPE + depth / REPRESENTED


def both(joint: JointResult, of: Callable[[str], Array]) -> Array:
    """Bearing and pin, shape (2, m), m."""
    return np.stack([of(side) for side in SIDES])


Campaign = Callable[[Scene, FakeEngine], Seen]


@pytest.fixture
def campaign(monkeypatch: pytest.MonkeyPatch) -> Campaign:
    """Runs a campaign with a fake engine."""

    def run(scene: Scene, engine: FakeEngine) -> Seen:
        use(engine, monkeypatch)
        seen = Seen()
        seen.status, seen.message, _ = run_campaign(scene, [seen])
        return seen

    return run


@pytest.mark.parametrize("cycles", [1, 2, 7])
def test_a_constant_rate_is_exact_in_any_number_of_steps(campaign: Campaign, cycles: int) -> None:
    seen = campaign(replace(SCENE, cycles=cycles), FakeEngine(constant))
    assert seen.status == "completed"
    wear_updates = dict(zip("AC", REPRESENTED * constant(0, np.zeros(0)), strict=True))
    for name, joint in seen.stages[2].joints.items():
        np.testing.assert_allclose(both(joint, joint.depth), 2.0 * wear_updates[name], rtol=1e-12)
    for stage in seen.stages[:2]:
        assert len(stage.wear_steps) == cycles
        for name, joint in stage.joints.items():
            np.testing.assert_allclose(both(joint, joint.wear), wear_updates[name], rtol=1e-12)
            deepest = stage.wear_steps[-1].max_depth[name]
            after = both(joint, joint.depth) + both(joint, joint.wear)
            np.testing.assert_allclose(list(deepest.values()), after.max(axis=1), rtol=1e-12)
        total = math.fsum(step.cycles_per_update for step in stage.wear_steps)
        assert total == pytest.approx(REPRESENTED, rel=1e-14)


def test_the_error_of_the_step_is_told_by_the_coarser_pass(campaign: Campaign) -> None:
    """A rate that grows with depth; explicit Euler steps in represented cycles."""
    exact = RATE * REPRESENTED * (math.e - 1.0)
    errors = []
    for cycles in (32, 64, 128):
        seen = campaign(
            replace(SCENE, cycles=cycles, wear_updates=1, replicates=3), FakeEngine(exponential)
        )
        peak = seen.stages[0].joints["A"].statistics.wear_peaks["bearing"]
        assert peak.step_error is not None
        errors.append(exact - peak.depth.mean / SHAPE[0].max())
        # Of first order: what half the steps do worse is what is left.
        assert peak.step_error == pytest.approx(errors[-1], rel=0.15)
        assert peak.depth.half_width == pytest.approx(peak.step_error)
        assert peak.depth.high == pytest.approx(peak.depth.mean + peak.step_error)
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 2.0, rtol=0.06)


def test_passes_go_on_until_the_wear_is_known(campaign: Campaign) -> None:
    scene = replace(SCENE, cycles=None, wear_updates=1, tolerance=0.02)
    stage = campaign(scene, FakeEngine(exponential)).stages[0]
    # The error of the step is e / (e - 1) / 2, part of the wear, over the cycles.
    assert len(stage.wear_steps) == 8 * FIRST_PASS
    short = campaign(replace(scene, max_cycles=70), FakeEngine(exponential)).stages[0]
    assert len(short.wear_steps) == 4 * FIRST_PASS


def test_noise_is_worn_away_cycle_by_cycle_and_kept_by_a_jump(campaign: Campaign) -> None:
    """dh/dN = (a - h) / N with noise of the size of the wear itself."""
    generator = np.random.default_rng(1)

    def noisy(run: int, depth: Array) -> Array:
        noise = generator.uniform(0.0, 2.0, depth.shape)
        return (noise * RATE * REPRESENTED + 10.0 * (RATE * REPRESENTED - depth)) / REPRESENTED

    scene = replace(SCENE, cycles=40, wear_updates=1, replicates=1)
    steps = campaign(scene, FakeEngine(noisy)).stages[1].joints["A"].depth("pin")
    one = replace(scene, extrapolation="single")
    jumped = campaign(one, FakeEngine(noisy)).stages[1].joints["A"].depth("pin")
    assert steps.mean() == pytest.approx(1.1 * RATE * REPRESENTED, rel=0.02)
    assert jumped.mean() == pytest.approx(11.0 * RATE * REPRESENTED, rel=0.02)
    # Each step keeps three quarters of the noise before it: the sum of a geometric series.
    noise = math.sqrt(1.0 / 3.0)
    assert jumped.std() / (RATE * REPRESENTED) == pytest.approx(noise / math.sqrt(38.0), rel=0.15)
    kept = noise / 40.0 / math.sqrt(1.0 - 0.75**2)
    assert steps.std() / (RATE * REPRESENTED) == pytest.approx(kept, rel=0.15)


def test_starts_share_no_surface(campaign: Campaign) -> None:
    """What one start sees is its own wear alone, and the interval is that of the starts."""

    def own(run: int, depth: Array) -> Array:
        return constant(run, depth) * (1.0 + 0.1 * (run % 2))

    stages = campaign(replace(SCENE, wear_updates=1, cycles=1), FakeEngine(own)).stages
    joint = stages[0].joints["A"]
    assert len(joint.arrays["wear_batches"]) == 2
    np.testing.assert_allclose(joint.depth("bearing"), 0.0)


def test_behind_a_jump_starts_run_together_and_alone(campaign: Campaign) -> None:
    """The numbers are of the mean map, the interval of starts that share no surface."""
    seen: dict[int, Array] = {}

    def answering(run: int, depth: Array) -> Array:
        seen[run] = depth.copy()
        return uneven(run, depth) + depth / REPRESENTED

    stages = campaign(replace(SCENE, extrapolation="single"), FakeEngine(answering)).stages
    assert sorted(seen) == list(range(1, 11))
    jump = REPRESENTED * RATE * SHAPE
    first, second = 0.3, 2.7
    shares = {3: 1.5, 4: 1.5, 5: first, 6: second}
    for run, share in shares.items():
        np.testing.assert_allclose(seen[run][0], share * jump, rtol=1e-12)
    # Shares of the third to the sixth run, and as much again as the surfaces are worn.
    together = 1.5 + 0.5 * (0.9 + 1.0) + 1.5
    alone = [first + 0.3 + first, second + 2.7 + second]
    for run, share in {7: together, 8: together, 9: alone[0], 10: alone[1]}.items():
        np.testing.assert_allclose(seen[run][0], share * jump, rtol=1e-12)
    joint = stages[2].joints["A"]
    np.testing.assert_allclose(joint.depth("bearing"), together * jump[0], rtol=1e-12)
    own = stages[1].joints["A"]
    volume = worn_volume(wear_times().linkage().clearances[0], jump)
    added = np.array([first + 0.3, second + 2.7]) * volume
    assert own.statistics.wear_volume.mean == pytest.approx(2.45 * volume, abs=0.0)
    half = half_width(added)
    assert half is not None
    expected = math.hypot(half, 2.45 * volume - added.mean())
    assert own.statistics.wear_volume.half_width == pytest.approx(expected, abs=0.0)
    force = own.statistics.peak_force_per_cycle
    half = half_width(np.array([500.0, 600.0]))
    assert half is not None
    assert force.mean == 350.0
    assert force.half_width == pytest.approx(math.hypot(half, 550.0 - 350.0))


def test_single_jumps_are_those_of_the_paper(campaign: Campaign) -> None:
    """To the last bit: depth of the cycles times represented cycles over cycles."""
    engine = FakeEngine(uneven)
    seen = campaign(replace(SCENE, extrapolation="single", cycles=7, replicates=1), engine)
    assert engine.runs == 3
    worn = np.zeros((2, 2, 360))
    for run, stage in enumerate(seen.stages, start=1):
        joints = stage.joints.values()
        assert np.array_equal([both(joint, joint.depth) for joint in joints], worn)
        assert stage.amplification == REPRESENTED / 5
        maps = MapBatches((2, 2, 360))
        for _ in range(7):
            maps.add(uneven(run, worn))
        added = np.stack([both(joint, joint.wear) for joint in joints])
        assert np.array_equal(added, mean_map([maps]) * REPRESENTED)
        worn = worn + added
    assert [len(stage.wear_steps) for stage in seen.stages] == [1, 1, 0]


def test_a_stage_runs_on_the_wear_before_it(campaign: Campaign) -> None:
    seen = campaign(SCENE, FakeEngine(exponential))
    for before, after in pairwise(seen.stages):
        for name, joint in before.joints.items():
            there = both(after.joints[name], after.joints[name].depth)
            added = both(joint, joint.wear)
            np.testing.assert_allclose(there, both(joint, joint.depth) + added, rtol=1e-12)
            area = 0.02 * 0.015 * 2.0 * math.pi / 360
            volume = joint.statistics.wear_volume.mean
            assert volume == pytest.approx(area * added.sum(), rel=1e-12, abs=0.0)


def test_failure_inside_a_wear_names_the_pass_and_keeps_the_stage(campaign: Campaign) -> None:
    """Stage 0 and two passes, stage 1, then the second pass of the second wear."""
    seen = campaign(SCENE, FakeEngine(constant, fails=12))
    assert seen.status == "failed"
    assert seen.message == "second wear in 6 steps: the solver found no step (t = 0.1 s)"
    assert [stage.index for stage in seen.stages] == [0, 1]
    # The half-way pass is what is known of it.
    assert [len(stage.wear_steps) for stage in seen.stages] == [6, 3]
    assert seen.stages[1].status == "completed"


def test_a_set_that_fails_does_not_mix_with_the_other(campaign: Campaign) -> None:
    """Five runs of two sets of three: what is told of those alone is of the last two only."""
    scene = replace(SCENE, extrapolation="single", wear_updates=1, replicates=3)
    seen = campaign(scene, FakeEngine(constant, fails=8))
    assert seen.status == "failed"
    force = seen.stages[1].joints["A"].statistics.peak_force_per_cycle
    # Runs 4, 5 and 6 together, 7 and 8 alone, each a hundred times its number.
    assert force.mean == 500.0
    half = half_width(np.array([700.0, 800.0]))
    assert half is not None
    assert force.half_width == pytest.approx(math.hypot(half, 750.0 - 500.0))


@pytest.mark.parametrize(
    ("extrapolation", "where"),
    [("steps", "the first wear in 3 steps:"), ("single", "after stage 0")],
)
def test_a_surface_worn_through_is_named(
    campaign: Campaign, extrapolation: str, where: str
) -> None:
    scene = replace(SCENE, extrapolation=extrapolation, cycles_per_update=1e3 * REPRESENTED)
    seen = campaign(scene, FakeEngine(constant))
    assert seen.status == "failed"
    assert seen.message.startswith(f"joint A: {where} the bearing would lose")
    assert "more than the clearance of 0.0008 m" in seen.message
    (stage,) = seen.stages
    assert stage.finding is not None
    assert (stage.finding.kind, stage.finding.joint) == ("wear", "A")


def test_a_stage_outlives_an_interrupted_wear(monkeypatch: pytest.MonkeyPatch) -> None:
    engine = FakeEngine(constant, stopped=5)
    use(engine, monkeypatch)
    seen = Seen()
    with pytest.raises(KeyboardInterrupt):
        run_campaign(SCENE, [seen])
    assert [(stage.index, len(stage.wear_steps)) for stage in seen.stages] == [(0, 3)]


@pytest.mark.parametrize("cycles", [CYCLES, None])
def test_progress_never_falls_and_names_the_pass(campaign: Campaign, cycles: int | None) -> None:
    seen = campaign(replace(SCENE, cycles=cycles), FakeEngine(exponential))
    for index in range(3):
        parts = [told.part for told in seen.told if told.stage == index]
        assert parts == sorted(parts)
        assert parts[-1] > 0.85
    assert seen.wholes == sorted(seen.wholes)
    assert seen.wholes[-1] > 0.95
    words = [told.word for told in seen.told if told.stage == 1]
    assert any(word.startswith("second wear in ") for word in words)


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Fast cycles of the press in the in-house solver, worn once in steps, stored."""
    scene = wear_times(speed=60.0)
    scene = replace(
        scene,
        conventions=CONVENTIONS["refined"],
        engine="dae",
        cycles=4,
        replicates=2,
        wear_updates=1,
        cycles_per_update=1e6,
    )
    path = tmp_path_factory.mktemp("result") / "steps"
    pw.run(scene, path)
    return path


def test_the_press_wears_in_steps(real: Path) -> None:
    result = load(real)
    assert result.status == "completed"
    steps = result.stages[0].wear_steps
    assert len(steps) == 4
    assert result.stages[1].wear_steps == ()
    for joint in "AC":
        for side in ("bearing", "pin"):
            before, after = (stage.joints[joint].depth(side) for stage in result.stages)
            np.testing.assert_allclose(after - before, result.stages[0].joints[joint].wear(side))
            deepest = [step.max_depth[joint][side] for step in steps]
            assert deepest == sorted(deepest)
    assert len({step.peak_force["A"] for step in steps}) == len(steps)


def test_a_wear_without_a_coarser_pass_is_not_known() -> None:
    joints = wear_times().linkage().clearances
    added = np.ones((3, 2, 2, 360))
    assert wear_error(joints, WearUpdate(added, added, ())) == math.inf
    assert wear_error(joints, WearUpdate(added, added, (), added)) < 1e-14
    assert wear_error(joints, WearUpdate(added, added, (), 1.5 * added)) == pytest.approx(0.5)


def test_what_is_not_reached_says_what_it_would_take(campaign: Campaign) -> None:
    scene = replace(SCENE, cycles=None, wear_updates=1, tolerance=0.02, max_cycles=70)
    seen = campaign(scene, FakeEngine(exponential))
    assert seen.status == "unconverged"
    assert "the wear of stage 0 is known to 2.3 % where tolerance = 2 % was asked" in seen.message
    assert "about max_cycles = 1.3e+02 would do" in seen.message
    enough = campaign(replace(scene, max_cycles=130), FakeEngine(exponential))
    assert (enough.status, enough.message) == ("completed", "")


@given(st.integers(0, 10_000))
def test_no_cycle_gives_material_back(seed: int) -> None:
    """A correction that is below zero at places takes its volume from the others."""
    draw = np.random.default_rng(seed)
    added = draw.random((2, 2, 16)) * 1e-12
    extra = draw.normal(-1e-12, 6e-12, (2, 2, 16))
    extra[0, 0] = -1e-10
    lost = wear_per_cycle(40.0, 4, extra)(STARTUP_CYCLES + 1, added)
    assert lost.min() >= 0.0
    volume = np.maximum((10.0 * added + extra).sum(axis=-1), 0.0)
    np.testing.assert_allclose(lost.sum(axis=-1), volume, rtol=1e-12, atol=1e-24)
    plain = wear_per_cycle(40.0, 4)(STARTUP_CYCLES + 1, added)
    np.testing.assert_array_equal(plain, 10.0 * added)
