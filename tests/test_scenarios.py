"""Scripts in scenarios/: each runs and prints its numbers."""

import math
import runpy
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import presswear as pw

SCENARIOS = Path(__file__).parents[1] / "scenarios"
QUICK = ("compare", "engines", "ideal", "one_joint", "own_linkage")
SLOW = pytest.param("wear_times", marks=pytest.mark.slow)


@pytest.mark.parametrize("name", [*QUICK, SLOW])
def test_a_script_runs(
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ResourceWarning)
        runpy.run_path(str(SCENARIOS / f"{name}.py"), run_name="__main__")
    output = capsys.readouterr().out
    assert any(sign.isdigit() for sign in output)
    assert "failed" not in output


def test_servos_stand_beside_plain_blanking(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(SCENARIOS / "servo.py"))["main"](cycles=1, replicates=1)
    output = capsys.readouterr().out
    assert output.count("ideal: stroke") == 4
    assert output.count("load distance of a cycle at A") == 4


def test_bottom_dead_centre_at_two_speeds_and_with_work(capsys: pytest.CaptureFixture[str]) -> None:
    """The last row is the scene itself, and the last column the change since the first row."""
    main = runpy.run_path(str(SCENARIOS / "bottom.py"))["main"]
    main("press-blanking", cycles=3, replicates=2)
    rows = [line.split(": ")[1].split(" | ") for line in capsys.readouterr().out.splitlines()[1:]]
    assert len(rows) == 4
    scene = pw.scenes.press_blanking(wear_updates=0, cycles=3, replicates=2)
    error = pw.run(scene, engine="dae").stages[0].bdc.error
    first, last, risen = map(_with_half_width, (rows[0][0], rows[-1][0], rows[-1][2]))
    # Printed to two digits of the half width, so rounded by at most a twentieth of it.
    assert last[0] == pytest.approx(1e6 * error.mean, abs=last[1] / 20.0)
    rounded = (first[1] + last[1] + risen[1]) / 20.0
    assert risen[0] == pytest.approx(last[0] - first[0], abs=rounded)
    main("ideal", cycles=3, replicates=1)
    assert len(capsys.readouterr().out.splitlines()) == 3


def _with_half_width(text: str) -> list[float]:
    """Return a number and its half width."""
    return [float(part.replace("−", "-").replace("\u202f", "")) for part in text.split("±")]


def test_second_wear_by_assumption(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    quick = {"engine": "dae", "cycles": 1, "replicates": 1, "cycles_per_update": 1e5, "speed": 60.0}
    script = runpy.run_path(str(SCENARIOS / "runaway.py"))
    script["main"](str(tmp_path / "runaway"), **quick)
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines() if " | " in line]
    assert [row[0] for row in rows[1:-5]] == [label for label, _ in script["ASSUMPTIONS"].values()]
    assert sum(row[4].startswith("0 of 1") for row in rows[1:-5]) >= 19
    assert len(rows[-4:]) == len({row[0] for row in rows[-4:]}) == 4
    assert (tmp_path / "runaway" / "two-wears.png").exists()


@pytest.mark.parametrize(
    ("half", "bias", "passes"), [(2.0, 0.0, True), (1.0, 0.0, False), (2.0, 1.0, False)]
)
def test_intervals_that_hold_are_distinguished(half: float, bias: float, passes: bool) -> None:
    """Half widths in standard deviations of the estimates: 1 holds in 68 %."""
    script = runpy.run_path(str(SCENARIOS / "intervals.py"))
    draws = 200.0 + 4.0 * (bias + np.random.default_rng(3).standard_normal(400))
    campaigns = [[{"force": (draw, draw - half * 4.0, draw + half * 4.0)}] for draw in draws]
    truths = [[{"force": (200.0 + off, math.nan, math.nan)}] for off in (-1.0, 0.0, 1.0)]
    (coverage,) = script["coverages"](truths, campaigns)
    assert coverage.passes == passes
    assert coverage.truth[2] == pytest.approx(200.0 + 4.3027 / math.sqrt(3.0), rel=1e-4)
    assert coverage.bias == pytest.approx(bias / half, abs=0.06)
    # A quantity without an interval cannot hold.
    assert not list(script["coverages"](truths, truths))


def test_campaigns_share_no_seed_with_each_other_or_the_truth() -> None:
    scenes = runpy.run_path(str(SCENARIOS / "intervals.py"))["make_scenes"]("paper")
    assert sorted(scene.seed for scene in scenes.values()) == list(range(1, 101))
    for name, scene in scenes.items():
        assert (scene.cycles == 200) == name.startswith("truth")


@pytest.mark.slow
def test_intervals_of_a_wear_cycle_by_cycle_hold(tmp_path: Path) -> None:
    """Fewer than seventeen of twenty intervals of 95 % hold by chance in one case of forty."""
    script = runpy.run_path(str(SCENARIOS / "intervals.py"))
    every = script["make_scenes"]("refined", wear_updates=1)
    some = {f"campaign-{k}": every[f"campaign-{k}"] for k in range(1, 21)}
    some |= {f"truth-{k}": replace(every[f"truth-{k}"], cycles=100) for k in range(1, 9)}
    results = pw.run_scenes(some, tmp_path, jobs=2)
    stages = [[script["intervals_of"](stage) for stage in one.stages] for one in results.values()]
    wear = [one for one in script["coverages"](stages[20:], stages[:20]) if one.stage == "no wear"]
    assert len(wear) == 1 + 2 * 4
    for coverage in wear:
        assert coverage.held.sum() >= 17, coverage
