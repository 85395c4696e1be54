"""Wear updates: wear laws in closed form under an engine that does nothing else."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rich.console import Console
from scipy import stats

from presswear.campaign import runs
from presswear.campaign.campaign import run_campaign
from presswear.campaign.wear_update import FIRST_REFINEMENT
from presswear.cli import run_observer
from presswear.cli.life import announcing
from presswear.cli.run_observer import RunObserver
from presswear.cli.terminal import progress_bar
from presswear.engines.base import Plan, Run, Start, Status, recorder_of
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.linkage import Linkage
from presswear.linkage.materials import Materials
from presswear.linkage.surface import SIDES, bin_centres
from presswear.physics.running_in import RunningIn
from presswear.physics.wear import worn_volume
from presswear.recording.observer import Observer, Progress
from presswear.recording.soundness import Finding
from presswear.recording.statistics import (
    STARTUP_CYCLES,
    MapBatches,
    half_width,
    mean_map,
    smoothing_widths,
)
from presswear.results.export import life_table
from presswear.results.joint_result import JointResult
from presswear.results.life import LifeResult
from presswear.results.result import load, unfinished
from presswear.results.stage import StageResult
from presswear.scene.bearing import Bearing
from presswear.scene.catalog import wear_times
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.options import Life
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.show.report import render_report
from presswear.tools.arrays import Array, named, part
from presswear.tools.errors import InputError

Law = Callable[[int, Array], Array]
"""Number of the run, and depth of the surfaces, shape (joints, 2, m): depth of one cycle, m."""


@dataclass
class FakeEngine:
    """Engine that wears by a law; runs are numbered from 1, and one of them may fail."""

    law: Law
    fails: int = 0
    runs: int = 0

    def __call__(self, linkage: Linkage, start: Start, plan: Plan) -> Run:
        self.runs += 1
        recorder = recorder_of(linkage, start, plan)
        recorder.records.output["now"] = plan.cycle * plan.cycles
        if plan.resume is not None:
            recorder.load(part(plan.resume, "recorder"))
        status: Status = "completed"
        for cycle in range(len(recorder.cycles), plan.cycles):
            recorder.records.nominal["now"] = (cycle + 0.5) * plan.cycle
            plan.advanced(recorder)
            recorder.records.cycle[:] = 100.0 * self.runs
            worn = recorder.surface_depth
            worn = worn if worn.size else np.zeros(recorder.records.depth.shape)
            recorder.records.depth[...] = self.law(self.runs, worn)
            added = recorder.end_cycle()
            if plan.wear is not None:
                depth = recorder.surface_depth
                recorder.wear(plan.wear(cycle + 1, added, depth), lambda: None)
            state = partial(named, "recorder", recorder.save())
            if any(observer.on_cycle(recorder, state) for observer in plan.observers):
                status = "enough" if cycle + 1 < plan.cycles else "completed"
                break
        finding = None
        if self.runs == self.fails:
            status = "failed"
            finding = Finding("state", "the solver found no step", 0.1, "", "")
        solved: dict[str, Any] = {"model": "none", "steps": 1}
        solved |= {"energy_residual_J": 0.0, "drive_exchange_J": 0.0}
        return Run(status, finding, recorder, start, plan.cycle * plan.cycles, solved)


class Seen(Observer):
    """Stages, progress and outcome of a campaign."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.progress: list[Progress] = []
        self.life: LifeResult | None = None
        self.status = self.message = ""

    def on_progress(self, progress: Progress) -> None:
        self.progress.append(progress)

    def on_life(self, life: LifeResult) -> None:
        self.life = life

    def on_stage(self, stage: StageResult) -> None:
        self.stages.append(stage)


CLEARANCE = 0.8e-3
CYCLES = 6
REPRESENTED = 4e6
RATE = 0.05 * CLEARANCE / REPRESENTED
"""Depth of one cycle where it is deepest: an update wears a twentieth of the clearance, m."""

