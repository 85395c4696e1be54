"""Wear in steps: laws of wear in closed form under an engine that does nothing else."""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from presswear.campaign.amplification import Amplification
from presswear.campaign.campaign import run_campaign, run_stage
from presswear.campaign.single import run_scene
from presswear.engines.base import Plan, Run, Start
from presswear.engines.settings import ExudynJoints, ExudynTree, InHouse
from presswear.linkage.elements import ClearanceJoint, Linkage
from presswear.linkage.surface import bin_centres
from presswear.record.recorder import Recorder
from presswear.record.sampling import MapBatches, mean_map
from presswear.record.soundness import Finding
from presswear.record.tracker import Progress, Tracker
from presswear.results.result import load
from presswear.results.stage import SIDES, JointResult, StageResult, WearStep
from presswear.scene.catalog import slider_crank, wear_times
from presswear.scene.scene import CONVENTIONS, Scene
from presswear.show.figures import drawings
from presswear.show.report import notes, render
from presswear.show.report.wear import growth as growth_table

Array = NDArray[np.float64]
Law = Callable[[int, ClearanceJoint, Array], Array]
"""Number of the run, joint, its depth, shape (2, m): depth of one cycle, m."""

CLEARANCE = 0.8e-3
CYCLES = 5
REPRESENTED = 4e6
RATE = 0.05 * CLEARANCE / REPRESENTED
"""Depth of one cycle where it is deepest: a wear of a twentieth of the clearance, m."""

SCENE = replace(
    wear_times(), cycles=CYCLES, wears=2, represented_cycles=REPRESENTED, extrapolation="steps"
)
SHAPE = np.stack([np.exp(np.cos(bin_centres(360)) - 1.0), 0.3 + 0.2 * np.sin(bin_centres(360))])
"""Of wear over bearing and pin; its largest value is that of the bearing, near 1."""


def depth_of(joint: ClearanceJoint) -> Array:
    surfaces = (joint.bearing_surface, joint.pin_surface)
    return np.stack([s.depth if s.depth.size else np.zeros(360) for s in surfaces])


@dataclass
class FakeEngine:
    """Wears as a law says; runs are numbered from 1, and one of them may go wrong."""

    law: Law
    fails: int = 0
    stopped: int = 0
    runs: int = 0

    def __call__(self, linkage: Linkage, start: Start, plan: Plan) -> Run:
        self.runs += 1
        recorder = Recorder.of(linkage, start.position, 1, plan.cycle, torques=False)
        recorder.book.record["now"] = plan.cycle * plan.cycles
        for tracker in plan.trackers:
            tracker.begun(recorder)
        for cycle in range(plan.cycles):
            plan.advanced((cycle + 0.5) * plan.cycle)
            if self.runs == self.stopped and cycle == 1:
                raise KeyboardInterrupt
            recorder.book.cycle[:] = 100.0 * self.runs
            for k, joint in enumerate(linkage.clearances):
                recorder.book.depth[k] = self.law(self.runs, joint, depth_of(joint))
            recorder.end_cycle()
            for tracker in plan.trackers:
                tracker.cycle(recorder, recorder.state)
        failed = self.runs == self.fails
        return Run(
            "failed" if failed else "completed",
            Finding("state", "the solver found no step", 0.1, "", "") if failed else None,
            recorder,
            start,
            plan.cycle * plan.cycles,
            {"model": "none", "energy_residual_J": 0.0, "drive_exchange_J": 0.0, "steps": 1},
        )


def constant(run: int, joint: ClearanceJoint, depth: Array) -> Array:
    return RATE * SHAPE * (1.0 if joint.name == "A" else 0.4)


def uneven(run: int, joint: ClearanceJoint, depth: Array) -> Array:
    """Rates that come and go from run to run, as in a chaotic motion."""
    return constant(run, joint, depth) * (1.0, 0.3, 2.7, 0.9)[run % 4]


def exponential(run: int, joint: ClearanceJoint, depth: Array) -> Array:
    """dh/dN = a + b h: grows to a (exp(b N) - 1) / b."""
    return RATE * SHAPE + depth / REPRESENTED


class Seen(Tracker):
    """Everything that a tracker was told."""

    def __init__(self) -> None:
        self.stages: list[StageResult] = []
        self.told: list[Progress] = []
        self.status = self.message = ""

    def progress(self, progress: Progress) -> None:
        self.told.append(progress)

    def stage(self, stage: StageResult) -> None:
        self.stages.append(stage)

    @property
    def wholes(self) -> list[float]:
        return [progress.whole for progress in self.told]

    @property
    def steps(self) -> list[WearStep]:
        return [step for stage in self.stages for step in stage.wear_steps]


def depth(joint: JointResult) -> Array:
    """Depth of bearing and pin that a stage ran on, shape (2, m), m."""
    return np.stack([joint.depth(side) for side in SIDES])


