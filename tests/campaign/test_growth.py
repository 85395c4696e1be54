"""Wear updates: wear laws in closed form under an engine that does nothing else."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from campaign.fake_engine import (
    CLEARANCE,
    JUMPS,
    RATE,
    REPRESENTED,
    RUN_IN,
    RUNS_IN,
    SCENE,
    SHAPE,
    FakeEngine,
    added_to,
    constant,
    depth_of,
    exponential,
    half_of,
    uneven,
)
from presswear.campaign.wear_update import FIRST_REFINEMENT
from presswear.engines.base import Plan, Run, Start
from presswear.linkage.linkage import Linkage
from presswear.physics.wear import worn_volume
from presswear.recording.statistics import (
    MapBatches,
    mean_map,
    smoothing_widths,
)
from presswear.scene.catalog import wear_times
from presswear.scene.settings import changed
from presswear.tools.arrays import Array


@pytest.mark.parametrize("cycles", [1, 2, 7])
def test_constant_rate_is_exact_in_any_number_of_steps(campaign, cycles):
    seen = campaign(SCENE, FakeEngine(constant), cycles=cycles)
    assert seen.status == "completed"
    for stage in seen.stages[:2]:
        assert len(stage.wear_steps) == cycles
        total = math.fsum(step.cycles_per_update for step in stage.wear_steps)
        assert total == pytest.approx(REPRESENTED, rel=1e-14)
        expected = REPRESENTED * constant(0, np.zeros(0))
        for (name, joint), added in zip(stage.joints.items(), expected, strict=True):
            assert_allclose(added_to(joint), added, rtol=1e-12)
            depth = depth_of(seen.stages[stage.index + 1].joints[name])
            assert_allclose(depth, (stage.index + 1.0) * added, rtol=1e-12)
            deepest = list(stage.wear_steps[-1].max_depth[name].values())
            assert_allclose(deepest, depth.max(axis=1), rtol=1e-12)
            area = 0.02 * 0.015 * 2.0 * math.pi / 360
            volume = joint.statistics.wear_volume.mean
            assert volume == pytest.approx(area * added.sum(), rel=1e-12, abs=0.0)


def test_refinements_and_stages_start_differently(campaign):
    """Replicates of different refinements are independent; stages start alike."""
    starts: list[bytes] = []

    class Noting(FakeEngine):
        def __call__(self, linkage: Linkage, start: Start, plan: Plan) -> Run:
            starts.append(start.position.tobytes())
            return super().__call__(linkage, start, plan)

    campaign(SCENE, Noting(constant), wear_updates=1)
    stage, coarse, fine, worn = (set(starts[k : k + 2]) for k in (0, 2, 4, 6))
    assert len(starts) == 8
    assert len(stage | coarse | fine) == 6
    assert worn == stage


def test_coarser_refinement_shows_the_error_of_the_step(campaign):
    """A rate that grows with depth; explicit Euler steps in represented cycles."""
    exact = RATE * REPRESENTED * (math.e - 1.0)
    errors = []
    for cycles in (32, 64):
        engine = FakeEngine(exponential)
        seen = campaign(SCENE, engine, cycles=cycles, wear_updates=1, replicates=3)
        peak = seen.stages[0].joints["A"].statistics.wear_peaks["bearing"]
        errors.append(exact - peak.depth.mean / SHAPE[0].max())
        # Of first order: half the steps are off by twice as much. It is stated doubled.
        assert peak.step_error == pytest.approx(2.0 * errors[-1], rel=0.15)
        # The interval of the logarithm
        part = peak.step_error / peak.depth.mean
        assert peak.depth.high == pytest.approx(peak.depth.mean * math.exp(part))
        assert peak.depth.low == pytest.approx(peak.depth.mean * math.exp(-part))
    assert errors[0] / errors[1] == pytest.approx(2.0, rel=0.06)


def test_refinements_continue_until_the_wear_is_known(campaign):
    settings = {"cycles": None, "wear_updates": 1, "tolerance": 0.04}
    seen = campaign(SCENE, FakeEngine(exponential), **settings)
    # The error of the step is e / (e - 1) / 2, part of the wear, over the cycles;
    # twice that is stated.
    assert len(seen.stages[0].wear_steps) == 8 * FIRST_REFINEMENT
    seen = campaign(SCENE, FakeEngine(exponential), **settings, max_cycles=70)
    assert len(seen.stages[0].wear_steps) == 4 * FIRST_REFINEMENT
    assert seen.status == "unconverged"
    assert (
        "the error of the first wear, 4.7 %, exceeds tolerance = 4 %: about"
        in seen.message
    )
    assert "about max_cycles = 128 is needed" in seen.message
    enough = campaign(SCENE, FakeEngine(exponential), **settings, max_cycles=128)
    assert (enough.status, enough.message) == ("completed", "")


def test_smoothing_that_lowers_a_narrow_groove_widens_its_interval(campaign):
    """Replicates that are smoothed alike do not show it. Variances of Gaussians add up."""
    generator = np.random.default_rng(4)
    size = 4.0
    groove = np.exp(-0.5 * ((np.arange(360) - 60.0) / size) ** 2)
    depths = np.repeat(groove[np.newaxis], 16, axis=0).reshape(4, 2, 2, 360)
    # Noise far from the groove
    depths[..., 150:300] += generator.gamma(1.0, 0.2, (4, 2, 2, 150))
    settings = {"replicates": 4, "wear_updates": 1, "cycles": 8}
    engine = FakeEngine(lambda run, worn: RATE * depths[run % 4])
    joint = campaign(SCENE, engine, **settings).stages[0].joints["A"]
    peak = joint.statistics.wear_peaks["bearing"].depth
    width = smoothing_widths(depths.mean(axis=0), 4, depths, np.ones(4), [360, 360])[
        0, 0
    ]
    once, twice = (size / math.hypot(size, math.sqrt(n) * width) for n in (1, 2))
    assert peak.mean == pytest.approx(once * RATE * REPRESENTED, rel=1e-3)
    # The interval is that of the logarithm.
    lost = math.log(peak.high / peak.mean)
    assert lost == pytest.approx(1.0 - twice / once, rel=0.01)


def test_replicates_after_a_jump_run_together_and_alone(campaign):
    """The numbers are of the mean map, the interval of replicates that share no surface."""
    seen: dict[int, Array] = {}

    def answering(run: int, depth: Array) -> Array:
        seen[run] = depth.copy()
        return uneven(run, depth) + depth / REPRESENTED

    stages = campaign(JUMPS, FakeEngine(answering)).stages
    jump = REPRESENTED * RATE * SHAPE
    first = 0.3
    second = 2.7
    # Shares of the third to the sixth run, and as much again as the surfaces are worn.
    together = 1.5 + 0.5 * (0.9 + 1.0) + 1.5
    alone = [first + 0.3 + first, second + 2.7 + second]
    shares = [0.0, 0.0, 1.5, 1.5, first, second, together, together, *alone]
    assert sorted(seen) == list(range(1, 11))
    for run, share in enumerate(shares, start=1):
        assert_allclose(seen[run][0], share * jump, rtol=1e-12)
    joint = stages[2].joints["A"]
    assert_allclose(joint.depth("bearing"), together * jump[0], rtol=1e-12)
    statistics = stages[1].joints["A"].statistics
    volume = worn_volume(wear_times().linkage().clearances[0], jump)
    added = np.array([first + 0.3, second + 2.7]) * volume
    assert statistics.wear_volume.mean == pytest.approx(2.45 * volume, abs=0.0)
    # More than ten times the mean would be in the interval.
    half = math.hypot(half_of(*added), 2.45 * volume - added.mean())
    assert half > math.log(10.0) * 2.45 * volume
    assert statistics.wear_volume.high is None
    force = statistics.peak_force_per_cycle
    assert force.mean == 350.0
    half = math.hypot(half_of(500.0, 600.0), 550.0 - 350.0)
    assert force.high == pytest.approx(350.0 * math.exp(half / 350.0))


def test_jumps_are_those_of_the_paper_bit_for_bit(campaign):
    engine = FakeEngine(uneven)
    seen = campaign(JUMPS, engine, cycles=7, replicates=1)
    assert engine.runs == 3
    worn = np.zeros((2, 2, 360))
    for run, stage in enumerate(seen.stages, start=1):
        joints = stage.joints.values()
        assert np.array_equal([*map(depth_of, joints)], worn)
        assert stage.cycles_per_update == REPRESENTED
        maps = MapBatches((2, 2, 360))
        for _ in range(7):
            maps.add(uneven(run, worn))
        added = np.stack([*map(added_to, joints)])
        assert np.array_equal(added, mean_map([maps]) * REPRESENTED)
        worn = worn + added
    assert [len(stage.wear_steps) for stage in seen.stages] == [1, 1, 0]


def test_failed_wear_update_names_the_refinement_and_keeps_the_stage(campaign):
    """Stage 0, two refinements, stage 1, then the second refinement after it."""
    seen = campaign(SCENE, FakeEngine(constant, fails=12))
    assert seen.status == "failed"
    assert (
        seen.message == "second wear in 6 steps: the solver found no step (t = 0.1 s)"
    )
    # The first refinement is what is known of it.
    steps = [
        (stage.index, len(stage.wear_steps), stage.status) for stage in seen.stages
    ]
    assert steps == [(0, 6, "completed"), (1, 3, "completed")]


@pytest.mark.parametrize(
    ("scene", "factor", "where"),
    [
        (SCENE, 1e3, "in half of the first wear at the present rate"),
        (SCENE, 25.0, "the first wear in 3 steps:"),
        (SCENE, 16.0, "in half of the second wear at the present rate"),
        (JUMPS, 1e3, "after stage 0"),
    ],
)
def test_surface_worn_through_is_named(campaign, scene, factor, where):
    """The first one before any wear is computed, and each with a number of cycles that works."""
    seen = campaign(scene, FakeEngine(constant), cycles_per_update=factor * REPRESENTED)
    assert seen.status == "failed"
    tenth = f"cycles_per_update = {2.0 * REPRESENTED:.1g} wears it by about a tenth"
    assert tenth in seen.message
    assert seen.message.startswith(f"joint A: {where} the bearing would lose")
    assert "more than 800 µm, with a clearance of 800 µm;" in seen.message
    stage = seen.stages[-1]
    assert (stage.finding.kind, stage.finding.joint) == ("wear", "A")


@pytest.mark.parametrize("scene", [SCENE, JUMPS])
def test_an_update_wears_a_tenth_of_the_clearance_by_default(campaign, scene):
    seen = campaign(scene, FakeEngine(constant), cycles_per_update=None)
    assert {stage.cycles_per_update for stage in seen.stages} == {2.0 * REPRESENTED}
    depth = [stage.joints["A"].depth("bearing").max() for stage in seen.stages]
    assert_allclose(depth, CLEARANCE * np.array([0.0, 0.1, 0.2]), rtol=0.01)


@pytest.mark.parametrize("scene", [SCENE, JUMPS])
def test_surfaces_run_in_alike_in_any_number_of_steps(campaign, scene):
    for cycles in (1, 7):
        seen = campaign(changed(scene, RUN_IN), FakeEngine(constant), cycles=cycles)
        archard = REPRESENTED * constant(0, np.zeros(0))
        for stage in seen.stages[:2]:
            worn = zip(stage.joints.items(), archard, strict=True)
            for (name, joint), added in worn:
                before = RUNS_IN.worn(np.zeros(360), stage.index * added)
                expected = RUNS_IN.worn(before, added)
                assert_allclose(added_to(joint), expected, rtol=1e-9)
                depth = depth_of(seen.stages[stage.index + 1].joints[name])
                assert_allclose(depth, before + expected, rtol=1e-9)
    (default,) = {
        stage.cycles_per_update
        for stage in campaign(
            changed(scene, RUN_IN), FakeEngine(constant), cycles_per_update=None
        ).stages[:1]
    }
    tenth = RUNS_IN.archard_depth(np.array(0.1 * CLEARANCE))
    assert default == pytest.approx(float(tenth) / RATE, rel=0.2)