SCENE = replace(
    wear_times(),
    cycles=CYCLES,
    wear_updates=2,
    replicates=2,
    cycles_per_update=REPRESENTED,
    extrapolation="steps",
)
JUMPS = replace(SCENE, extrapolation="single")
SHAPE = np.stack(
    [np.exp(np.cos(bin_centres(360)) - 1.0), 0.3 + 0.2 * np.sin(bin_centres(360))]
)
"""Wear of bearing and pin; its largest value is that of the bearing, near 1."""


def constant(run: int, depth: Array) -> Array:
    return np.stack([RATE * SHAPE, 0.4 * RATE * SHAPE])


def uneven(run: int, depth: Array) -> Array:
    """Return rates that come and go from run to run, as in a chaotic motion."""
    return constant(run, depth) * (1.0, 0.3, 2.7, 0.9)[run % 4]


def exponential(run: int, depth: Array) -> Array:
    """Return dh/dN = a + b h: the depth grows to a (exp(b N) - 1) / b."""
    return RATE * SHAPE + depth / REPRESENTED


def depth_of(joint: JointResult) -> Array:
    return np.stack([joint.depth(side) for side in SIDES])


def added_to(joint: JointResult) -> Array:
    return np.stack([joint.wear(side) for side in SIDES])


def half_of(*values: float) -> float:
    return half_width(np.array(values)) or math.nan


Campaign = Callable[..., Seen]
Use = Callable[[FakeEngine], None]


@pytest.fixture
def use(monkeypatch: pytest.MonkeyPatch) -> Use:
    """Return a function that puts a fake engine in place of any."""

    def replace_all(engine: FakeEngine) -> None:
        for kind in (ExudynTree, ExudynJoints, InHouse):
            monkeypatch.setattr(kind, "simulate", lambda self, *given: engine(*given))

    return replace_all


@pytest.fixture
def campaign(use: Use) -> Campaign:
    """Return a function that runs a campaign with a fake engine."""

    def run_with(scene: Scene, engine: FakeEngine, **settings: Any) -> Seen:
        use(engine)
        seen = Seen()
        seen.status, seen.message, _ = run_campaign(replace(scene, **settings), [seen])
        return seen

    return run_with


@pytest.mark.parametrize("cycles", [1, 2, 7])
def test_constant_rate_is_exact_in_any_number_of_steps(
    campaign: Campaign, cycles: int
) -> None:
    seen = campaign(SCENE, FakeEngine(constant), cycles=cycles)
    assert seen.status == "completed"
    for stage in seen.stages[:2]:
        assert len(stage.wear_steps) == cycles
        total = math.fsum(step.cycles_per_update for step in stage.wear_steps)
        assert total == pytest.approx(REPRESENTED, rel=1e-14)
        expected = REPRESENTED * constant(0, np.zeros(0))
        for (name, joint), added in zip(stage.joints.items(), expected, strict=True):
            np.testing.assert_allclose(added_to(joint), added, rtol=1e-12)
            depth = depth_of(seen.stages[stage.index + 1].joints[name])
            np.testing.assert_allclose(depth, (stage.index + 1.0) * added, rtol=1e-12)
            deepest = list(stage.wear_steps[-1].max_depth[name].values())
            np.testing.assert_allclose(deepest, depth.max(axis=1), rtol=1e-12)
            area = 0.02 * 0.015 * 2.0 * math.pi / 360
            volume = joint.statistics.wear_volume.mean
            assert volume == pytest.approx(area * added.sum(), rel=1e-12, abs=0.0)


def test_factor_of_a_wear_step_is_the_number_of_strokes_that_a_cycle_wears(
    campaign: Campaign,
) -> None:
    """The deepest place grows by the factor times the depth that a cycle wears."""
    for step in campaign(SCENE, FakeEngine(constant)).stages[0].wear_steps:
        assert (step.cycles, step.factor) == (2, REPRESENTED / CYCLES)
    deepest = RATE * SHAPE[0].max()
    for scene, wearing in (SCENE, CYCLES), (JUMPS, CYCLES - STARTUP_CYCLES):
        steps = campaign(scene, FakeEngine(constant)).stages[0].wear_steps
        assert sum(step.cycles for step in steps) == 2 * wearing
        worn = sum(step.factor * step.cycles / 2 for step in steps) * deepest
        assert worn == pytest.approx(steps[-1].max_depth["A"]["bearing"], rel=1e-12)


