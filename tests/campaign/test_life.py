"""Service lives of a problem whose wear law and noise are known, and the quantities of scenes."""
# mypy: disable-error-code="union-attr,operator"

import math
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from bush import CLEARANCE as GAP
from bush import COEFFICIENT, bush
from endurance.sameness import folder_differences
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

import presswear as pw
from presswear.campaign import replicates
from presswear.campaign.cycles_of_life import cycles_left, fewest_cycles
from presswear.campaign.life_estimate import LifeEstimate, estimate_life
from presswear.campaign.life_quantities import (
    levels_of,
    pseudo_levels_of,
    samples_of,
)
from presswear.campaign.life_result import life_by_rate, life_result
from presswear.campaign.refinement import LoadBlock, Refinement, Refinements
from presswear.campaign.service_life import (
    FIRST_WEAR,
    BlockPlan,
    LifeProblem,
    next_block,
    next_refinement,
    run_refinements,
)
from presswear.campaign.wear_histories import MEASURED_BLOCKS, WearHistories
from presswear.engines import driver
from presswear.physics.dead_centre import bottom_of
from presswear.physics.wear import map_shape
from presswear.recording.columns import cycle_column, cycle_columns
from presswear.recording.recorder import Recorder
from presswear.recording.soundness import Condition, Finding
from presswear.results.life import LifeResult
from presswear.scene.options import CLEARANCES, FOLLOWED, Limit, Service
from presswear.scene.settings import changed
from presswear.show.report import render_report
from presswear.tools.arrays import Array

CLEARANCE = 1e-3
DEPTH = Limit("depth", "A", 5e-5)
DRIFT = Limit("bdc_drift", "", 2.5e-5)


Levels = dict[str, Array]


def load_block(
    strokes: float, cycles: int, levels: Levels, rate: float = 0.0, **settings: Any
) -> LoadBlock:
    """Return a block of the first service interval in which a stroke wears a depth, m."""
    more: dict[str, Any] = {
        "interval": 0,
        "samples": {},
        "removed": np.full((1, 1, 1), rate),
    }
    more |= settings
    return LoadBlock(strokes, cycles, levels=levels, rate=rate / CLEARANCE, **more)


@dataclass
class KnownWear:
    """Histories that wear by dh/dN = rate (1 + fresh exp(-h/bedded)), with noise in every cycle.

    Bottom dead centre drifts by half the depth and scatters from stroke to stroke.
    """

    seed: int
    rate: float = 1e-11
    fresh: float = 3.0
    bedded: float = 1e-5
    noise: float = 0.5
    scatter: float = 5e-6
    initial: float = 0.0
    depth: Array = field(default_factory=lambda: np.zeros(8))

    def life_until(self, depth: float) -> float:
        """Return the strokes until a depth: the integral of dh/(dh/dN)."""
        top = math.log(
            (math.exp(depth / self.bedded) + self.fresh) / (1.0 + self.fresh)
        )
        return self.bedded * top / self.rate

    def __call__(
        self,
        refinements: Refinements,
        plan: BlockPlan | Service,
    ) -> LoadBlock:
        before = refinements[-1].blocks
        if isinstance(plan, Service):
            self.depth = np.zeros(8)
            levels = {"A.depth": self.depth}
            interval = before[-1].interval + 1
            return replace(
                before[-1], cycles=0, interval=interval, levels=levels, rate=0.0
            )
        if not before:
            self.depth = np.full(8, self.initial)
        draw = np.random.default_rng([self.seed, len(refinements), len(before)])
        start = self.depth
        bottoms = []
        for _ in range(plan.cycles):
            law = self.rate * (1.0 + self.fresh * np.exp(-self.depth / self.bedded))
            size = math.sqrt(math.log1p(self.noise**2))
            factor = draw.lognormal(-0.5 * size**2, size, 8)
            bottoms.append(0.5 * self.depth + draw.normal(0.0, self.scatter, 8))
            self.depth = (
                self.depth + plan.share * law * factor + float(np.mean(plan.extra))
            )
        strokes = (before[-1].strokes if before else 0.0) + plan.cycles * plan.share
        rate = float((self.depth - start).mean()) / (plan.cycles * plan.share)
        more: dict[str, Any] = {"interval": before[-1].interval if before else 0}
        more["samples"] = {"bdc_drift": np.mean(bottoms, axis=0)}
        return load_block(strokes, plan.cycles, {"A.depth": self.depth}, rate, **more)


def problem(*limits: Limit, **settings: Any) -> LifeProblem:
    common: dict[str, Any] = {"services": (), "at_most": 1e12, "tolerance": 0.1}
    return LifeProblem(limits, **{"max_cycles": 10_000} | common | settings)


def life_of(
    problem: LifeProblem, wear: KnownWear
) -> tuple[LifeEstimate, tuple[Refinement, ...]]:
    refinements = run_refinements(problem, wear)
    return estimate_life(refinements, problem.limits), refinements


