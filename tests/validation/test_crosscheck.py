"""The two engines against each other, and what the comparison itself is worth."""

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from presswear.__main__ import main
from presswear.campaign.replicates import disturbed, start_of
from presswear.engines.settings import ExudynTree
from presswear.linkage.linkage import Linkage
from presswear.physics.constraints import constraints_of
from presswear.scene.catalog import ideal, wear_times
from presswear.validation.crosscheck import (
    DISTURBANCE,
    Touchdown,
    Trajectory,
    divergence_time,
    touchdown_differences,
)


@pytest.mark.parametrize("joints", ["A", "C", "AC"])
def test_the_disturbed_start_keeps_every_constraint(joints: str) -> None:
    scene = replace(wear_times(), joints=joints)
    linkage, start = scene.linkage(), start_of(scene)
    moved = disturbed(linkage, start, DISTURBANCE)
    assert moved is not None
    assert np.abs(moved.position - start.position).max() == pytest.approx(1e-9, rel=1e-6)
    slider = 3 * linkage.index("slider 6") + 1
    assert abs(moved.position[slider] - start.position[slider]) > 1e-11
    phi, phi_t, _, _ = constraints_of(linkage).evaluate(0.0, moved.position, moved.velocity)
    # The ideal start itself holds to round-off.
    assert np.abs(phi).max() < 1e-15
    assert np.abs(phi_t).max() < 1e-14


def test_a_linkage_without_clearance_cannot_be_disturbed() -> None:
    scene = ideal()
    assert disturbed(scene.linkage(), start_of(scene), DISTURBANCE) is None


def _trajectory(offset: Callable[[np.ndarray], np.ndarray]) -> Trajectory:
    time = np.linspace(0.0, 1.0, 5001)
    slider = np.column_stack([np.sin(time), np.cos(time)])
    return Trajectory(time, slider, (np.cos(time) + offset(time))[:, None], ())


def test_the_horizon_is_where_the_distance_is_reached() -> None:
    still = _trajectory(np.zeros_like)
    growing = _trajectory(lambda time: 1e-9 * np.exp(time * math.log(1e6)))
    assert divergence_time(still, growing, 1e-6) == pytest.approx(0.5, abs=1e-3)
    assert divergence_time(still, growing, 1.0) is None


def test_touches_are_matched_joint_by_joint() -> None:
    ours = (
        Touchdown(0, 1.0, 0.2, 50.0),
        Touchdown(1, 1.1, 0.4, 80.0),
        Touchdown(0, 2.0, 0.2, 50.0),
    )
    # The order of touches in different joints may change; their numbers may not.
    theirs = (Touchdown(1, 0.9, 0.5, 80.0), Touchdown(0, 1.3, 0.2, 60.0))
    differences = touchdown_differences(ours, theirs)
    np.testing.assert_allclose(differences[:2], [[0.3, 0.0, 0.2], [0.2, 0.25, 0.0]], atol=1e-12)
    assert np.all(np.isinf(differences[2]))


# Three touches, and steps of RK4 no finer than they need.
SHORT = ["crosscheck", "wear-times", "--set", "speed=8pi rad/s", "--duration", "0.0095"]


@pytest.mark.parametrize(
    ("engine", "expected"),
    [
        (
            "exudyn-joints",
            {
                "Exudyn, steps / 16: slider": 1e-6,
                "Exudyn, steps / 16: first 3 touches, times": 1e-6,
            },
        ),
        (
            "exudyn",
            {
                "Exudyn's tree at 1e-11: slider to touch 3": 1e-8,
                "Exudyn's tree at 1e-11: first 3 touches, times": 1e-8,
            },
        ),
    ],
)
def test_the_engines_agree_on_the_first_touches(
    engine: str, expected: dict[str, float], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "check"
    assert main([*SHORT, "--set", f"engine={engine}", "--out", str(folder)]) == 0
    shown = capsys.readouterr().out
    assert "MISS" not in shown
    assert max(map(len, shown.splitlines())) <= 100
    document = json.loads((folder / "crosscheck.json").read_text())
    assert document["passed"] is True
    assert document["diverged"] is False
    assert [touch["joint"] for touch in document["touchdowns"]] == ["A", "C", "A"]
    bounds = {check["quantity"]: check["bound"] for check in document["checks"]}
    assert {name: bounds[name] for name in expected} == expected
    assert bounds["first 3 touches, dop853 to dopri5 in fewest coordinates"] == 1e-10
    assert (folder / "difference.png").stat().st_size > 10_000
    assert main([*SHORT, "--out", str(folder)]) == 2


def test_a_small_change_of_one_engine_is_noticed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    simulate = ExudynTree.simulate

    def heavier(engine: ExudynTree, linkage: Linkage, *rest: Any) -> Any:
        return simulate(engine, replace(linkage, gravity=1.001 * linkage.gravity), *rest)

    monkeypatch.setattr(ExudynTree, "simulate", heavier)
    assert main([*SHORT, "--out", str(tmp_path / "check")]) == 1
    document = json.loads((tmp_path / "check" / "crosscheck.json").read_text())
    missed = [check["quantity"] for check in document["checks"] if not check["passed"]]
    assert any("touches, times" in quantity for quantity in missed)
    assert capsys.readouterr().out.count("MISS") == len(missed)


def test_without_clearance_the_whole_duration_is_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "ideal"
    assert main(["crosscheck", "ideal", "--duration", "0.05", "--out", str(folder)]) == 0
    document = json.loads((folder / "crosscheck.json").read_text())
    assert document["horizon_s"] == 0.05
    assert document["touchdowns"] == []
    assert "do not diverge" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("speed", ["3.5pi rad/s", "8pi rad/s"])
def test_the_engines_agree_up_to_the_horizon_and_beyond(speed: str, tmp_path: Path) -> None:
    folder = tmp_path / "check"
    assert main(["crosscheck", "--set", f"speed={speed}", "--out", str(folder)]) == 0
    document = json.loads((folder / "crosscheck.json").read_text())
    assert document["diverged"] is True
    assert len(document["touchdowns"]) > 10