def wear(joint: JointResult) -> Array:
    """Depth that a wear added to bearing and pin, shape (2, m), m."""
    return np.stack([joint.wear(side) for side in SIDES])


def use(engine: FakeEngine, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let a fake engine run in place of any."""
    for kind in (ExudynTree, ExudynJoints, InHouse):
        monkeypatch.setattr(kind, "simulate", lambda self, *given: engine(*given))


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


@pytest.mark.parametrize("limit", [1e-3, 0.0033, 0.01, 0.02, 1.0])
def test_a_constant_rate_is_exact_with_any_limit(campaign: Campaign, limit: float) -> None:
    """The last stage tells how it would wear, but nothing runs for that."""
    engine = FakeEngine(constant)
    seen = campaign(replace(SCENE, depth_step=limit), engine)
    assert seen.status == "completed"
    wears = {j.name: REPRESENTED * constant(0, j, np.zeros(0)) for j in SCENE.linkage().clearances}
    steps = math.ceil(0.05 / limit - 1e-9)
    assert [len(stage.wear_steps) for stage in seen.stages] == [steps, steps, 0]
    assert engine.runs == 2 * steps + 1
    for stage in seen.stages:
        for name, joint in stage.joints.items():
            np.testing.assert_allclose(wear(joint), wears[name], rtol=1e-12)
            np.testing.assert_allclose(depth(joint), stage.index * wears[name], rtol=1e-12)


@pytest.mark.parametrize("law", [constant, uneven, exponential])
@pytest.mark.parametrize("limit", [0.0037, 0.01])
def test_steps_stay_below_their_limit_and_use_up_the_cycles(
    campaign: Campaign, law: Law, limit: float
) -> None:
    """Between consecutive runs no profile changes by more, and no more steps than that asks for."""
    surfaces: list[Array] = []

    def spied(run: int, joint: ClearanceJoint, depth: Array) -> Array:
        if joint.name == "A":
            surfaces.append(depth)
        return law(run, joint, depth)

    seen = campaign(replace(SCENE, depth_step=limit), FakeEngine(spied))
    depths = surfaces[::CYCLES]
    changes = [np.max(b - a) / CLEARANCE for a, b in pairwise(depths)]
    assert max(changes) <= limit * (1.0 + 1e-8)
    told = [step.largest_change_of_clearance for step in seen.steps]
    np.testing.assert_allclose(told, changes, rtol=1e-9)
    # Equal shares of what remains: a step may be below the limit by as much as one in n.
    assert np.mean(changes) > 0.75 * limit
    for stage in seen.stages[:2]:
        total = math.fsum(step.represented_cycles for step in stage.wear_steps)
        assert total == pytest.approx(REPRESENTED, rel=1e-14)
        for step in stage.wear_steps:
            assert step.represented_cycles > 0.0
            assert step.factor == step.represented_cycles / step.cycles


def test_single_jumps_are_those_of_the_paper(campaign: Campaign) -> None:
    """To the last bit: depth of the cycles times represented cycles over cycles."""
    engine = FakeEngine(uneven)
    seen = campaign(replace(SCENE, extrapolation="single", cycles=7), engine)
    assert engine.runs == 3
    worn = np.zeros((2, 2, 360))
    for run, stage in enumerate(seen.stages, start=1):
        joints = stage.joints.values()
        assert np.array_equal([depth(joint) for joint in joints], worn)
        assert stage.amplification == REPRESENTED / 7
        maps = MapBatches((2, 2, 360))
        for _ in range(7):
            maps.add(np.stack([uneven(run, j, worn) for j in SCENE.linkage().clearances]))
        added = np.stack([wear(joint) for joint in joints])
        assert np.array_equal(added, mean_map([maps]) * REPRESENTED)
        worn = worn + added
    assert [len(stage.wear_steps) for stage in seen.stages] == [1, 1, 0]


def test_halving_the_step_halves_the_error(campaign: Campaign) -> None:
    """A rate that grows with depth; the steps are explicit Euler steps in represented cycles."""
    exact = RATE * REPRESENTED * SHAPE * (math.exp(2.0) - 1.0)
    errors = []
    for limit in (0.004, 0.002, 0.001):
        seen = campaign(replace(SCENE, depth_step=limit), FakeEngine(exponential))
        joint = seen.stages[2].joints["A"]
        errors.append(np.max(np.abs(depth(joint) - exact)))
    assert errors[0] < 0.1 * exact.max()
    np.testing.assert_allclose(np.divide(errors[:-1], errors[1:]), 2.0, rtol=0.06)


def test_a_stage_runs_on_the_sum_of_the_steps_before_it(campaign: Campaign) -> None:
    seen = campaign(replace(SCENE, depth_step=0.006), FakeEngine(exponential))
    for before, after in pairwise(seen.stages):
        for name, joint in before.joints.items():
            there, added = depth(after.joints[name]), wear(joint)
            np.testing.assert_allclose(there, depth(joint) + added, rtol=1e-12)
            deepest = before.wear_steps[-1].deepest_m[name]
            assert [deepest["bearing"], deepest["pin"]] == list(there.max(axis=1))
            area = 0.02 * 0.015 * 2.0 * math.pi / 360
            volume = joint.statistics["wear_volume_m3"]
            assert volume == pytest.approx(area * added.sum(), rel=1e-12)


def test_a_surface_that_does_not_wear_takes_one_step(campaign: Campaign) -> None:
    engine = FakeEngine(lambda run, joint, depth: 0.0 * SHAPE)
    campaign(replace(SCENE, depth_step=1e-4), engine)
    assert engine.runs == 3


NO_STEP = "the solver found no step (t = 0.1 s)"


@pytest.mark.parametrize(
    ("fails", "says", "steps"),
    [
        # Stage 0 and steps 2 to 5 of its wear, then stage 1.
        (6, f"stage 1: {NO_STEP}", [5, 0]),
        # Stage 1 as well, then the run after step 3 of the second wear.
        (9, f"after step 3 of the second wear (2.4e+06 of 4e+06 cycles): {NO_STEP}", [5, 3]),
    ],
)
def test_a_failure_is_told_with_its_place_and_what_was_done_is_kept(
    campaign: Campaign, fails: int, says: str, steps: list[int]
) -> None:
    seen = campaign(replace(SCENE, depth_step=0.01), FakeEngine(constant, fails=fails))
    assert (seen.status, seen.message) == ("failed", says)
    assert [len(stage.wear_steps) for stage in seen.stages] == steps
    last = seen.stages[1]
    assert last.status == ("completed" if steps[1] else "failed")
    if steps[1]:
        joint = last.joints["A"]
        np.testing.assert_allclose(wear(joint), 0.6 * REPRESENTED * RATE * SHAPE)


@pytest.mark.parametrize(
    ("extrapolation", "says", "steps"),
    [
        # At half the clearance a step, the third is deeper than the clearance.
        ("steps", "step 3 of the first wear (1.2e+08 of 4e+09 cycles) the bearing would lose", 3),
        ("single", "after stage 0 the bearing would lose 0.04 m", 1),
    ],
)
def test_a_surface_worn_through_is_named(
    campaign: Campaign, extrapolation: str, says: str, steps: int
) -> None:
    scene = replace(SCENE, depth_step=0.5, represented_cycles=1e3 * REPRESENTED)
    engine = FakeEngine(lambda run, joint, depth: RATE * np.ones((2, 360)))
    seen = campaign(replace(scene, extrapolation=extrapolation), engine)
    assert seen.status == "failed"
    assert seen.message.startswith(f"joint A: {says}")
    assert "more than the clearance of 0.0008 m" in seen.message
    (stage,) = seen.stages
    assert stage.finding is not None
    assert (stage.finding.kind, stage.finding.joint) == ("wear", "A")
    assert len(stage.wear_steps) == engine.runs == steps


def test_a_stage_outlives_an_interrupted_wear(monkeypatch: pytest.MonkeyPatch) -> None:
    engine = FakeEngine(constant, stopped=4)
    use(engine, monkeypatch)
    seen = Seen()
    with pytest.raises(KeyboardInterrupt):
        run_campaign(replace(SCENE, depth_step=0.01), [seen])
    assert [(stage.index, len(stage.wear_steps)) for stage in seen.stages] == [(0, 3)]


@pytest.mark.parametrize("law", [constant, uneven, exponential])
def test_progress_never_falls_and_names_the_step(campaign: Campaign, law: Law) -> None:
    seen = campaign(replace(SCENE, depth_step=0.005), FakeEngine(law))
    for index in range(3):
        parts = [told.part for told in seen.told if told.stage == index]
        assert parts == sorted(parts)
        assert parts[-1] > 0.85
    assert seen.wholes == sorted(seen.wholes)
    assert seen.wholes[-1] > 0.95
    words = [told.word for told in seen.told if told.stage == 1]
    assert any(word.startswith("step 3 of about ") and "second wear" in word for word in words)


def test_progress_counts_runs(campaign: Campaign) -> None:
    """Ten runs each in two wears and one at the end, of five cycles each, at a steady rate."""
    seen = campaign(replace(SCENE, depth_step=0.005), FakeEngine(constant))
    expected = (np.arange(21 * CYCLES) + 0.5) / (21 * CYCLES)
    # Nothing is foreseen before the first cycle has ended.
    assert seen.wholes[0] == 0.0
    np.testing.assert_allclose(seen.wholes[1:], expected[1:], rtol=1e-12)


def test_progress_of_single_jumps_is_that_of_the_runs(campaign: Campaign) -> None:
    seen = campaign(replace(SCENE, extrapolation="single"), FakeEngine(uneven))
    expected = (np.arange(3 * CYCLES) + 0.5) / CYCLES
    np.testing.assert_allclose([told.stage + told.part for told in seen.told], expected)
    np.testing.assert_allclose(seen.wholes, expected / 3.0)
    assert not [told for told in seen.told if "step" in told.word]


def test_a_stage_alone_is_not_worn(monkeypatch: pytest.MonkeyPatch) -> None:
    engine = FakeEngine(constant)
    use(engine, monkeypatch)
    seen = Seen()
    stage, _ = run_stage(replace(SCENE, depth_step=0.001), 0, {}, [seen])
    assert (engine.runs, stage.wear_steps, seen.stages) == (1, (), [stage])
    assert not [told for told in seen.told if "step" in told.word]


@pytest.mark.parametrize(
    ("scene", "extrapolation", "limit"),
    [
        (wear_times(), "conventions", math.inf),
        (wear_times(), "steps", 0.02),
        (slider_crank(), "conventions", 0.02),
        (slider_crank(), "single", math.inf),
    ],
    ids=["paper", "paper in steps", "refined", "refined at once"],
)
def test_conventions_decide_unless_the_scene_does(
    scene: Scene, extrapolation: str, limit: float
) -> None:
    found = Amplification.of(replace(scene, extrapolation=extrapolation, depth_step=0.02))
    assert found == Amplification(4e6, limit)
    assert found.factor(200) == 20_000.0


LIMIT = 0.015
"""Of the steps of the press, part of the clearance."""


@pytest.fixture(scope="module")
def real(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One fast cycle of the press in the in-house solver, worn once in steps, stored."""
    scene = wear_times()
    scene = replace(
        scene,
        mechanism=replace(scene.mechanism, speed=60.0),
        conventions=CONVENTIONS["refined"],
        engine="dae",
        cycles=1,
        wears=1,
        represented_cycles=1e6,
        depth_step=LIMIT,
    )
    path = tmp_path_factory.mktemp("result") / "steps"
    run_scene(scene, path)
    return path


def test_the_press_wears_in_steps(real: Path) -> None:
    result = load(real)
    assert result.status == "completed"
    steps = result.stages[0].wear_steps
    assert len(steps) >= 3
    assert result.stages[1].wear_steps == ()
    assert sum(step.represented_cycles for step in steps) == pytest.approx(1e6, rel=1e-13)
    assert all(0.0 < step.largest_change_of_clearance <= LIMIT * (1 + 1e-8) for step in steps)
    for joint in "AC":
        for side in ("bearing", "pin"):
            before, after = (stage.joints[joint].depth(side) for stage in result.stages)
            np.testing.assert_allclose(after - before, result.stages[0].joints[joint].wear(side))
            deepest = [step.deepest_m[joint][side] for step in steps]
            assert deepest == sorted(deepest)
            assert deepest[-1] == after.max()
    # Of the run that each step multiplies, the first of which is the stage's.
    peak = result.stages[0].statistics["joints"]["A"]["force_max_N"]
    assert steps[0].force_max_N["A"] == peak
    assert len({step.force_max_N["A"] for step in steps}) == len(steps)


def test_growth_is_a_table_and_a_figure(real: Path) -> None:
    result = load(real)
    table = growth_table(result)
    assert table is not None
    rows = {row[0]: row[1:] for _, group in table.groups for row in group}
    assert rows["steps"] == (str(len(result.stages[0].wear_steps)),)
    assert float(rows["largest change in a step (% of the clearance)"][0]) <= 100.0 * LIMIT
    assert "deepest then, pin (µm)" in rows
    found = {drawing.file: drawing for drawing in drawings(result)}
    panels = found["wear-growth.png"].sheet.get_axes()
    assert [axes.get_xlabel() for axes in panels] == ["represented cycles (million)"] * 2
    assert [axes.get_ylabel() for axes in panels] == ["deepest wear (µm)"] * 2
    for axes, joint in zip(panels, "AC", strict=True):
        for line, side in zip(axes.get_lines(), ("bearing", "pin"), strict=False):
            x, y = (np.asarray(data, dtype=float) for data in line.get_data())
            assert x[-1] == pytest.approx(1.0)
            assert y[0] == 0.0
            deepest = result.stages[1].joints[joint].depth(side).max()
            assert y[-1] == pytest.approx(1e6 * deepest)
    assert "in a single jump" in found["wear-depth.png"].caption
    assert any("in steps with a run after each" in text for text in notes(result))
    assert "how the wear was applied" in render(result, [])