def test_the_step_after_a_service_is_that_of_the_new_bushing() -> None:
    """Blocks before the service neither change its length nor its correction."""
    levels = {"A.depth": np.full(8, 1e-6)}
    rows = (2.0, 2, 1e-12), (1e5, 8, 5e-12), (2e5, 8, 2e-12)
    old = [load_block(strokes, cycles, levels, rate) for strokes, cycles, rate in rows]
    service = replace(old[-1], cycles=0, interval=1, rate=0.0)
    blocks = (*old, service, load_block(2e5 + 2.0, 2, levels, 4e-11, interval=1))
    refinement = Refinement(1e-3, 8, blocks)
    plan = next_block(problem(DEPTH, services=(Service("A", 2e5, False),)), refinement)
    assert (plan.cycles, plan.extra) == (8, 0.0)
    assert plan.share == pytest.approx(1e-3 / 4e-8)


@pytest.mark.parametrize("before", [4, 6])
def test_correction_of_a_block_is_that_of_the_trapezoidal_rule(before: int) -> None:
    """Of a rate that rises linearly with the strokes, the sum of a block lacks a known part."""
    rate = 1e-12
    slope = 3e-18
    stood_for = 1e4
    cycles = 4

    def block(strokes: float, cycles: int, stood_for: float) -> LoadBlock:
        """Return a block in which each cycle wears at the rate of the strokes before it."""
        starts = strokes - stood_for * np.arange(1, cycles + 1)
        mean = rate + slope * float(starts.mean())
        return load_block(strokes, cycles, {"A.depth": np.zeros(8)}, mean)

    ends = 2.0, 2.0 + before * stood_for, 2.0 + (before + cycles) * stood_for
    counts = 2, before, cycles
    blocks = tuple(map(block, ends, counts, (1.0, stood_for, stood_for)))
    plan = next_block(problem(DEPTH), Refinement(1e-3, 5, blocks))
    # The integral over each cycle less the rate at its start.
    lacking = cycles * 0.5 * slope * stood_for**2
    assert plan.extra * plan.cycles == pytest.approx(
        np.full((1, 1, 1), lacking), rel=1e-9
    )


def test_samples_are_those_of_the_surfaces_before_each_cycle() -> None:
    """A quantity that is proportional to the depth is fitted exactly at the ends of blocks."""
    wear = 1e-11
    stood_for = 1e4
    blocks = []
    strokes = 0.0
    for k, cycles in enumerate((2, 4, 5, 3, 6, 4, 4)):
        each = stood_for if k else 0.0
        starts = strokes + each * np.arange(cycles)
        strokes = float(starts[-1]) + each
        means = 1.0 + 1e4 * wear * starts.mean() + np.array([-1e-6, 1e-6])
        samples = {"A.force_max": means}
        blocks.append(
            load_block(strokes, cycles, {"A.depth": np.zeros(2)}, wear, samples=samples)
        )
    refinement = Refinement(blocks=tuple(blocks))
    expected = 1.0 + 1e4 * wear * refinement.strokes
    assert refinement.curve("A.force_max") == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("limit", "noise", "lives"),
    [(DEPTH, 0.5, 50), (DEPTH, 1.5, 50), (DRIFT, 0.5, 20), (DEPTH, 1e-9, 20)],
    ids=["depth", "wild", "drift", "exact"],
)
def test_intervals_cover_the_life(limit: Limit, noise: float, lives: int) -> None:
    """At least nine of ten intervals hold the exact life."""
    covered = 0
    errors = []
    for seed in range(lives):
        draw = np.random.default_rng(seed)
        rate = 10.0 ** draw.uniform(-13, -9)
        fresh = draw.uniform(0.0, 10.0)
        wear = KnownWear(seed, rate, fresh, 10.0 ** draw.uniform(-5.5, -4.5), noise)
        life, _ = life_of(problem(limit), wear)
        covered += abs(math.log(life.strokes / wear.life_until(5e-5))) <= life.error
        errors.append(life.error)
    assert covered >= 0.9 * lives
    assert np.median(errors) < 0.1


def test_a_life_is_the_mean_of_its_refinements() -> None:
    """Weights are the cycles; independent errors add as squares, with Welch's freedom."""
    life, refinements = life_of(problem(DEPTH), KnownWear(3, noise=1.5, fresh=0.0))
    ends = [each.crossing([DEPTH]) for each in refinements]
    pairs = zip(refinements, ends, strict=True)
    weights = np.array([each.cycles_until(end) for each, end in pairs])
    weights /= weights.sum()
    assert life.strokes == pytest.approx(np.prod(ends**weights), rel=1e-12)
    halves = np.array([each.sampling_error([DEPTH]) for each in refinements])
    errors = weights * halves / stats.t.ppf(0.975, 7)
    freedom = 7.0 * (errors**2).sum() ** 2 / (errors**4).sum()
    expected = stats.t.ppf(0.975, freedom) * math.hypot(*errors)
    assert life.sampling == pytest.approx(expected, rel=1e-9)
    assert life.sampling < halves[-1]


