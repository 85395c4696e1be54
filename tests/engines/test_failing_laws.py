"""A user law that fails in a run ends it with one line and the place, in every engine."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import presswear as pw

LAWS = """
TABLE = (0.0, 1.0)

def look_up(x):
    return TABLE[2 + int(abs(x))]

def press(penetration, rate, stiffness):
    force = stiffness * penetration**1.5
    return force if rate == 0.0 else force * look_up(rate)

def rub(sliding, normal, coefficient):
    return -coefficient * normal * look_up(sliding)

def pull(speed):
    return -look_up(speed)

def late(sliding, normal, coefficient):
    part = TABLE[1 if normal <= 100.0 else 2]
    return -coefficient * normal * part * max(min(sliding / 1e-3, 1.0), -1.0)
"""


@pytest.fixture
def laws(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("laws.py").write_text(LAWS)
    return tmp_path


def scene_with(law: str) -> pw.Scene:
    """Return a slider-crank with a law of the file in the joint, as its load, or its motor."""
    crank = pw.SliderCrank()
    path = f"laws.py:{law}"
    if law == "pull":
        mechanism = crank.linkage()
        load = pw.Force("slider.centre", 0.0, path)
        return pw.Scene(mechanism.changed(loads=[load]), joints="B")
    if law == "turn":
        motor = pw.Motor(law="laws.py:pull")
        return pw.Scene(replace(crank, motor=motor), joints="B")
    kind = "normal_law" if law == "press" else "friction_law"
    base = pw.changed(pw.Scene(crank, joints="B"), {"contact": "radial"})
    return pw.changed(base, {kind: path})


@pytest.mark.parametrize(
    ("law", "engine"),
    [
        ("press", "dae"),
        ("press", "exudyn-tree"),
        ("press", "exudyn-joints"),
        ("rub", "dae"),
        ("pull", "dae"),
        ("turn", "dae"),
    ],
)
def test_a_law_that_fails_ends_the_run_with_its_place(law, engine, laws, capfd):
    linkage = scene_with(law).linkage()
    where = r'user law fails: laws\.py, line 5, look_up: "return TABLE\[2 \+ int'
    with pytest.raises(pw.InputError, match=rf"^{where}.*: tuple index out of range$"):
        pw.simulate(linkage, duration=0.02, engine=engine)
    assert capfd.readouterr() == ("", "")  # numba and Exudyn print nothing themselves


@pytest.mark.parametrize(
    "options", [["--jobs", "2", "--set", "replicates=2"], ["--engine", "dae"]]
)
def test_the_command_ends_with_one_line(options, laws):
    """The law fails in a worker process, and with the option ``--engine`` in plain Python."""
    scene = ["four-bar.toml", "--set", "friction_law=laws.py:late", "--cycles", "1"]
    environment = dict(os.environ)
    if "--engine" in options:
        environment["NUMBA_DISABLE_JIT"] = "1"
    presswear = [sys.executable, "-m", "presswear"]
    subprocess.run([*presswear, "new", "four-bar"], check=True, capture_output=True)
    program = subprocess.run(
        [*presswear, "run", *scene, "--wear-updates", "0", *options],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert program.returncode == 2
    (message,) = program.stderr.splitlines()
    place = "user law fails: laws.py, line 18, late: "
    assert message.startswith(f"presswear: four-bar.toml: {place}")
    assert not Path("results").exists()