def test_refinements_and_stages_start_differently(campaign: Campaign) -> None:
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


def test_coarser_refinement_shows_the_error_of_the_step(campaign: Campaign) -> None:
    """A rate that grows with depth; explicit Euler steps in represented cycles."""
    exact = RATE * REPRESENTED * (math.e - 1.0)
    errors = []
    for cycles in (32, 64, 128):
        engine = FakeEngine(exponential)
        seen = campaign(SCENE, engine, cycles=cycles, wear_updates=1, replicates=3)
        peak = seen.stages[0].joints["A"].statistics.wear_peaks["bearing"]
        errors.append(exact - peak.depth.mean / SHAPE[0].max())
        # Of first order: half the steps are off by twice as much. It is stated doubled.
        assert peak.step_error == pytest.approx(2.0 * errors[-1], rel=0.15)
        # The interval of the logarithm
        part = (peak.step_error or 0.0) / peak.depth.mean
        assert peak.depth.high == pytest.approx(peak.depth.mean * math.exp(part))
        assert peak.depth.low == pytest.approx(peak.depth.mean * math.exp(-part))
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 2.0, rtol=0.06)


def test_refinements_continue_until_the_wear_is_known(campaign: Campaign) -> None:
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


def test_noise_is_worn_away_or_smoothed_and_kept_by_a_raw_jump(
    campaign: Campaign,
) -> None:
    """dh/dN = (a - h) / N with noise of the size of the wear itself."""
    generator = np.random.default_rng(1)
    depth = RATE * REPRESENTED

    def noisy(run: int, worn: Array) -> Array:
        noise = generator.uniform(0.0, 2.0, worn.shape)
        return (noise * depth + 10.0 * (depth - worn)) / REPRESENTED

    raw = replace(JUMPS, conventions=CONVENTIONS["paper"])
    steps, jumped, smoothed = (
        campaign(scene, FakeEngine(noisy), cycles=40, wear_updates=1, replicates=1)
        .stages[1]
        .joints["A"]
        .depth("pin")
        for scene in (SCENE, raw, JUMPS)
    )
    assert smoothed.mean() == pytest.approx(11.0 * depth, rel=0.02)
    assert smoothed.std() < 0.2 * jumped.std()
    assert steps.mean() == pytest.approx(1.1 * depth, rel=0.02)
    assert jumped.mean() == pytest.approx(11.0 * depth, rel=0.02)
    # Each step keeps three quarters of the noise before it: the sum of a geometric
    # series.
    noise = math.sqrt(1.0 / 3.0)
    assert jumped.std() / depth == pytest.approx(noise / math.sqrt(38.0), rel=0.15)
    assert steps.std() / depth == pytest.approx(
        noise / 40.0 / math.sqrt(1.0 - 0.75**2), rel=0.15
    )


def test_smoothing_that_lowers_a_narrow_groove_widens_its_interval(
    campaign: Campaign,
) -> None:
    """Replicates that are smoothed alike do not show it. Variances of Gaussians add up."""
    generator = np.random.default_rng(4)
    size = 4.0
    groove = np.exp(-0.5 * ((np.arange(360) - 60.0) / size) ** 2)
    depths = np.repeat(groove[np.newaxis], 16, axis=0).reshape(4, 2, 2, 360)
    depths[..., 150:300] += generator.gamma(
        1.0, 0.2, (4, 2, 2, 150)
    )  # far from the groove
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
    lost = math.log((peak.high or 0.0) / peak.mean)
    assert lost == pytest.approx(1.0 - twice / once, rel=0.01)


def test_replicates_after_a_jump_run_together_and_alone(campaign: Campaign) -> None:
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
        np.testing.assert_allclose(seen[run][0], share * jump, rtol=1e-12)
    joint = stages[2].joints["A"]
    np.testing.assert_allclose(joint.depth("bearing"), together * jump[0], rtol=1e-12)
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


def test_jumps_are_those_of_the_paper_bit_for_bit(campaign: Campaign) -> None:
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