def test_step_error_converges_without_noise() -> None:
    wear = KnownWear(1, noise=1e-9, fresh=30.0)
    errors = []
    for tolerance in (0.1, 0.003):
        life, _ = life_of(problem(DEPTH, tolerance=tolerance), wear)
        errors.append(abs(math.log(life.strokes / wear.life_until(DEPTH.value))))
        assert errors[-1] <= life.error <= tolerance
    assert errors[0] > 3.0 * errors[1] > 0.0


def test_first_of_several_limits_ends_the_life() -> None:
    later = DEPTH
    sooner = Limit("bdc_drift", "", 1e-5)
    wear = KnownWear(2, noise=0.1, scatter=1e-7)
    life, refinements = life_of(problem(later, sooner), wear)
    assert abs(math.log(life.strokes / wear.life_until(2e-5))) <= life.error < 0.1
    each = [estimate_life(refinements, [limit]).strokes for limit in (later, sooner)]
    assert each == [math.inf, life.strokes]


def test_mean_is_not_biased_by_the_choice_of_steps() -> None:
    """By its own wear a cycle that wears little would stand for more strokes."""
    wear = KnownWear(3, noise=2.0, fresh=0.0)
    life, _ = life_of(problem(DEPTH, tolerance=0.05, max_cycles=200_000), wear)
    assert (
        abs(math.log(life.strokes / wear.life_until(DEPTH.value))) <= life.error < 0.06
    )


def test_limit_exceeded_when_new_is_refused() -> None:
    with pytest.raises(
        pw.InputError, match=r"A\.depth > 5e-05 m.*when new.*A\.depth is 6e-05"
    ):
        run_refinements(problem(DEPTH), KnownWear(5, rate=1e-15, initial=6e-5))
    # A drift is zero when new, whatever scatters.
    drift = Limit("bdc_drift", "", 1e-5)
    assert math.isfinite(life_of(problem(drift), KnownWear(4, scatter=1e-6))[0].strokes)


def test_cycles_are_limited() -> None:
    limited = problem(DEPTH, tolerance=0.001, max_cycles=1000)
    life, refinements = life_of(limited, KnownWear(8, noise=3.0))
    assert max(each.cycles for each in refinements) <= 2 * limited.max_cycles
    assert next_refinement(limited, refinements) is None
    assert life.error > limited.tolerance


def ran(refinements: Refinements) -> int:
    """Return the cycles of each history, with two of a start-up in each refinement."""
    return sum(2 + sum(block.cycles for block in each.blocks) for each in refinements)


def estimates(limit: Limit, seed: int) -> list[float]:
    """Return the ratios of cycles left, estimated and run, from a fifth of a life on."""
    wear = KnownWear(seed)
    life = problem(limit)
    moments = []

    def advance(done: Refinements, plan: Any) -> LoadBlock:
        moments.append((ran(done), cycles_left(life, done)))
        return wear(done, plan)

    whole = ran(run_refinements(life, advance))
    return [
        left / (whole - cycles) for cycles, left in moments if cycles >= 0.2 * whole
    ]


@pytest.mark.parametrize("limit", [DEPTH, DRIFT], ids=["depth", "drift"])
def test_cycles_left_are_estimated(limit: Limit) -> None:
    """Most estimates are right within a factor of 1.5."""
    ratios = [ratio for seed in range(4) for ratio in estimates(limit, seed)]
    assert np.mean([1.0 / 1.5 <= ratio <= 1.5 for ratio in ratios]) > 0.5


def announced(seed: int, noise: float) -> float:
    """Return the cycles that are announced after two load blocks over those that follow."""
    life, wear = problem(DEPTH), KnownWear(seed, noise=noise)
    moment = []

    def advance(done: Refinements, plan: Any) -> LoadBlock:
        if len(done) == 1 and len(done[0].blocks) == MEASURED_BLOCKS:
            moment.append((ran(done), cycles_left(life, done)))
        return wear(done, plan)

    whole = ran(run_refinements(life, advance))
    [(cycles, left)] = moment
    return left / (whole - cycles)


def test_half_of_all_lives_take_longer_than_announced() -> None:
    """Chance decides about the number of refinements: lives alike differ by a factor of four."""
    ratios = [announced(seed, noise) for seed in range(8) for noise in (0.5, 1.0)]
    assert 0.7 < np.median(ratios) < 1.6


@pytest.mark.parametrize("limit", [DEPTH, DRIFT], ids=["depth", "drift"])
def test_a_life_takes_at_least_the_cycles_stated_before(limit: Limit) -> None:
    """A cycle of the first refinement wears half a percent of the clearance, on average."""
    fewest = fewest_cycles(problem(limit), {"A": CLEARANCE})
    expected = 8.0 + 10.0 + 40.0 if limit is DEPTH else 8.0 + 2.0 + 16.0
    assert fewest == pytest.approx(expected)
    whole = [
        ran(run_refinements(problem(limit, tolerance=1.0), KnownWear(seed)))
        for seed in range(20)
    ]
    assert fewest <= min(whole) <= 3.5 * fewest


