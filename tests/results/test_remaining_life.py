"""Remaining life from readings: closed forms, and histories of known wear coefficients."""
# mypy: disable-error-code="union-attr,operator,arg-type"

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from refusals import refused
from scipy import stats

import presswear as pw
from presswear.physics.running_in import RunningIn
from presswear.results.life import LifeResult
from presswear.results.life_from_readings import remaining_life
from presswear.results.readings import Reading, read_readings
from presswear.results.result import Result
from presswear.results.steady_wear import steady_wear
from presswear.results.wear_posterior import Observed, Shape, posterior_of
from presswear.tools.arrays import Array

LIMIT = 50e-6
RATE = 5e-12  # of steady wear, m per stroke
LAW = RunningIn(5.0, 8e-6)
STROKES = np.linspace(0.0, 8e6, 400)[1:]


def scene_with(until: str = "B.depth > 50 um", **settings: Any) -> pw.Scene:
    return pw.scenes.slider_crank(
        conventions="refined",
        replicates=2,
        wear_updates=1,
        life=pw.Life(until=until),
        **settings,
    )


def depth_after(strokes: Any) -> Array:
    """Return the depth of a surface that runs in, at the coefficient of the scene."""
    return LAW.worn(np.zeros(np.shape(strokes)), RATE * np.asarray(strokes))


def result_with(
    scene: pw.Scene, curves: dict[str, Array], sampling: float = 0.0
) -> Result:
    """Return a result with some curves of worn depth and a sampling error."""
    bands = {name: np.column_stack([y, y, y]) for name, y in curves.items()}
    bands["strokes"] = STROKES
    life = LifeResult(
        ended="limit",
        message="",
        strokes=7e6,
        sampling=sampling,
        step=0.0,
        scatter=0.9,
        limits=(),
        refinements=(),
        curves=bands,
    )
    return Result(scene, (), "completed", "", {}, 0.0, None, life)


SCENE = scene_with()
DEPTH = depth_after(STROKES)
RESULT = result_with(SCENE, {"B.depth": DEPTH})
DEVIATION = math.sqrt(math.log1p(0.5**2))  # of the logarithm of the coefficient
LIFE = float(LAW.archard_depth(np.array(LIMIT))) / RATE  # strokes, exact


def readings_of(strokes: Array, depths: Array, error: float | None) -> list[Reading]:
    rows = zip(strokes, depths, strict=True)
    return [Reading("B", n, "depth", float(depth), error) for n, depth in rows]


def history(
    draw: np.random.Generator, count: int, error: float, has_error: bool
) -> tuple[float, list[Reading]]:
    """Return a factor on the coefficient and readings at even strokes up to half of the life."""
    factor = draw.lognormal(0.0, DEVIATION)
    strokes = np.linspace(0.0, 0.5 * LIFE / factor, count + 1)[1:]
    values = depth_after(factor * strokes) + draw.normal(0.0, error, count)
    return factor, readings_of(strokes, values, error if has_error else None)


@pytest.mark.parametrize(
    ("count", "error", "has_error"),
    [(1, 2e-6, True), (4, 2e-6, True), (8, 5e-6, False)],
)
def test_intervals_hold_the_remaining_life(count, error, has_error):
    """About 95 % of 40 histories with the scatter of the coefficient of the materials."""
    draw = np.random.default_rng(count)
    covered = 0
    for _ in range(40):
        factor, readings = history(draw, count, error, has_error)
        prediction = remaining_life(RESULT, readings).remaining
        exact = LIFE / factor - readings[-1].strokes
        covered += prediction.low <= exact <= prediction.high
    low, high = stats.binom.ppf((0.001, 0.999), 40, 0.95)
    assert low <= covered <= high


def observed(
    values: Any, strokes: Any = (1e6, 2e6, 3e6), error: float | None = 1e-6
) -> Observed:
    errors = None if error is None else np.full(len(values), error)
    return Observed(np.array(strokes, float), np.array(values, float), errors, False)


