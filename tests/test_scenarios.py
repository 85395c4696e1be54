"""Every script in scenarios/ runs, and says a number."""

import runpy
import warnings
from pathlib import Path

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
    said = capsys.readouterr().out
    assert any(sign.isdigit() for sign in said)
    assert "failed" not in said


def test_servos_stand_beside_plain_blanking(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(SCENARIOS / "servo.py"))["main"](cycles=1, replicates=1)
    said = capsys.readouterr().out
    assert said.count("ideal: stroke") == 4
    assert said.count("A dose_per_cycle_Nm") == 4


def test_bottom_dead_centre_at_two_speeds_without_work_and_with_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """The last row is the scene itself, and the last column what it has risen since the first."""
    main = runpy.run_path(str(SCENARIOS / "bottom.py"))["main"]
    main("press-blanking", cycles=3, replicates=2)
    rows = [line.split(": ")[1].split(" | ") for line in capsys.readouterr().out.splitlines()[1:]]
    assert len(rows) == 4
    scene = pw.scenes.press_blanking(wear_updates=0, cycles=3, replicates=2)
    told = pw.run(scene, engine="dae").stages[0].bdc
    first, last, risen = map(_with_half_width, (rows[0][0], rows[-1][0], rows[-1][2]))
    # Told to two digits of the half width: rounded by a twentieth of it at most.
    assert last[0] == pytest.approx(1e6 * told["error_per_cycle_m"]["mean"], abs=last[1] / 20.0)
    rounded = (first[1] + last[1] + risen[1]) / 20.0
    assert risen[0] == pytest.approx(last[0] - first[0], abs=rounded)
    main("ideal", cycles=3, replicates=1)
    assert len(capsys.readouterr().out.splitlines()) == 3


def _with_half_width(told: str) -> list[float]:
    """A number that is told with its half width, and that."""
    return [float(own.replace("−", "-").replace("\u202f", "")) for own in told.split("±")]


def test_scripts_are_short() -> None:
    for script in SCENARIOS.glob("*.py"):
        code = [line for line in script.read_text().splitlines() if line.strip()]
        assert len(code) <= 25, script.name
