"""Source code of user laws that a result stores is executed only on request."""

import json

import pytest
from python_process import python
from refusals import refused

import presswear as pw
from presswear.results.folder import ResultFolder
from presswear.scene.files import example_file, scene_from
from presswear.sweeps import sweep as sweeps
from presswear.sweeps.plan import Plan
from presswear.sweeps.responses import request
from presswear.tools.user_function import UntrustedLaw, UserFunction

PROBE = """
open({marker!r}, "w").close()

def soft(penetration):
    return 1e7 * penetration

def gust(time):
    return 0.1 * time
"""
LOAD = """
[[mechanism.loads]]
body = "crank"
law = "laws.py:gust"

[settings]
normal_law = "laws.py:soft"
drive_torque = "on"
cycles = 2
replicates = 1"""


@pytest.fixture(scope="module")
def received(tmp_path_factory):
    """A folder with results whose laws write the file ``executed`` when they are executed."""
    folder = tmp_path_factory.mktemp("received")
    marker = folder / "executed"
    (folder / "laws.py").write_text(PROBE.format(marker=str(marker)))
    text = example_file("points").replace("wear_updates = 1", "wear_updates = 0")
    (folder / "mine.toml").write_text(text.replace("[settings]", LOAD))
    scene = scene_from(folder / "mine.toml")
    pw.run(scene, folder / "out")
    assert marker.exists()
    with ResultFolder(folder / "halted", scene) as halted:
        halted.interrupt()
    plan = Plan(scene, ("friction=0.01,0.02",))
    sweep = sweeps.Sweep(plan, request(scene, ["B.force_max"]), folder / "sweep")
    (folder / "sweep").mkdir()
    sweep.write(sweep.path / sweeps.FILE)
    for name in ("executed", "laws.py", "mine.toml"):
        (folder / name).unlink()
    return folder


READING = """
from pathlib import Path
from presswear.__main__ import main
import presswear as pw
from presswear.sweeps.sweep import load_sweep

for line in (
    "report out",
    "export out table.csv",
    "replay out --still still.png --size 160x160",
    "dynamics out",
):
    assert main(line.split()) == 0, line
result = pw.load("out")
print(result, result.to_pandas(), load_sweep(Path("sweep")).plan.example)
for compute in (
    lambda: result.drives(0),
    lambda: pw.statics.total_clearance(result.scene.linkage()),
    lambda: pw.run(result.scene, check=False),
    lambda: pw.run(result.scene, "halted"),
):
    try:
        compute()
    except pw.InputError as error:
        print("refused:", error)
for line in ("sweep mine --resume --out sweep", "run mine --resume --out halted"):
    assert main(line.split()) == 2, line
assert not Path("executed").exists()
assert main([*line.split(), "--trust"]) == 0
assert Path("executed").exists()
"""


@pytest.fixture(scope="module")
def done(received):
    """Read the results in a process that trusts nothing yet, and trust them at last."""
    done = python("-c", READING, cwd=received)
    assert done.returncode == 0, done.stderr
    return done


def test_reading_a_result_does_not_execute_its_laws(received, done):
    """Report, export, replay and Python; what needs a law is refused or left out in a sentence."""
    assert done.stdout.count("refused:") == 4
    assert done.stdout.count("pw.load(folder, trust=True)") == 4
    page = (received / "out" / "report.html").read_text()
    assert "Python source code is stored for B.normal_law, loads[0].law." in page
    assert "total clearance" not in page


def test_a_run_goes_on_only_if_its_laws_are_trusted(received, done):
    refused = [line for line in done.stderr.splitlines() if "--trust" in line]
    assert len(refused) == 2
    assert all("B.normal_law = user law soft" in line for line in refused)
    ended = json.loads((received / "halted" / "result.json").read_text())
    assert ended["status"] == "completed"
    assert "total clearance" in (received / "halted" / "report.html").read_text()


def test_a_stored_law_is_trusted_where_the_same_text_is_given(tmp_path):
    """A function, or a file, of the same text; another text, and a file named in a result, not."""
    text = f"# {tmp_path}\ndef soft(penetration):\n    return 1e7 * penetration\n"
    stored = UserFunction.read("law", {"name": "soft", "source": text})
    assert not stored.is_trusted
    with pytest.raises(UntrustedLaw, match="--trust"):
        stored.evaluate("law", ("penetration",), {"penetration": 1.0})
    (tmp_path / "laws.py").write_text(text)
    UserFunction.read("law", f"{tmp_path}/laws.py:soft")
    assert stored.is_trusted
    assert not UserFunction("soft", text + "\n").is_trusted
    data = pw.Scene().as_dict()
    data["bearings"] |= {"normal_law": f"{tmp_path}/laws.py:soft"}
    with refused("a stored law is source code"):
        pw.Scene.from_dict(data)
