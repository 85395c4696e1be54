"""Scripts in scenarios/: each runs and prints its numbers."""

import runpy
import warnings
from pathlib import Path

import pytest

import presswear as pw

SCENARIOS = Path(__file__).parents[1] / "scenarios"
QUICK = ("ideal", "own_linkage")
SLOW = ("compare", "engines", "one_joint", "wear_times")


@pytest.mark.parametrize(
    "name", [*QUICK, *(pytest.param(name, marks=pytest.mark.slow) for name in SLOW)]
)
def test_a_script_runs(
    name,
    tmp_path,
    monkeypatch,
    capsys,
):
    monkeypatch.chdir(tmp_path)
    with warnings.catch_warnings():
        warnings.simplefilter("error", ResourceWarning)
        runpy.run_path(str(SCENARIOS / f"{name}.py"), run_name="__main__")
    output = capsys.readouterr().out
    assert any(sign.isdigit() for sign in output)
    assert "failed" not in output


def test_a_servo_has_ideal_motion_and_loads(capsys):
    main = runpy.run_path(str(SCENARIOS / "servo.py"))["main"]
    main(("press_servo_dwell",), cycles=1, replicates=1)
    output = capsys.readouterr().out
    assert output.count("ideal: stroke") == 1
    assert output.count("load distance of a cycle at A") == 1


def test_bottom_dead_centre_at_two_speeds_and_with_work(
    capsys,
):
    """The last row is the scene itself, and the last column the change since the first row."""
    main = runpy.run_path(str(SCENARIOS / "bottom.py"))["main"]
    main("press-blanking", cycles=3, replicates=2)
    rows = [
        line.split(": ")[1].split(" | ")
        for line in capsys.readouterr().out.splitlines()[1:]
    ]
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
    return [
        float(part.replace("−", "-").replace("\u202f", "")) for part in text.split("±")
    ]


@pytest.mark.slow
def test_second_wear_by_assumption(tmp_path, capsys):
    """All assumptions are scenes; one of each kind is run."""
    quick = {
        "engine": "dae",
        "cycles": 1,
        "replicates": 1,
        "cycles_per_update": 1e5,
        "speed": 60.0,
    }
    script = runpy.run_path(str(SCENARIOS / "runaway.py"))
    assumptions = script["ASSUMPTIONS"]
    for scene in script["make_scenes"](quick).values():
        scene.check()
    for key in assumptions.keys() - {"paper", "foundation", "arc-steps", "paper-step"}:
        del assumptions[key]
    script["main"](str(tmp_path / "runaway"), **quick)
    rows = [
        line.split(" | ")
        for line in capsys.readouterr().out.splitlines()
        if " | " in line
    ]
    assert [row[0] for row in rows[1:-5]] == [
        label for label, _ in assumptions.values()
    ]
    assert sum(row[4].startswith("0 of 1") for row in rows[1:-5]) >= 3
    assert len(rows[-4:]) == len({row[0] for row in rows[-4:]}) == 4
    assert (tmp_path / "runaway" / "two-wears.png").exists()