def test_failed_wear_update_names_the_refinement_and_keeps_the_stage(
    campaign: Campaign,
) -> None:
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


def test_failed_set_does_not_mix_with_the_other(campaign: Campaign) -> None:
    """Runs 4, 5 and 6 together, 7 and 8 alone, each with a force of a hundred times its number."""
    seen = campaign(JUMPS, FakeEngine(constant, fails=8), wear_updates=1, replicates=3)
    assert seen.status == "failed"
    force = seen.stages[1].joints["A"].statistics.peak_force_per_cycle
    assert force.mean == 500.0
    half = math.hypot(half_of(700.0, 800.0), 750.0 - 500.0)
    assert force.high == pytest.approx(500.0 * math.exp(half / 500.0))


@pytest.mark.parametrize(
    ("scene", "factor", "where"),
    [
        (SCENE, 1e3, "in half of the first wear at the present rate"),
        (SCENE, 25.0, "the first wear in 3 steps:"),
        (SCENE, 16.0, "in half of the second wear at the present rate"),
        (JUMPS, 1e3, "after stage 0"),
    ],
)
def test_surface_worn_through_is_named(
    campaign: Campaign, scene: Scene, factor: float, where: str
) -> None:
    """The first one before any wear is computed, and each with a number of cycles that works."""
    seen = campaign(scene, FakeEngine(constant), cycles_per_update=factor * REPRESENTED)
    assert seen.status == "failed"
    tenth = f"cycles_per_update = {2.0 * REPRESENTED:.1g} wears it by about a tenth"
    assert tenth in seen.message
    assert seen.message.startswith(f"joint A: {where} the bearing would lose")
    assert "more than 800 µm, with a clearance of 800 µm;" in seen.message
    stage = seen.stages[-1]
    assert stage.finding is not None
    assert (stage.finding.kind, stage.finding.joint) == ("wear", "A")


@pytest.mark.parametrize("scene", [SCENE, JUMPS])
def test_an_update_wears_a_tenth_of_the_clearance_by_default(
    campaign: Campaign, scene: Scene
) -> None:
    seen = campaign(scene, FakeEngine(constant), cycles_per_update=None)
    assert {stage.cycles_per_update for stage in seen.stages} == {2.0 * REPRESENTED}
    depth = [stage.joints["A"].depth("bearing").max() for stage in seen.stages]
    np.testing.assert_allclose(depth, CLEARANCE * np.array([0.0, 0.1, 0.2]), rtol=0.01)


@pytest.mark.parametrize("cycles", [CYCLES, None])
def test_progress_never_falls_and_names_the_refinement(
    campaign: Campaign, cycles: int | None
) -> None:
    progress = campaign(SCENE, FakeEngine(exponential), cycles=cycles).progress
    for index in range(3):
        parts = [each.part for each in progress if each.stage == index]
        assert parts == sorted(parts)
        assert parts[-1] > 0.85
    wholes = [each.whole for each in progress]
    assert wholes == sorted(wholes)
    assert wholes[-1] > 0.95
    assert any(
        each.word.startswith("second wear in ") for each in progress if each.stage == 1
    )


def test_a_stage_is_expected_to_take_the_cycles_of_the_one_before(
    campaign: Campaign,
) -> None:
    """Replicates that differ take all cycles that are allowed."""
    settings = {
        "cycles": None,
        "max_cycles": 60,
        "wear_updates": 1,
        "cycles_per_update": 10.0,
    }
    progress = campaign(SCENE, FakeEngine(uneven), **settings).progress
    words = [
        each.word
        for each in progress
        if each.stage == 1 and each.word.startswith("cycle")
    ]
    first = [
        each.word
        for each in progress
        if each.stage == 0 and each.word.startswith("cycle")
    ]
    assert first[0].endswith("of 12")
    assert words[0].endswith("of 30")


LIFE = replace(
    SCENE,
    conventions=CONVENTIONS["refined"],
    life=Life(until="A.depth > 0.3 mm"),
    wear_updates=1,
)
"""Joints that wear by ``exponential`` in equal replicates: only the steps have an error."""


