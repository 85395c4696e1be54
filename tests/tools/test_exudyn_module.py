"""Choice of the module of Exudyn; both modules give the same motion."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

RUN = """
import json, sys
import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
scene, ends = pw.scenes.wear_times(), []
for engine in (pw.engines.ExudynTree(1e-11), pw.engines.ExudynJoints()):
    engine = engine.for_cycle(scene.mechanism.period)
    run = engine.simulate(scene.linkage(), start_of(scene), Plan(0.012, 1, 1))
    contacts = float(run.recorder.records.counters["contacts"].sum())
    ends.append([*map(float, run.end.position), contacts])
print(json.dumps(["exudyn.exudynCPPfast" in sys.modules, ends]))
"""


def ran(module: str) -> tuple[bool, list[list[float]]]:
    environment = {**os.environ, "EXUDYN_MODULE": module}
    text = subprocess.run(
        [sys.executable, "-c", RUN],
        env=environment,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    is_fast, ends = json.loads(text)  # nothing else is printed
    return is_fast, ends


def test_both_modules_give_the_same_motion_through_the_first_touches() -> None:
    fast = ran("")
    safe = ran("Safe ")
    assert not safe[0]
    processor = Path("/proc/cpuinfo")
    assert fast[0] == (processor.exists() and "avx2" in processor.read_text())
    for one, other in zip(fast[1], safe[1], strict=True):
        assert one[-1] == other[-1] > 0.0
        assert one == pytest.approx(other, abs=1e-11)
