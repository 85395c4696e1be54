"""Choice of the module of Exudyn; both modules give the same motion."""

import json
from pathlib import Path

import pytest
from python_process import python

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


def run_with(module: str) -> tuple[bool, list[list[float]]]:
    """Return whether the fast module is used, and positions and contacts of both engines."""
    text = python("-c", RUN, env={"EXUDYN_MODULE": module}, check=True).stdout
    is_fast, ends = json.loads(text)  # Exudyn prints nothing
    return is_fast, ends


@pytest.mark.slow
def test_both_modules_give_the_same_motion_during_the_first_contacts():
    is_fast_by_default, default_ends = run_with("")
    is_fast, safe_ends = run_with("Safe ")
    assert not is_fast
    processor = Path("/proc/cpuinfo")
    has_avx2 = processor.exists() and "avx2" in processor.read_text()
    assert is_fast_by_default == has_avx2
    for default, safe in zip(default_ends, safe_ends, strict=True):
        contacts = default[-1]
        assert contacts > 0.0
        assert contacts == safe[-1]
        assert default == pytest.approx(safe, abs=1e-11)