class Stops(Observer):
    """Interrupts a life in a refinement."""

    def __init__(self, number: int) -> None:
        self._word = f"refinement {number}"

    def on_progress(self, progress: Progress) -> None:
        if self._word in progress.word:
            raise KeyboardInterrupt


def interrupted_life(path: Path, use: Use, number: int, tolerance: float) -> Scene:
    """Interrupt a life in a refinement; return its scene."""
    scene = replace(LIFE, tolerance=tolerance)
    use(FakeEngine(exponential))
    with pytest.raises(KeyboardInterrupt):
        runs.run(scene, path, observers=[Stops(number)], jobs=1)
    return scene


RUNS_IN = RunningIn(30.0, 20e-6)
RUN_IN = {"running_in": 30.0, "running_in_depth": "20 um"}


@pytest.mark.parametrize("scene", [SCENE, JUMPS])
def test_surfaces_run_in_alike_in_any_number_of_steps(
    campaign: Campaign, scene: Scene
) -> None:
    for cycles in (1, 7):
        seen = campaign(changed(scene, RUN_IN), FakeEngine(constant), cycles=cycles)
        archard = REPRESENTED * constant(0, np.zeros(0))
        for stage in seen.stages[:2]:
            worn = zip(stage.joints.items(), archard, strict=True)
            for (name, joint), added in worn:
                before = RUNS_IN.worn(np.zeros(360), stage.index * added)
                expected = RUNS_IN.worn(before, added)
                np.testing.assert_allclose(added_to(joint), expected, rtol=1e-9)
                depth = depth_of(seen.stages[stage.index + 1].joints[name])
                np.testing.assert_allclose(depth, before + expected, rtol=1e-9)
    (default,) = {
        stage.cycles_per_update
        for stage in campaign(
            changed(scene, RUN_IN), FakeEngine(constant), cycles_per_update=None
        ).stages[:1]
    }
    tenth = RUNS_IN.archard_depth(np.array(0.1 * CLEARANCE))
    assert default == pytest.approx(float(tenth) / RATE, rel=0.2)


@pytest.mark.slow
def test_life_of_surfaces_that_run_in_again(campaign: Campaign) -> None:
    """The bushing is replaced at half of the strokes that wear it to the limit by the law."""
    whole = float(RUNS_IN.archard_depth(np.array(0.3e-3)) / (RATE * SHAPE[0].max()))
    life = Life(until="A.depth > 0.3 mm", replaced=f"A@{0.5 * whole!r}")
    scene = replace(changed(LIFE, RUN_IN), life=life)
    seen = campaign(scene, FakeEngine(constant), tolerance=0.1)
    assert seen.life is not None
    assert seen.life.strokes == pytest.approx(1.5 * whole, rel=0.02)


def test_the_watched_motion_before_a_life_is_a_small_part_of_it(
    campaign: Campaign,
) -> None:
    """50 cycles; up to 0.3 mm 75 of half a percent of the clearance, and then twice as many."""
    progress = campaign(LIFE, FakeEngine(exponential)).progress
    watched = [each.whole for each in progress if "does the motion settle" in each.word]
    assert watched
    assert 0.0 < max(watched) < 50.0 / (75.0 + 150.0)


def test_a_finished_refinement_gives_a_preliminary_life(
    use: Use, tmp_path: Path
) -> None:
    """It is stored with its state, and reported, while the next refinement runs."""
    path = tmp_path / "life"
    scene = interrupted_life(path, use, 2, 0.1)
    result = load(path)
    life = result.life
    assert life is not None
    assert (life.ended, result.stages, life.step) == ("preliminary", (), None)
    exact = REPRESENTED * math.log(1.0 + 0.3e-3 / (RATE * REPRESENTED))
    assert life.strokes == pytest.approx(exact, rel=0.1)
    state = "refinement 1 is finished and has an error of"
    assert f"{life}".startswith("preliminary life: ")
    assert state in f"{life}"
    assert "an unknown error of the wear steps; refinement 2 runs next" in f"{life}"
    assert "a preliminary life and 0 of 2 stages are stored" in unfinished(result)
    page = render_report(result)
    assert state in page
    assert "Service life, preliminary" in page
    with pytest.raises(InputError, match="its life is preliminary, without curves"):
        life_table(result)
    finished = runs.run(scene, path, jobs=1).life
    assert finished is not None
    assert finished.ended == "limit"
    # The deviations have the weight of the refinement in each life.
    first = replace(finished.refinements[0], deviations=life.refinements[0].deviations)
    assert first == life.refinements[0]


