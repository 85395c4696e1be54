"""Cost of a step beside the loop by hand, and of a first start."""

import csv
from pathlib import Path

import pytest

from presswear.__main__ import main
from presswear.validation import step_costs
from presswear.validation.step_costs import LOOP, StepExtent


def silent(name: str, part: float) -> None:
    """Ignore progress."""


def test_steps_of_dae_are_timed_beside_those_of_the_loop() -> None:
    rows = step_costs.step_costs(StepExtent(repeats=1, cycles=1), silent)
    loop, radial, foundation, worn = rows
    assert loop["method"] == LOOP
    assert loop["relative"] == loop["relative_trial"] == 1.0
    # Both end their steps at the same events, at one tolerance by two norms.
    steps = [float(str(row["steps_per_cycle"])) for row in (loop, radial)]
    assert steps[1] == pytest.approx(steps[0], rel=0.3)
    costs = [float(str(row["cpu_s_per_step"])) for row in (radial, foundation, worn)]
    assert costs[2] > 1.5 * max(costs[:2])


def test_command_writes_steps_and_starts(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    numbers = "cpu_s_per_step", "relative", "steps_per_cycle", "cpu_s_per_cycle"
    steps = [{"method": LOOP, **dict.fromkeys(numbers, 1.0)}]
    starts = [{"engine": "dae", "first_start_s": 6.7, "second_start_s": 1.3}]
    monkeypatch.setattr(step_costs, "step_costs", lambda extent, report: steps)
    monkeypatch.setattr(step_costs, "start_costs", lambda report: starts)
    assert main(["benchmark", "--steps", "--out", f"{tmp_path / 'out'}"]) == 0
    assert "6.7" in capsys.readouterr().out
    with (tmp_path / "out" / "starts.csv").open() as file:
        assert [row["engine"] for row in csv.DictReader(file)] == ["dae"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--features"], "--features and --steps cannot be combined"),
        (["friction"], "--steps: the hand-written loop solves wear-times as it is"),
        (["--set", "cycles=4"], "--steps: the hand-written loop solves wear-times"),
    ],
)
def test_steps_of_another_scene_are_refused(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["benchmark", "--steps", *words]) == 2
    assert message in capsys.readouterr().err