EVEN_STROKES = np.linspace(1e6, 8e6, 8)
EVEN = Shape.of(EVEN_STROKES, RATE * EVEN_STROKES, 0.0)


@pytest.mark.parametrize("error", [3e-6, None], ids=["known", "unknown"])
def test_posterior_is_the_integral_over_prior_and_likelihood(error):
    """Wear is linear in the coefficient here; an unknown error is integrated out."""
    values = np.array([6e-6, 9e-6, 17e-6])
    strokes = np.array([1e6, 2e6, 3e6])
    f = np.linspace(1e-3, 6.0, 200_001)
    squares = ((values - RATE * f[:, np.newaxis] * strokes) ** 2).sum(axis=1)
    likelihood = squares**-1.5 if error is None else np.exp(-0.5 * squares / error**2)
    density = likelihood * stats.lognorm.pdf(f, DEVIATION)
    below = np.cumsum(density) / density.sum()
    levels = np.array([0.025, 0.5, 0.975])
    exact = np.interp(levels, below, f)
    posterior = posterior_of(EVEN, observed(values, error=error), 0.5)
    assert posterior.has_prior
    assert posterior.quantiles(levels) == pytest.approx(exact, rel=2e-3)


def test_a_joint_without_readings_keeps_the_scatter_of_its_materials():
    """The remaining life is the minimum of the independent lives of A and C."""
    scene = pw.scenes.press_blanking(life=pw.Life(until="depth > 50 um"))
    result = result_with(scene, {"A.depth": DEPTH, "C.depth": DEPTH})
    value = float(depth_after(1e6))
    prediction = remaining_life(result, [Reading("A", 1e6, "depth", value, 1e-9)])
    ends = LIFE * np.exp(1.96 * DEVIATION * np.array([-1.0, 0.0, 1.0]))
    unread = prediction.each["C"]
    assert [unread.low, unread.mean, unread.high] == pytest.approx(ends, rel=5e-3)
    assert prediction.each["A"].mean == pytest.approx(LIFE, rel=2e-3)
    # C lives longer than A with a probability of one half. The limit is then that of A.
    assert prediction.remaining.high == pytest.approx(LIFE - 1e6, rel=5e-3)
    assert prediction.remaining.low == pytest.approx(ends[0] - 1e6, rel=0.02)
    assert [joint.joint for joint in prediction.joints] == ["A"]


def test_the_walls_of_a_guide_wear_beside_a_pin():
    """Depth of B and of the walls was read."""
    scene = scene_with(
        "depth > 50 um", joints="B, guide", guide_length=0.06, guide_width=0.04
    )
    assert [limit.key for limit in scene.life_limits] == ["B.depth", "guide.depth"]
    result = result_with(scene, {"B.depth": DEPTH, "guide.depth": DEPTH})
    value = float(depth_after(1e6))
    readings = [Reading(joint, 1e6, "depth", value, 1e-9) for joint in ("B", "guide")]
    prediction = remaining_life(result, readings)
    assert prediction.each["B"].mean == pytest.approx(LIFE, rel=2e-3)
    assert prediction.each["guide"].low == pytest.approx(LIFE, rel=2e-3)
    gap = Reading("guide", 1e6, "radial_clearance", 1e-4, 1e-6)
    with refused("radial_clearance is of a pin; of the wal"):
        remaining_life(result, [gap])


def test_readings_far_from_the_prior_are_used_alone():
    """An oiled joint that wears a ten-thousandth of the coefficient of the scene."""
    strokes = np.array([1e9, 4e9, 8e9])
    readings = readings_of(strokes, depth_after(1e-4 * strokes), 1e-7)
    prediction = remaining_life(RESULT, readings)
    factor = prediction.joints[0].factor
    assert factor.low < 1e-4 < factor.high < 1.1e-4
    assert "the readings are used alone" in prediction.lines[-1]
    assert prediction.remaining.low < 1e4 * LIFE - 8e9 < prediction.remaining.high


