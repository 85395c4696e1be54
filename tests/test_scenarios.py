"""Every script in scenarios/ runs, and says a number."""

import re
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


@pytest.mark.slow
def test_a_stiff_joint_becomes_ideal_in_every_figure(capsys: pytest.CaptureFixture[str]) -> None:
    """Places with order 1; forces and torques with about 1/2, the half power of a gap that opens.

    Where a joint's force passes zero at an even rate a pin crosses its clearance c in a time of
    c^(1/3) and arrives with c^(2/3); such an impact is of c^(4/5) K^(2/5), here c^(1/2).
    """
    runpy.run_path(str(SCENARIOS / "stiff_joint.py"))["main"]()
    rows = [re.split(r"  +", line) for line in capsys.readouterr().out.splitlines()]
    found = {row[0]: [float(value) for value in row[1:]] for row in rows}
    assert len(found) == 10
    for name, (*values, order) in found.items():
        lowest, highest = (0.95, 1.05) if name.endswith("(m)") else (0.1, 1.1)
        assert lowest < order < highest, name
        assert values[-1] < 0.5 * values[0], name


def test_scripts_are_short() -> None:
    for script in SCENARIOS.glob("*.py"):
        code = [line for line in script.read_text().splitlines() if line.strip()]
        assert len(code) <= 25, script.name