def test_quantities_of_surfaces_and_strokes() -> None:
    scene = pw.scenes.press_blanking(conventions="refined", replicates=2)
    joints = scene.linkage().clearances
    worn = np.zeros((2, *map_shape(joints)))
    worn[0, 0, 1, 7] = 3e-6  # the pin of A in one bin
    worn[1, 1, 0, :] = 1e-6  # the bearing of C all around
    levels = levels_of(scene, worn, tuple(FOLLOWED))
    assert levels["A.depth"].tolist() == [3e-6, 0.0]
    assert levels["C.depth"].tolist() == [0.0, 1e-6]
    around = 2.0 * np.pi * joints[1].bearing_radius * joints[1].width * 1e-6
    assert levels["C.wear_volume"][1] == pytest.approx(around, rel=1e-12, abs=0.0)
    ideal = bottom_of(scene.ideal)
    rows = np.zeros((2, 4, cycle_columns(2, 0)))
    off = np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 5.0, 5.0, 5.0]])
    rows[:, :, cycle_column("bottom_height")] = ideal.height + off
    column = cycle_column("force_max", 1)
    rows[0, :, column] = 10.0, 20.0, 30.0, 40.0
    samples = samples_of(scene, rows)
    assert samples["bdc_error"] == pytest.approx([2.5, 5.0])
    assert samples["bdc_drift"] == pytest.approx([2.5, 5.0])
    assert samples["repeatability"] == pytest.approx([5.0 / 3.0, 0.0])
    assert samples["C.force_max"].tolist() == [25.0, 0.0]
    single = samples_of(scene, rows[:, :1])  # 1 and 5: a history wore out
    assert single["repeatability"] == pytest.approx([8.0, 8.0])
    assert samples["A.force_max"].tolist() == [0.0, 0.0]
    names = {name.partition(".")[2] or name for name in (*levels, *samples)}
    press = pw.scenes.press_off_centre()
    corners = press.linkage().clearances
    flat = np.zeros((1, *map_shape(corners)))
    names |= {"tilt"}  # of guides
    assert names == FOLLOWED.keys()
    levels = levels_of(press, flat, tuple(FOLLOWED))
    of_guides = [
        f"guide.{key}" for key, one in FOLLOWED.items() if "guide" in one.kinds
    ]
    strokes = np.zeros((1, 2, cycle_columns(len(corners), 1)))
    strokes[0, :, cycle_column("force_max", 0)] = 10.0
    strokes[0, 1, cycle_column("force_max", 2)] = 30.0
    samples = samples_of(press, strokes)
    assert samples["guide.force_max"] == 20.0  # of the corner that presses most
    assert {*of_guides, "total_clearance"} == {*levels, "guide.force_max"}


def test_noise_of_the_maps_hardly_makes_the_deepest_place_deeper() -> None:
    """Each of eight maps has an even noise of a tenth of its depth in 120 places."""
    scene = pw.scenes.press_blanking(conventions="refined", replicates=8)
    draw = np.random.default_rng(4)
    shape = map_shape(scene.linkage().clearances)
    groove = np.exp(-((np.arange(shape[-1]) - 40.0) ** 2) / 200.0)
    excess = []
    for _ in range(40):
        factors = 1.0 + 0.1 * draw.uniform(-1.0, 1.0, (8, *shape))
        depth = 1e-5 * groove * factors
        pseudo = pseudo_levels_of(scene, depth, ())["A.depth"]
        plain = levels_of(scene, depth, ())["A.depth"]
        excess.append([pseudo.mean() / 1e-5 - 1.0, plain.mean() / 1e-5 - 1.0])
        of_mean_volume = pseudo_levels_of(scene, depth, ())["A.wear_volume"]
        of_volumes = levels_of(scene, depth, ())["A.wear_volume"]
        np.testing.assert_allclose(of_mean_volume, of_volumes, rtol=1e-12)
    of_mean, of_each = np.mean(excess, axis=0)
    assert abs(of_mean) < 0.02 < 0.05 < of_each


JOINTS = {"A": 1e-4, "B": 2e-4}


def scene_of(part: float = 0.02, share: float = 1.0, **life: Any) -> pw.Scene:
    """Return a bushing worn until it has lost a part of its clearance, two replicates."""
    settings: dict[str, Any] = {"until": f"B.depth > {part * GAP!r} m", "at_most": 1e12}
    limits = pw.Life(**settings | life)
    return bush(
        share=share, life=limits, replicates=2, wear_updates=1, cycles=3, tolerance=0.5
    )


def life_of_scene(scene: pw.Scene) -> Any:
    return pw.run(scene, jobs=1, check=False).life


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Any]:
    path = tmp_path_factory.mktemp("life") / "whole"
    return path, pw.run(scene_of(), path, jobs=1).life


