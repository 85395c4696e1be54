"""Joints whose wear maps have different numbers of bins, in every engine."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from runs import run_scene

from presswear.engines.base import Run
from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.linkage.surface import Surface, bin_centres
from presswear.scene.catalog import wear_times
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.settings import changed

ENGINES = [
    ExudynTree(tree_tolerance=1e-11),
    InHouse(integration_tolerance=1e-11),
    ExudynJoints(),
]
COARSE = 64
FINE = 256
PART = 0.05
"""Of a cycle: three touches at either joint."""

each = pytest.mark.parametrize("engine", ENGINES, ids=lambda engine: engine.word)


def wave(bins: int, at: float) -> Surface:
    """A wear with a closed form, 10 um deep, on so many bins."""
    return Surface(5e-6 * (1.0 + np.cos(bin_centres(bins) - at)))


def ran(engine: Engine, bins: dict[str, int], worn: bool) -> Run:
    """The press's joints with so many bins each, round or worn, after some touches."""
    scene = replace(wear_times(), conventions=CONVENTIONS["refined"])
    scene = changed(scene, {f"{name}.angles": f"{own}" for name, own in bins.items()})
    surfaces = {name: (wave(own, 0.5), wave(own, 2.0)) for name, own in bins.items()}
    linkage = scene.linkage(surfaces if worn else None)
    assert {joint.name: joint.bins for joint in linkage.clearances} == bins
    run = run_scene(scene, engine, PART * scene.mechanism.period, linkage)
    assert run.recorder.records.counters["contacts"].min() > 1
    return run


@each
def test_each_joint_counts_its_wear_in_its_own_bins(engine: Engine) -> None:
    """On round surfaces the motion knows no bins: a coarse map is the mean of the fine one."""

    def maps(bins: dict[str, int]) -> tuple[bytes, NDArray[np.float64]]:
        run = ran(engine, bins, worn=False)
        return run.recorder.rows.tobytes(), run.recorder.maps.sampled

    motion, mixed = maps({"A": FINE, "C": COARSE})
    for bins, joint in ((FINE, 0), (COARSE, 1)):
        same, alike = maps({"A": bins, "C": bins})
        assert motion == same
        np.testing.assert_array_equal(mixed[joint, :, :bins], alike[joint])
        assert alike[joint].max() > 0.0
        if bins == FINE:
            means = alike.reshape(2, 2, COARSE, -1).mean(axis=3)
    # Behind a joint's own bins there is nothing.
    assert not mixed[1, :, COARSE:].any()
    np.testing.assert_allclose(
        mixed[1, :, :COARSE], means[1], rtol=1e-9, atol=1e-9 * means.max()
    )


@each
def test_worn_joints_with_different_bins_converge_to_alike_ones(engine: Engine) -> None:
    """The surfaces are the same in the limit; few bins at either joint are told from many."""
    alike = ran(engine, {"A": FINE, "C": FINE}, worn=True)
    for joint in "AC":
        few, some = (
            np.abs(ran(engine, bins, worn=True).end.position - alike.end.position).max()
            for bins in (
                {"A": FINE, "C": FINE, joint: n} for n in (COARSE // 4, COARSE)
            )
        )
        assert some < 5e-8 < 2e-7 < few
