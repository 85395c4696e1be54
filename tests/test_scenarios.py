"""Every script in scenarios/ runs, and says a number."""

import runpy
import warnings
from pathlib import Path

import pytest

SCENARIOS = Path(__file__).parents[1] / "scenarios"
QUICK = ("compare", "engines", "ideal", "one_joint", "own_linkage", "wear_times")


@pytest.mark.parametrize("name", QUICK)
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
    said = capsys.readouterr().out
    assert any(sign.isdigit() for sign in said)
    assert "failed" not in said


def test_servos_stand_beside_plain_blanking(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(SCENARIOS / "servo.py"))["main"](cycles=1, starts=1)
    said = capsys.readouterr().out
    assert said.count("ideal: stroke") == 4
    assert said.count("A dose_per_cycle_Nm") == 4


def test_scripts_are_short() -> None:
    for script in SCENARIOS.glob("*.py"):
        code = [line for line in script.read_text().splitlines() if line.strip()]
        assert len(code) <= 25, script.name