def test_a_looser_tolerance_resumes_a_life(use: Use, tmp_path: Path) -> None:
    """Refinements that meet it already give the life at once; a tighter one is refused."""
    path = tmp_path / "life"
    scene = interrupted_life(path, use, 3, 2e-3)
    with pytest.raises(InputError, match=r"tolerance is 0\.002 there and 0\.001 here"):
        runs.run(replace(scene, tolerance=1e-3), path, jobs=1)
    words = Seen()
    result = runs.run(replace(scene, tolerance=0.3), path, observers=[words], jobs=1)
    assert not any("refinement" in progress.word for progress in words.progress)
    assert (result.status, result.scene.tolerance) == ("completed", 0.3)
    assert result.life is not None
    assert result.life.ended == "limit"
    assert len(result.life.refinements) == 2
    assert 2e-3 < (result.life.error or 0.0) < 0.3


def test_a_looser_tolerance_completes_a_life_that_was_not_known(
    use: Use, tmp_path: Path
) -> None:
    path = tmp_path / "life"
    assert LIFE.life is not None
    scene = replace(LIFE, tolerance=1e-3, life=replace(LIFE.life, max_cycles=300))
    use(FakeEngine(exponential))
    assert runs.run(scene, path, jobs=1).status == "unconverged"
    result = runs.run(replace(scene, tolerance=0.3), path, jobs=1)
    assert (result.status, result.message, result.scene.tolerance) == (
        "completed",
        "",
        0.3,
    )


