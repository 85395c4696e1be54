"""The two engines against each other, and what the comparison itself is worth."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from marks import slow

import presswear as pw
from presswear.campaign.replicates import disturbed, start_of
from presswear.physics.constraints import constraints_of
from presswear.validation import crosscheck
from presswear.validation.cases import Check
from presswear.validation.crosscheck import MEAN_BOUND, mean_check


@pytest.mark.parametrize("joints", ["A", "C", "AC"])
def test_the_disturbed_start_keeps_every_constraint(joints):
    scene = replace(pw.scenes.wear_times(), joints=joints)
    linkage = scene.linkage()
    start = start_of(scene)
    moved = disturbed(linkage, start, crosscheck.DISTURBANCE)
    assert np.abs(moved.position - start.position).max() == pytest.approx(
        1e-9, rel=1e-6
    )
    slider = 3 * linkage.index("slider 6") + 1
    assert abs(moved.position[slider] - start.position[slider]) > 1e-11
    phi, phi_t, _, _ = constraints_of(linkage).evaluate(
        0.0, moved.position, moved.velocity
    )
    # The ideal start itself holds to round-off.
    assert np.abs(phi).max() < 1e-15
    assert np.abs(phi_t).max() < 1e-14


def test_a_linkage_without_clearance_cannot_be_disturbed():
    scene = pw.scenes.ideal()
    assert disturbed(scene.linkage(), start_of(scene), crosscheck.DISTURBANCE) is None


def _trajectory(offset: Callable[[np.ndarray], np.ndarray]) -> crosscheck.Trajectory:
    time = np.linspace(0.0, 1.0, 5001)
    output = np.column_stack([np.sin(time), np.cos(time)])
    return crosscheck.Trajectory(
        time, output, (np.cos(time) + offset(time))[:, None], np.empty((0, 4))
    )


def test_the_horizon_is_where_the_distance_is_reached():
    still = _trajectory(np.zeros_like)
    growing = _trajectory(lambda time: 1e-9 * np.exp(time * math.log(1e6)))
    assert crosscheck.divergence_time(still, growing, 1e-6) == pytest.approx(
        0.5, abs=1e-3
    )
    assert crosscheck.divergence_time(still, growing, 1.0) is None


def test_touches_are_matched_joint_by_joint():
    ours = np.array([[0, 1.0, 0.2, 50.0], [1, 1.1, 0.4, 80.0], [0, 2.0, 0.2, 50.0]])
    # The order of touches in different joints may change; their numbers may not.
    theirs = np.array([[1, 0.9, 0.5, 80.0], [0, 1.3, 0.2, 60.0]])
    differences = crosscheck.touchdown_differences(ours, theirs)
    np.testing.assert_allclose(
        differences[:2], [[0.3, 0.0, 0.2], [0.2, 0.25, 0.0]], atol=1e-12
    )
    assert np.all(np.isinf(differences[2]))


# Three touches, and steps of RK4 no finer than they need.
SHORT = "crosscheck wear-times --set 'speed=8pi rad/s' --duration 0.0095"


def document_of(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "crosscheck.json").read_text())


@pytest.mark.parametrize(
    ("engine", "name", "distance", "bound"),
    [
        slow(*("exudyn-joints", "Exudyn, steps / 16", "output", 1e-6)),
        ("exudyn", "Exudyn's tree at 1e-11", "output to touch 3", 1e-8),
    ],
)
def test_the_engines_agree_on_the_first_touches(
    engine,
    name,
    distance,
    bound,
    tmp_path,
    command,
):
    folder = tmp_path / "check"
    shown = command(f"{SHORT} --set engine={engine} --out {folder}")
    assert "MISS" not in shown
    assert max(map(len, shown.splitlines())) <= 100
    document = document_of(folder)
    assert document["passed"] is True
    assert document["diverged"] is False
    assert [touch["joint"] for touch in document["touchdowns"]] == ["A", "C", "A"]
    bounds = {check["quantity"]: check["bound"] for check in document["checks"]}
    assert (
        bounds[f"{name}: {distance}"]
        == bounds[f"{name}: first 3 touches, times"]
        == bound
    )
    # The output of another linkage may be no slider.
    assert "slider" not in shown
    assert bounds["first 3 touches, dop853 to dopri5 in fewest coordinates"] == 1e-10
    assert (folder / "difference.png").stat().st_size > 10_000
    command(f"{SHORT} --out {folder}", 2)


def test_a_small_change_of_one_engine_is_noticed(tmp_path, monkeypatch, command):
    simulate = pw.engines.ExudynTree.simulate

    def heavier(
        engine: pw.engines.ExudynTree, linkage: pw.linkage.Linkage, *rest: Any
    ) -> Any:
        return simulate(
            engine, replace(linkage, gravity=1.001 * linkage.gravity), *rest
        )

    monkeypatch.setattr(pw.engines.ExudynTree, "simulate", heavier)
    shown = command(f"{SHORT} --out {tmp_path / 'check'}", 1)
    checks = document_of(tmp_path / "check")["checks"]
    missed = [check["quantity"] for check in checks if not check["passed"]]
    assert any("touches, times" in quantity for quantity in missed)
    assert shown.count("MISS") == len(missed)


def test_without_clearance_all_is_compared(tmp_path, command):
    shown = command(f"crosscheck ideal --duration 0.02 --out {tmp_path / 'ideal'}")
    document = document_of(tmp_path / "ideal")
    assert (document["horizon_s"], document["touchdowns"]) == (0.02, [])
    assert "do not diverge" in shown


@pytest.mark.parametrize(
    ("theirs", "verdict"),
    [
        (pw.statistics.Estimate(103.0, 101.0, 105.0), True),
        (pw.statistics.Estimate(125.0, 123.0, 127.0), False),
        # an interval that holds any mean of interest
        (pw.statistics.Estimate(115.0, 65.0, 165.0), None),
        (pw.statistics.Estimate(108.0, 104.0, 112.0), None),
        (pw.statistics.Estimate(100.0), None),
    ],
)
def test_means_get_a_verdict_only_if_their_intervals_are_narrow(theirs, verdict):
    check = mean_check("peak force", pw.statistics.Estimate(100.0, 98.0, 102.0), theirs)
    if isinstance(check, str):
        assert verdict is None
        assert "no verdict" in check
    else:
        assert check.passed is verdict
        assert check.bound == MEAN_BOUND


def test_one_of_many_means_misses_only_beyond_the_interval_of_all():
    # 15.4 +- 3.0 % alone, +- 5.4 % among 300 comparisons
    one = pw.statistics.Estimate(100.0, 97.8, 102.2)
    two = pw.statistics.Estimate(116.7, 114.3, 119.1)
    alone = mean_check("peak force", one, two)
    assert isinstance(alone, Check)
    assert not alone.passed
    assert isinstance(mean_check("peak force", one, two, 300), str)


@pytest.mark.slow
@pytest.mark.parametrize("speed", ["3.5pi rad/s", "8pi rad/s"])
def test_the_engines_agree_up_to_the_horizon_and_beyond(speed, tmp_path, command):
    command(f"crosscheck --set 'speed={speed}' --out {tmp_path / 'check'}")
    document = document_of(tmp_path / "check")
    assert document["diverged"] is True
    assert len(document["touchdowns"]) > 10


@pytest.mark.slow
def test_the_engines_agree_on_a_slide_that_tilts(tmp_path, command):
    command(f"crosscheck press-off-centre --out {tmp_path / 'check'}")
    document = document_of(tmp_path / "check")
    assert len(document["touchdowns"]) > 9