@given(
    st.sampled_from(sorted(FOLLOWED.keys() - {"tilt"})),  # of guides
    st.sampled_from(("", *JOINTS)),
    st.floats(1e-9, 1e6),
    st.text(" ", max_size=3),
)
def test_limits_are_read(name: str, joint: str, value: float, blank: str) -> None:
    unit, of_joint, *_ = FOLLOWED[name]
    text = f"{blank}{joint + '.' if joint else ''}{name}{blank}>{blank}{value!r} {unit}{blank}"
    if joint and not of_joint:
        with pytest.raises(pw.InputError, match="is of the whole mechanism"):
            pw.Life(until=text).limits(JOINTS, {})
        return
    if name in CLEARANCES and value <= CLEARANCES[name] * max(JOINTS.values()):
        return
    limits = pw.Life(until=text).limits(JOINTS, {})
    joints = [joint] if joint else list(JOINTS) if of_joint else [""]
    assert [(limit.joint, limit.value) for limit in limits] == [
        (each, value) for each in joints
    ]


def test_limits_in_the_words_of_makers() -> None:
    text = "A.clearance >= 0.30 mm, diametral_clearance > 2.5 x new, B.radial_clearance > 3×new"
    limits = pw.Life(until=text).limits(JOINTS, {})
    assert [limit.key for limit in limits] == [
        "A.radial_clearance",
        "A.diametral_clearance",
        "B.diametral_clearance",
        "B.radial_clearance",
    ]
    values = [limit.value for limit in limits]
    assert values == pytest.approx([0.3e-3, 2.5 * 2e-4, 2.5 * 4e-4, 3 * 2e-4])


def test_services_are_read_in_the_order_of_strokes() -> None:
    life = pw.Life(replaced="A@2e6, B@4e6", rotated=" B@1e6")
    expected = [
        Service("B", 1e6, True),
        Service("A", 2e6, False),
        Service("B", 4e6, False),
    ]
    assert list(life.services(tuple(JOINTS), ())) == expected


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"until": "depth 5 um"}, "NAME > VALUE is expected"),
        ({"until": "dept > 5 um"}, "did you mean depth"),
        ({"until": "depth > 5 N"}, "until: depth"),
        ({"until": "D.depth > 5 um"}, "joint with clearance in until"),
        (
            {"until": "A.diametral_clearance > 0.19 mm"},
            "allowed is above 0.2 mm, that of the new joint",
        ),
        ({"until": "A.clearance > 0.9 x new"}, "until: radial_clearance"),
        ({"until": "A.clearance > 2.5 new"}, "VALUE x new is expected, such as 2.5 x"),
        ({"until": "A.clearance > 1 mm 2 x new"}, "VALUE x new is expected"),
        ({"until": "A.play > 1 mm"}, "The radial play of a pin is its clearance"),
        ({"until": "A.depth > 2 x new"}, "'x new' is allowed for clearance, radial_c"),
        (
            {"replaced": "A2e6"},
            r"replaced = 'A2e6': JOINT@STROKES is expected, such as",
        ),
        ({"rotated": "C@2e6"}, "joint with clearance in rotated"),
        ({"rotated": "A@many"}, "rotated: A"),
        ({"replaced": "A@2e6", "at_most": 1e6}, "allowed is below at_most = 1e"),
    ],
)
def test_bad_lives_are_refused(settings: dict[str, Any], message: str) -> None:
    life = pw.Life(**settings)
    with pytest.raises(pw.InputError, match=message):
        life.limits(JOINTS, {}) and life.services(tuple(JOINTS), ())


def test_scenes_without_a_life_are_refused() -> None:
    with pytest.raises(
        pw.InputError, match=r"^replicates = 1 does not fit \[life\]: use 2 to 100"
    ):
        bush(life=pw.Life(), wear_updates=1)
    with pytest.raises(
        pw.InputError, match=r"'B.force_max > 1 N': it is exceeded when new"
    ):
        life_of_scene(scene_of(until="B.depth > 1 mm, force_max > 1 N"))
    with pytest.raises(
        pw.InputError, match=r"'B.depth > 2.1 mm': allowed is below 2 mm, with wear"
    ):
        scene_of(2.1)
    with pytest.raises(pw.InputError, match=r"> 5.5 mm': allowed is below 5 mm, with"):
        scene_of(until="B.clearance > 5.5 mm")
    says = (
        r"joint B wears by 2.00 mm, the most that the model holds for, after .* "
        r"no limit is exceeded before .*; choose"
    )
    with pytest.raises(pw.InputError, match=says):
        life_of_scene(scene_of(until="wear_volume > 1 m^3"))


def test_equal_replicates_leave_the_error_of_the_step(whole: tuple[Path, Any]) -> None:
    life = whole[1]
    assert life.ended == "limit"
    assert life.sampling < 0.01 * life.step
    assert life.error == pytest.approx(life.step, rel=1e-4)
    depth = life.curves["B.depth"][:, 0]
    assert np.all(np.diff(depth) > 0.0)
    at = np.interp(life.strokes, life.curves["strokes"], depth)
    assert at == pytest.approx(0.02 * GAP, rel=1e-9, abs=0.0)