@pytest.mark.parametrize("answer", ["y", "n"])
def test_a_long_life_is_announced_and_confirmed(
    answer: str, use: Use, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    console = Console(file=StringIO(), force_terminal=True, width=200)
    bar = progress_bar(console)
    scene = replace(LIFE, tolerance=0.1)
    use(FakeEngine(exponential))
    monkeypatch.setattr(run_observer, "LONG_LIFE", 0.0)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", lambda question: answer)
    watched = Noted(bar, scene, False)
    if answer == "n":
        with pytest.raises(KeyboardInterrupt):
            runs.run(scene, tmp_path / "life", observers=[watched], jobs=1)
        assert watched.cycles > 0.0
        return
    life = runs.run(scene, observers=[watched], jobs=1).life
    assert life is not None
    ran = sum(each.cycles for each in life.refinements)
    assert 0.5 < watched.cycles / ran < 2.0
    assert "cycles of all replicates" in console.file.getvalue()  # type: ignore[attr-defined]


@pytest.mark.parametrize("answer", ["y", "n"])
def test_compared_lives_are_announced_and_confirmed_once(
    answer: str, use: Use, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    console = Console(file=StringIO(), force_terminal=True, width=200)
    scene = replace(LIFE, tolerance=0.1)
    asked = []

    def answering(question: str) -> str:
        asked.append(question)
        return answer

    use(FakeEngine(exponential))
    monkeypatch.setattr(run_observer, "LONG_LIFE", 0.0)
    monkeypatch.setattr("sys.stdin.isatty", lambda: True, raising=False)
    monkeypatch.setattr("builtins.input", answering)
    announce = announcing(progress_bar(console), 2.0, False)
    lives = {"plain": scene, "other": replace(scene, seed=1)}
    run_lives = partial(
        runs.run_scenes, lives, tmp_path, jobs=1, on_life_start=announce
    )
    if answer == "n":
        with pytest.raises(KeyboardInterrupt):
            run_lives()
    else:
        assert [result.status for result in run_lives().values()] == ["completed"] * 2
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert len(asked) == 1
    assert "plain: the life needs about" in shown
    assert "all lives take about" in shown
    assert ("other: the life needs about" in shown) == (answer == "y")


class Noted(RunObserver):
    """Keeps the announced cycles."""

    cycles = 0.0

    def on_life_start(self, cycles: float, seconds: float) -> None:
        self.cycles = cycles
        super().on_life_start(cycles, seconds)

    def on_stage(self, stage: StageResult) -> None:
        """Ignore stages, because the fake engine has no statistics of a solver."""


def quick(until: str = "A.depth > 0.3 mm", **settings: Any) -> Scene:
    return replace(
        LIFE, life=Life(until=until, quick="on"), **{"cycles": None} | settings
    )


def test_a_quick_life_takes_two_rates(use: Use, tmp_path: Path) -> None:
    """dh/dN = a + b h: up to half of the limit at the rate a, then at the rate a + b h."""
    use(FakeEngine(exponential))
    path = tmp_path / "life"
    result = runs.run(quick(), path, jobs=1)
    assert (result.status, len(result.stages)) == ("completed", 2)
    life = load(path).life
    assert life == result.life
    assert life is not None
    assert (life.ended, life.step, life.error, life.refinements) == (
        "quick",
        None,
        None,
        (),
    )
    half = 0.15e-3
    rate = RATE * SHAPE[0].max()
    first = half / rate
    second = half / (rate + half / REPRESENTED)
    assert life.strokes == pytest.approx(first + second, rel=0.02)
    by_joint = [rate for rate in life.wear_rates if rate.joint == "A"]
    assert [rate.surfaces for rate in by_joint] == ["new", "worn once"]
    assert by_joint[0].until == by_joint[1].since == pytest.approx(first, rel=0.02)
    growth = 1.0 + half / (rate * REPRESENTED)
    assert by_joint[1].rate / by_joint[0].rate == pytest.approx(growth, rel=0.02)
    low, high = stats.lognorm.ppf((0.025, 0.975), math.sqrt(math.log(1.0 + 0.5**2)))
    assert math.exp(life.scatter) == pytest.approx(math.sqrt(high / low), rel=1e-12)
    assert f"{life}".startswith("quick life: ")
    page = render_report(result)
    for text in (f"{life}", page):
        assert "no error of steps" in text
    assert "This life is quick, with no error of steps" in page
    assert "Service life, quick" in page
    assert "A: worn once" in page
    with pytest.raises(InputError, match="its life is quick, without curves"):
        life_table(result)


def test_a_quick_life_runs_two_short_stages(use: Use) -> None:
    use(FakeEngine(exponential))
    result = runs.run(quick(replicates=3), jobs=1)
    assert [stage.statistics.cycles for stage in result.stages] == [30, 30]


def test_an_interrupted_quick_life_resumes(use: Use, tmp_path: Path) -> None:
    class StopsInTheSecondStage(Observer):
        def on_progress(self, progress: Progress) -> None:
            if progress.stage == 1:
                raise KeyboardInterrupt

    use(FakeEngine(exponential))
    whole = runs.run(quick(), jobs=1).life
    path = tmp_path / "life"
    with pytest.raises(KeyboardInterrupt):
        runs.run(quick(), path, observers=[StopsInTheSecondStage()], jobs=1)
    assert load(path).life is None
    assert runs.run(quick(), path, jobs=1).life == whole


@pytest.mark.parametrize(
    ("until", "settings", "message"),
    [
        (
            "bdc_drift > 1 mm",
            {},
            "until: bdc_drift: allowed are depth, wear_volume and tilt with",
        ),
        (
            "depth > 0.1 mm",
            {"wear_updates": 2},
            "wear_updates = 2: allowed is 1 with life.quick",
        ),
        (
            "depth > 0.1 mm",
            {"bearings": Bearing(materials=Materials(running_in=30.0))},
            "running_in = 30: allowed is 1 with life.quick",
        ),
    ],
)
def test_a_quick_life_of_other_limits_is_refused(
    until: str, settings: dict[str, Any], message: str
) -> None:
    with pytest.raises(InputError, match=message):
        quick(until, **settings)
