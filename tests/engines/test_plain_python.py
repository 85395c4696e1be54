"""Runs in plain Python, with NUMBA_DISABLE_JIT=1, for a debugger."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marks import slow

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.linkage.mechanisms import FourBar
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array

DURATION = 2.1e-3  # s, up to the end of a contact


def end_of_run(engine: str) -> Array:
    """Return steps, positions, velocities and contacts at the end of a short run."""
    scene = Scene(
        FourBar(speed=30.0), bearings={"B": Bearing(clearance=1e-4, friction=0.1)}
    )
    solver: Any = getattr(scene.numerics, engine).for_cycle(scene.mechanism.period)
    run = solver.simulate(scene.linkage(), start_of(scene), Plan(DURATION, 1))
    numbers = (
        run.end.position,
        run.end.velocity,
        run.recorder.stored_contacts(0).ravel(),
    )
    return np.concatenate([[run.diagnostics["steps"]], *numbers])


@pytest.mark.parametrize("engine", ["tree", "dae", slow("joints")])
def test_a_run_in_plain_python_ends_as_a_compiled_one(engine, tmp_path):
    script = "import sys, numpy, test_plain_python as plain\n"
    script += "numpy.save(sys.argv[1], plain.end_of_run(sys.argv[2]))"
    path = os.pathsep.join(
        map(str, (Path(__file__).parent, *Path(__file__).parents[1:3]))
    )
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path}
    stored = tmp_path / "end.npy"
    command = [sys.executable, "-c", script, f"{stored}", engine]
    subprocess.run(command, check=True, env=environment, timeout=300)
    plain = np.load(stored)
    compiled = end_of_run(engine)
    assert plain[0] == compiled[0] > 10
    # Round-off of the instant of separation changes its speed by parts in 1e7.
    np.testing.assert_allclose(plain[1:], compiled[1:], rtol=1e-6, atol=1e-12)