def test_clearance_when_new_is_taken_from_the_readings():
    """A joint with more clearance than in the scene reaches the limit sooner."""
    scene = scene_with("B.diametral_clearance > 3 x new")
    new = 2.0 * scene.bearing("B").clearance
    limit = scene.life_limits[0].value
    result = result_with(scene, {"B.diametral_clearance": new + 40.0 * DEPTH})
    more = 0.2 * new
    strokes = np.array([0.0, 1e6, 2e6])
    values = new + more + 40.0 * depth_after(strokes)
    rows = zip(strokes, values, strict=True)
    readings = [Reading("B", n, "diametral_clearance", float(d), 1e-7) for n, d in rows]
    prediction = remaining_life(result, readings)
    depth = (limit - more - new) / 40.0
    exact = float(LAW.archard_depth(np.array(depth))) / RATE
    assert prediction.remaining.mean == pytest.approx(exact - 2e6, rel=2e-3)
    assert not prediction.joints[0].warnings
    wrong = remaining_life(
        result, [Reading("B", 2e6, "diametral_clearance", values[2], 1e-7)]
    )
    assert wrong.remaining.mean < 0.99 * prediction.remaining.mean


def test_a_line_of_diametral_readings_ends_at_a_radial_limit():
    scene = scene_with("B.clearance > 3 x new")
    new = scene.bearing("B").clearance
    course = new + 20.0 * DEPTH
    curves = {"B.radial_clearance": course, "B.diametral_clearance": 2.0 * course}
    strokes = (1e6, 2e6, 3e6)
    readings = [
        Reading("B", n, "diametral_clearance", 2.0 * new + 2e-10 * n, 1e-6)
        for n in strokes
    ]
    prediction = remaining_life(result_with(scene, curves), readings)
    line = prediction.joints[0].steady
    assert line.until.mean == pytest.approx(4.0 * new / 2e-10, rel=1e-6)


def test_readings_that_disagree_with_the_shape_are_reported():
    """Residuals widen the interval, and the exponent is that of the readings."""
    strokes = np.linspace(0.5e6, 4e6, 8)
    values = depth_after(1e6 * (strokes / 1e6) ** 0.6)
    both = [
        remaining_life(RESULT, readings_of(strokes, course, 2e-7))
        for course in (values, depth_after(strokes))
    ]
    different = both[0].joints[0]
    equal = both[1].joints[0]
    assert different.exponent.value.mean == pytest.approx(0.6, abs=1e-3)
    assert different.exponent.disagrees
    assert sum("disagree" in line for line in both[0].lines) == 2
    assert equal.exponent.value.mean == pytest.approx(1.0, abs=1e-3)
    assert not equal.warnings
    widths = [
        math.log(joint.factor.high / joint.factor.low) for joint in (different, equal)
    ]
    assert widths[0] > 3.0 * widths[1]


def test_straight_line_is_that_of_least_squares():
    """Its life ends where the limit leaves the band of the line."""
    strokes = np.array([1e6, 2e6, 3e6, 4e6, 5e6])
    values = np.array([9e-6, 12e-6, 18e-6, 21e-6, 27e-6])
    line = steady_wear(observed(values, strokes, None), 1e-6, LIMIT)
    fit = stats.linregress(strokes, values - 1e-6)
    student = stats.t.ppf(0.975, 3)
    assert line.rate.mean == pytest.approx(fit.slope)
    assert line.rate.half_width == pytest.approx(student * fit.stderr)
    assert line.running_in.mean == pytest.approx(fit.intercept)
    assert line.running_in.half_width == pytest.approx(student * fit.intercept_stderr)
    spread = math.sqrt(
        ((values - 1e-6 - fit.intercept - fit.slope * strokes) ** 2).sum() / 3
    )
    about = ((strokes - 3e6) ** 2).sum()
    for end in (line.until.low, line.until.high):
        band = spread * math.sqrt(0.2 + (end - 3e6) ** 2 / about)
        distance = abs(fit.intercept + fit.slope * end - (LIMIT - 1e-6))
        assert distance == pytest.approx(student * band, rel=1e-6)
    assert line.until.low < line.until.mean < line.until.high


