"""Do intervals of 95 % contain the true value?  Run: pytest -m coverage."""

import math
from pathlib import Path

import numpy as np
import pytest

import presswear as pw
from intervals.coverage import (
    HEADER,
    LONG_RUNS,
    SUBJECTS,
    coverages,
    scenes_of,
    table,
)

FOLDER = Path("results/coverage")  # finished runs in it are not repeated
FEW = 6  # tries of --quick, which show that the command runs


@pytest.mark.coverage
@pytest.mark.parametrize("name", SUBJECTS)
def test_intervals_contain_the_true_value(name, request):
    """Tries with seeds of their own against long runs; the table is printed and stored."""
    is_quick = bool(request.config.getoption("--quick"))
    scenes = scenes_of(SUBJECTS[name], FEW if is_quick else None)
    jobs = request.config.getoption("--jobs")
    results = pw.run_scenes(scenes, FOLDER / name, jobs=int(jobs) if jobs else None)
    failures = []
    for stage in range(SUBJECTS[name].scene.wear_updates + 1):
        rows = table(results, stage)
        text = "\n".join([HEADER, *(f"| {row} |" for row in rows)])
        (FOLDER / f"{name}-{stage}.md").write_text(f"{text}\n", encoding="utf-8")
        print(f"{name}, stage {stage}\n{text}")
        failures += [f"stage {stage}: {row}" for row in rows if not row.passes]
    assert is_quick or not failures, failures


@pytest.mark.parametrize(("half", "passes"), [(2.0, True), (1.0, False)])
def test_intervals_that_hold_are_distinguished(half, passes):
    """Half widths in standard deviations of the estimates: 1 holds in 68 %."""
    draws = 200.0 + 4.0 * np.random.default_rng(3).standard_normal(400)
    tries = [{"force": (draw, draw - half * 4.0, draw + half * 4.0)} for draw in draws]
    long = [{"force": (200.0 + off, math.nan, math.nan)} for off in (-1.0, 0.0, 1.0)]
    (coverage,) = coverages(long, tries, [False] * len(tries))
    assert coverage.passes == passes
    assert coverage.truth == pytest.approx(200.0)
    assert coverage.error == pytest.approx(4.3027 / math.sqrt(3.0), rel=1e-4)
    assert coverage.bias == pytest.approx(0.0, abs=0.06)
    # Whoever says that the motion has not settled states no wrong interval.
    (warned,) = coverages(long, tries, [True] * len(tries))
    assert warned.share == 1.0
    # A quantity without an interval is not counted.
    (silent,) = coverages(long, long, [False] * len(long))
    assert not silent.stated.any()


def test_tries_share_no_seed_with_each_other_or_the_long_runs():
    for subject in SUBJECTS.values():
        scenes = scenes_of(subject)
        seeds = sorted(scene.seed for scene in scenes.values())
        assert seeds == list(range(1, subject.tries + LONG_RUNS + 1))
        for name, scene in scenes.items():
            assert (scene.cycles == subject.cycles) == name.startswith("long")
