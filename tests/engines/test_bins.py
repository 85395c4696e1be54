"""Joints whose wear maps have different numbers of bins, in every engine."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from numpy.typing import NDArray
from runs import run_scene

from presswear.engines.base import Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.surface import Surface, bin_centres
from presswear.scene.catalog import wear_times
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.settings import changed

ENGINES: list[Engine] = [
    ExudynTree(tree_tolerance=1e-11),
    InHouse(integration_tolerance=1e-11),
    ExudynJoints(),
]
COARSE = 64
FINE = 256
CYCLES = 0.05  # simulated part of a cycle, with three contacts at either joint


def wave(bins: int, phase: float) -> Surface:
    """Wear of 10 um at an angle, rad, as one wave of a cosine."""
    return Surface(5e-6 * (1.0 + np.cos(bin_centres(bins) - phase)))


def run_press(engine: Engine, bins: dict[str, int], is_worn: bool) -> Run:
    """Run the press with these numbers of bins in its joints, round or worn."""
    scene = replace(wear_times(), conventions=CONVENTIONS["refined"])
    surfaces = {}
    for joint, count in bins.items():
        scene = changed(scene, {f"{joint}.angles": f"{count}"})
        surfaces[joint] = (wave(count, 0.5), wave(count, 2.0))
    linkage = scene.linkage(surfaces if is_worn else None)
    assert {joint.name: joint.bins for joint in linkage.clearances} == bins
    run = run_scene(scene, engine, CYCLES * scene.mechanism.period, linkage)
    assert run.recorder.records.counters["contacts"].min() > 1
    return run


@pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.word)
def test_each_joint_adds_its_wear_to_its_own_bins(engine: Engine):
    """On round surfaces the motion does not depend on the bins."""

    def run_round(bins_of_a: int, bins_of_c: int) -> tuple[bytes, NDArray[np.float64]]:
        bins = {"A": bins_of_a, "C": bins_of_c}
        recorder = run_press(engine, bins, is_worn=False).recorder
        return recorder.rows.tobytes(), recorder.maps.sampled

    rows, maps = run_round(FINE, COARSE)
    fine_rows, fine_maps = run_round(FINE, FINE)
    coarse_rows, coarse_maps = run_round(COARSE, COARSE)
    assert rows == fine_rows
    assert rows == coarse_rows
    assert_array_equal(maps[0], fine_maps[0])
    assert_array_equal(maps[1, :, :COARSE], coarse_maps[1])
    assert maps[0].max() > 0.0
    assert maps[1].max() > 0.0
    assert not maps[1, :, COARSE:].any()
    # The depth of a coarse bin is the mean over the fine bins in its range of angle.
    means = fine_maps.reshape(2, 2, COARSE, -1).mean(axis=3)
    assert_allclose(maps[1, :, :COARSE], means[1], rtol=1e-9, atol=1e-9 * means.max())