def test_a_line_without_wear_has_no_last_stroke():
    line = steady_wear(observed([9e-6, 8e-6, 10e-6], error=None), 0.0, LIMIT)
    assert math.isinf(line.until.high)
    assert steady_wear(observed([1e-6, 2e-6], (1e6, 2e6)), 0.0, LIMIT) is None


def test_a_limit_that_is_exceeded_leaves_no_strokes():
    prediction = remaining_life(RESULT, [Reading("B", 4e6, "depth", 60e-6, 1e-6)])
    assert prediction.remaining.high == 0.0
    assert prediction.exceeded > 0.99
    assert "already exceeded with a probability of over 0.99" in str(prediction)


@pytest.mark.parametrize("strokes", [3e6, 6e6])
def test_sampling_error_of_the_life_widens_the_interval(strokes):
    """After an early reading it grows as the root of the remaining strokes."""
    value = float(depth_after(strokes))
    readings = [Reading("B", strokes, "depth", value, 1e-9)]
    prediction = remaining_life(result_with(SCENE, {"B.depth": DEPTH}, 0.3), readings)
    half = 0.3 * math.sqrt(max(LIFE / strokes - 1.0, 1.0))
    assert math.log(prediction.each["B"].high / LIFE) == pytest.approx(half, rel=0.02)


TABLE = "joint,strokes,depth (um),error (um)"


def test_table_of_readings(tmp_path):
    file = tmp_path / "readings.csv"
    file.write_text(
        "# gauge 7\nstrokes;joint;clearance (mm);error\n1e6;B;0.11;\n2e6;A;12;4 um\n"
    )
    assert read_readings(file) == (
        Reading("B", 1e6, "radial_clearance", 0.11e-3),
        Reading("A", 2e6, "radial_clearance", 12e-3, 4e-6),
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "it has no rows"),
        ("joint,strokes\nB,1\n", "a header as joint,strokes"),
        (f"{TABLE},depth (mm)\nB,1,2,1,1\n", "a header as joint,strokes"),
        (f"{TABLE}\nB,1,2\n", "line 2: 3 values for 4 columns"),
        (f"{TABLE}\nB,-1,2,1\n", "line 2: strokes = -1"),
        (f"{TABLE}\nB,1,2,0\n", "line 2: error of B = 0.0 m: allowed is above 0"),
        (f"{TABLE}\nB,1,many,1\n", "line 2: depth = 'many um'"),
        ("joint,strokes,depth\nB,1,2\n", "line 2: depth = '2' has no unit"),
        (f"{TABLE}\nX,1,2,1\n", "unknown joint with clearance in the readings 'X'"),
        (f"{TABLE}\nB,1,2,\n", "1 without an error; add the column error"),
        (f"{TABLE}\nB,1,2,1\nB,2,3,\n", "1 of 2 have an error"),
        (f"{TABLE}\nB,0,0,1\n", "one after some strokes is needed"),
        ("joint,strokes,clearance (mm),error (mm)\nB,1,2,1\n", "does not follow"),
    ],
)
def test_wrong_tables_are_refused(text, words, tmp_path):
    file = tmp_path / "readings.csv"
    file.write_text(text)
    with pytest.raises(pw.InputError) as caught:
        remaining_life(RESULT, file)
    assert words in str(caught.value)


def test_lives_that_readings_do_not_fit_are_refused():
    reading = [Reading("B", 1e6, "depth", 1e-5, 1e-6)]
    cases = {
        "bushings that are serviced": pw.changed(SCENE, {"life.replaced": "B@1e6"}),
        "has no service life": pw.scenes.slider_crank(),
        "omit --quick": pw.changed(SCENE, {"life.quick": "on"}),
    }
    for words, scene in cases.items():
        with refused(words):
            remaining_life(replace(RESULT, scene=scene), reading)