def test_wear_steps_of_a_life_are_its_blocks(whole: tuple[Path, Any]) -> None:
    """Each of their cycles stands for as many strokes as their factor, in both replicates."""
    steps = pw.load(whole[0]).stages[0].wear_steps
    first = FIRST_WEAR / COEFFICIENT
    assert steps[0].cycles == 4
    assert steps[0].factor == pytest.approx(first, rel=1e-15, abs=0.0)
    assert sum(step.factor * step.cycles / 2 for step in steps) == pytest.approx(
        whole[1].strokes
    )


def test_no_number_depends_on_the_processes(
    whole: tuple[Path, Any], tmp_path: Path
) -> None:
    pw.run(pw.load(whole[0]).scene, tmp_path / "two", jobs=2)
    assert folder_differences(whole[0], tmp_path / "two") == []


def test_refinements_start_differently(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replicates of refinements and of stages are independent, if no two of them start alike."""
    call = replicates.WorkUnit.__call__
    advance = WearHistories.advance
    started: list[int] = []
    numbers: dict[int, set[int]] = {}  # of replicates, by refinement

    def starting(self: replicates.WorkUnit, report: Any) -> Any:
        started.append(self.part.replicate)
        return call(self, report)

    def noting(self: Any, refinements: Refinements, plan: Any) -> Any:
        first = len(started)
        block = advance(self, refinements, plan)
        numbers.setdefault(len(refinements), set()).update(started[first:])
        return block

    monkeypatch.setattr(replicates.WorkUnit, "__call__", starting)
    monkeypatch.setattr(WearHistories, "advance", noting)
    life = life_of_scene(scene_of())
    assert len(numbers) == len(life.refinements) > 1
    assert all(len(each) == 2 for each in numbers.values())
    assert len(set.union(*numbers.values(), {0, 1})) == 2 * (len(numbers) + 1)


class Stops(pw.engines.Observer):
    """Interrupts a refinement after a number of reports on it."""

    def __init__(self, number: int, reports: int) -> None:
        self.word = f"refinement {number}"
        self.left = reports

    def on_progress(self, progress: pw.engines.Progress) -> None:
        if self.word in progress.word:
            self.left -= 1
            if not self.left:
                raise KeyboardInterrupt


class Lives(pw.engines.Observer):
    """Keeps the lives that a run reports."""

    def __init__(self) -> None:
        self.lives: list[LifeResult] = []

    def on_life(self, life: LifeResult) -> None:
        self.lives.append(life)


def test_the_life_by_the_last_rate_is_a_straight_line() -> None:
    """Depths of 1 and 3 um after 100,000 and 200,000 strokes."""
    scene = scene_of()
    levels = [{"A.depth": np.full(8, depth)} for depth in (1e-6, 3e-6)]
    blocks = [load_block(1e5 * (k + 1), 8, levels[k], 2e-11) for k in range(2)]
    refinements = [Refinement(5e-3, 8, tuple(blocks))]
    life = life_by_rate(scene, problem(DEPTH), refinements)
    assert life is not None
    expected = 2e5 + 1e5 * (DEPTH.value - 3e-6) / 2e-6
    assert life.strokes == life.limits[0].strokes == pytest.approx(expected)
    assert life.error is None
    assert f"{life}".startswith("preliminary life: ")
    assert (
        "by the wear rate after 200\u202f000 strokes, with an unknown error"
        in f"{life}"
    )
    early = problem(DEPTH, at_most=0.5 * expected)
    assert life_by_rate(scene, early, refinements) is None
    still = [Refinement(5e-3, 8, (blocks[1], replace(blocks[1], strokes=3e5)))]
    assert life_by_rate(scene, problem(DEPTH), still) is None


def test_a_life_is_known_roughly_before_its_first_refinement_ends() -> None:
    seen = Lives()
    pw.run(scene_of(), observers=[seen], jobs=1)
    early = [life for life in seen.lives if "by the wear rate" in life.message]
    assert early == seen.lives[: len(early)] != []
    assert 0.5 < early[0].strokes / seen.lives[-1].strokes < 2.0


@pytest.mark.parametrize(("number", "reports"), [(1, 3), (2, 30)])
def test_interrupted_life_resumes_bit_for_bit(
    number: int, reports: int, whole: tuple[Path, Any], tmp_path: Path
) -> None:
    scene = pw.load(whole[0]).scene
    path = tmp_path / "stopped"
    with pytest.raises(KeyboardInterrupt):
        pw.run(scene, path, observers=[Stops(number, reports)], jobs=1)
    pw.run(scene, path, jobs=1)
    assert folder_differences(whole[0], path) == []


def with_wear(scene: pw.Scene, factor: float) -> pw.Scene:
    """Return a scene with all wear coefficients times a factor."""
    settings = {}
    for name in scene.clearance_joints:
        coefficient = scene.bearing(name).materials.wear_coefficient
        settings[f"{name}.wear_coefficient"] = f"{factor * coefficient!r}/Pa"
    return changed(scene, settings)


def test_life_is_inversely_proportional_to_the_wear_coefficient(
    whole: tuple[Path, Any],
) -> None:
    """A motion without chaos wears the same surfaces one after another."""
    life = life_of_scene(with_wear(pw.load(whole[0]).scene, 10.0))
    assert 10.0 * life.strokes == pytest.approx(whole[1].strokes, rel=1e-6, abs=0.0)
    # Readings of these joints tell their coefficient and the strokes that they have left.
    strokes = life.curves["strokes"]
    depth = life.curves["B.depth"][:, 0]
    readings = [
        pw.results.Reading("B", float(strokes[k]), "depth", float(depth[k]), 1e-8)
        for k in (len(strokes) // 3, len(strokes) // 2)
    ]
    left = pw.results.remaining_life(pw.load(whole[0]), readings)
    factor = left.joints[0].factor
    assert factor.mean == pytest.approx(10.0, rel=1e-3)
    expected = life.strokes - readings[-1].strokes
    assert left.remaining.mean == pytest.approx(expected, rel=0.01)
    assert left.remaining.low < expected < left.remaining.high


def test_first_block_is_that_of_the_pressures_of_the_scene() -> None:
    """The strokes of steel at K_d, 1 kPa, would wear off ten times the limit at once."""
    law = {"pressure_exponent": 3.0, "pressure_reference": "1 kPa"}
    lives = [
        life_of_scene(changed(scene_of(), law | {"B.wear_coefficient": f"{size}/Pa"}))
        for size in (1e-20, 1e-22)
    ]
    assert [life.ended for life in lives] == ["limit", "limit"]
    assert lives[0].curves["B.depth"][0, 0] < 0.5 * 0.02 * GAP
    ratio = lives[1].strokes / lives[0].strokes
    assert ratio == pytest.approx(100.0, rel=1e-6)


def test_readings_of_a_stored_life(
    whole: tuple[Path, Any], tmp_path: Path, command: Callable[..., str]
) -> None:
    """Nothing is run, and a later report has the lines that are printed."""
    folder = tmp_path / "life"
    file = tmp_path / "readings.csv"
    shutil.copytree(whole[0], folder)
    at = 0.25 * whole[1].strokes
    file.write_text(f"joint,strokes,depth (um),error (um)\nB,{at},6,0.5\n")
    line = f"life {folder} --readings {file} --no-report"
    output = command(line)
    assert f"results in {folder}\nremaining life: " in output
    assert (folder / "readings.csv").read_bytes() == file.read_bytes()
    page = render_report(pw.load(folder)).replace("\xa0", " ")
    printed = [line for line in output.splitlines() if line.startswith(("rem", "B: "))]
    assert len(printed) == 2
    assert [line for line in printed if line not in page] == []
    assert "cannot be combined with --replace" in command(f"{line} --rotate B@1e3", 2)
    file.write_text("joint,strokes,depth (um)\nB,1e6,6\n")
    assert "1 without an error" in command(line, 2)
    (folder / "readings.csv").write_text("joint\n")
    assert "readings.csv: it has no rows" in render_report(pw.load(folder))


@pytest.mark.parametrize(
    ("key", "word"), [("replaced", "replaced"), ("rotated", "rotated by half a turn")]
)
def test_maintenance_adds_a_life(key: str, word: str, whole: tuple[Path, Any]) -> None:
    """It alone wears, and on one side: new or rotated, the loaded side has lost nothing."""
    at = 0.6 * whole[1].strokes
    settings: dict[str, Any] = {key: f"B@{at!r}"}
    life = life_of_scene(scene_of(**settings))
    assert life.services == (f"bushing of B {word} after {at:.4g} strokes",)
    assert life.strokes == pytest.approx(at + whole[1].strokes, rel=0.05)
    strokes = life.curves["strokes"]
    depth = life.curves["B.depth"][:, 0]
    k = int(np.flatnonzero(np.diff(strokes) == 0.0)[0])
    assert strokes[k] == pytest.approx(at, rel=1e-9, abs=0.0)
    assert depth[k + 1] == (0.0 if key == "replaced" else depth[k])


def test_a_replaced_bushing_runs_in_again_under_a_power_of_the_pressure() -> None:
    """Only the bushing wears, so that the course after the service is that when new."""
    law = {"running_in": 20.0, "running_in_depth": "4 um"}
    law |= {"pressure_exponent": 0.7, "pressure_reference": "1 MPa"}
    at = 5e4
    life = life_of_scene(changed(scene_of(replaced=f"B@{at}"), law))
    strokes = life.curves["strokes"]
    depth = life.curves["B.depth"][:, 0]
    k = int(np.flatnonzero(np.diff(strokes) == 0.0)[0])
    assert depth[k + 1] == 0.0
    levels = np.linspace(2e-6, 0.9 * depth[k], 6)
    before = np.interp(levels, depth[: k + 1], strokes[: k + 1])
    after = np.interp(levels, depth[k + 1 :], strokes[k + 1 :]) - at
    np.testing.assert_allclose(after, before, rtol=0.01)
    # Surfaces that run in wear the first of these depths several times as fast.
    assert before[1] - before[0] < 0.5 * (before[-1] - before[-2])


def test_limit_that_is_not_exceeded_ends_with_the_strokes(
    whole: tuple[Path, Any],
) -> None:
    at_most = 0.5 * whole[1].strokes
    life = life_of_scene(scene_of(at_most=at_most))
    assert (life.ended, life.first) == ("at_most", None)
    assert life.strokes == pytest.approx(at_most)
    assert life.limits[0].last < 0.02 * GAP


def evenly_worn(cycles: int, strokes: float, **rates: float) -> Refinement:
    """Return a refinement of two histories that wear evenly and differ by a hundredth."""
    blocks = []
    for k in range(cycles + 1):
        depth = strokes * k / cycles * np.array([0.99, 1.01])
        levels = {f"{joint}.depth": rate * depth for joint, rate in rates.items()}
        levels |= {
            f"{joint}.wear_volume": 1e-6 * rate * depth for joint, rate in rates.items()
        }
        removed = np.full((len(rates), 2, 8), 1e-12)
        now = strokes * k / cycles
        blocks.append(
            load_block(now, int(k > 0), levels, 1e-9 * CLEARANCE, removed=removed)
        )
    return Refinement(1.0 / cycles, 1, tuple(blocks))


def test_first_limit_is_as_accurate_as_the_life() -> None:
    """The coarser refinement ended with another limit, before it came to this one."""
    settings = {
        "life": "limits",
        "life.until": "depth > 0.05 mm",
        "conventions": "refined",
    }
    scene = changed(pw.scenes.wear_times(), settings)
    coarse = evenly_worn(10, 1.04e6, A=5e-11, C=4.5e-11)
    both = coarse, evenly_worn(40, 1.04e6, A=4.7e-11, C=4.9e-11)
    limits = (Limit("depth", joint, 0.05e-3) for joint in "AC")
    life = life_result(scene, problem(*limits), both)
    first = life.first
    assert (first.key, life.limits[0].step) == ("C.depth", None)
    assert (first.strokes, first.sampling, first.step) == (
        life.strokes,
        life.sampling,
        life.step,
    )


def test_interval_with_the_wear_coefficients_is_one_of_95_percent() -> None:
    """A lognormal coefficient with a standard deviation of half of its mean."""
    settings = {
        "life": "limits",
        "life.until": "A.depth > 0.05 mm",
        "conventions": "refined",
    }
    scene = changed(pw.scenes.wear_times(), settings)
    assert [scene.bearing(name).materials.wear_scatter for name in ("A", "C")] == [
        0.5,
        0.5,
    ]
    life = life_result(scene, problem(DEPTH), [evenly_worn(10, 2e6, A=5e-11, C=1e-11)])
    low, high = stats.lognorm.ppf((0.025, 0.975), math.sqrt(math.log(1.0 + 0.5**2)))
    assert math.exp(life.scatter) == pytest.approx(math.sqrt(high / low), rel=1e-12)


def test_life_ends_with_the_cycle_that_wears_through_the_clearance() -> None:
    """Strokes are counted up to that cycle, within a block: Archard's rate stays."""
    surfaces = {"B": (np.full(120, 0.973 * GAP), None)}
    scene = scene_of(until="wear_volume > 1 m^3")
    radial = replace(scene.conventions, contact="radial")
    life = life_of_scene(replace(scene, conventions=radial, surfaces=surfaces))
    assert life.ended == "worn"
    assert "more than 1.00 mm, with a clearance of 1.00 mm" in life.message
    strokes = life.curves["strokes"]
    volume = life.curves["B.wear_volume"][:, 0]
    rates = np.diff(volume) / np.diff(strokes)
    assert rates[1:] == pytest.approx(rates[1], rel=1e-3, abs=0.0)
    assert life.strokes == strokes[-1]
    # Both replicates end within a block of two cycles.
    assert life.refinements[-1].cycles % 4 != 0


def fails_at(depth: float) -> Callable[..., Finding | None]:
    """Return an examination that finds something once a surface is so deep, m."""

    def examine(
        linkage: pw.linkage.Linkage, recorder: Recorder, now: Condition
    ) -> Finding | None:
        if recorder.surface_depth.max(initial=-np.inf) > depth:
            return Finding("state", "the state is no longer finite", now.time, "B", "")
        return None

    return examine


def test_failed_run_ends_a_life(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driver, "examine", fails_at(0.01 * GAP))
    life = life_of_scene(scene_of())
    assert life.ended == "worn"
    assert "no longer finite" in life.message
    assert 0.0 < life.limits[0].last < 0.011 * GAP
    monkeypatch.setattr(driver, "examine", fails_at(-1.0))
    with pytest.raises(pw.RunFailed, match="no longer finite"):
        pw.run(scene_of(), jobs=1)
