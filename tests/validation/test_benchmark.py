"""Benchmark: errors and orders of every method, the cost of features, and the command."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.engines.base import Plan
from presswear.validation import benchmark, benchmark_problems
from presswear.validation.benchmark import Point, first_run
from presswear.validation.benchmark_problems import Extent
from presswear.validation.cases import first_contact, order_of
from presswear.validation.reference_problems import Impact

SHORT = Extent(
    repeats=1,
    longest=0.025,  # s, after the paper's step has diverged at 0.0217 s
    joints_steps=(150, 300, 600),
    rk4_steps=(150, 300, 600),
    impact_steps=(25, 50, 100),
    equal_steps=(1e-5,),
    rk4_impact_steps=(2e-5, 1e-5),
    tolerances=(1e-6, 1e-9),
    tree_tolerances=(1e-5, 1e-7),
)
SCENE = pw.scenes.wear_times()
TRAPEZOIDAL = "exudyn-joints, trapezoidal rule"
RK4 = "dae, RK4"


def silent(name: str, part: float) -> None:
    """Ignore progress."""


@pytest.fixture(scope="module")
def points():
    progress: list[float] = []
    points = benchmark.work_precision(
        SCENE, SHORT, lambda name, part: progress.append(part)
    )
    assert progress == sorted(progress)
    assert 0.0 == progress[0] < progress[-1] <= 1.0
    assert all(point.timing or point.failure for point in points)
    return points


def family(points: list[Point], problem: int, name: str = "") -> list[Point]:
    names = list(dict.fromkeys(point.problem.name for point in points))
    chosen = [point for point in points if point.problem.name == names[problem]]
    return [point for point in chosen if name in ("", point.method.family)]


def order(points: list[Point], quantity: str) -> float:
    limit = 10.0 * points[0].problem.quantities[quantity]
    pairs = [
        (1.0 / point.timing.steps, point.errors[quantity])
        for point in points
        if point.timing is not None and point.errors[quantity] > limit
    ]
    return order_of([step for step, _ in pairs], [error for _, error in pairs])


def test_smooth_motion_has_the_order_of_each_integrator(points):
    for quantity in ("output (m)", "output velocity (m/s)", "constraints (m, rad)"):
        assert order(family(points, 0, TRAPEZOIDAL), quantity) == pytest.approx(
            2.0, abs=0.05
        )
        assert order(family(points, 0, RK4), quantity) == pytest.approx(4.0, abs=0.15)
    for quantity in ("angles (rad)", "rates (rad/s)"):
        assert order(family(points, 1, TRAPEZOIDAL), quantity) == pytest.approx(
            2.0, abs=0.1
        )
        assert order(family(points, 1, RK4), quantity) == pytest.approx(4.0, abs=0.5)


def test_the_uncertainty_of_the_references_is_known(points):
    squeezer = family(points, 1)[0].problem.quantities
    assert 1e-10 < squeezer["angles (rad)"] < 5e-9
    assert 1e-8 < squeezer["rates (rad/s)"] < 2e-6
    press = family(points, 3)[0].problem.quantities
    assert press["output (m)"] < 1e-12
    assert press["touchdowns (s)"] < 1e-10
    assert press["peak forces, relative"] < 1e-4


def test_contact_time_is_that_of_the_integrated_motion():
    impact = Impact(0.8, stiffness=1e9, speed=0.2)
    engine = pw.engines.InHouse(integration_tolerance=1e-13)
    contact = first_contact(
        engine.simulate(impact.linkage, impact.start, Plan(0.01, 1))
    )
    time, uncertainty = impact.duration()
    assert time == pytest.approx(contact["separation"] - contact["touchdown"], rel=1e-8)
    assert uncertainty < 1e-10 * time


def test_every_engine_solves_an_impact(points):
    impact = family(points, 2)
    assert {point.method.engine.word for point in impact} == {
        "exudyn-joints",
        "exudyn-tree",
        "dae",
    }
    for name in {point.method.family for point in impact}:
        bound = 1e-3 if "equal" in name else 1e-4
        assert family(points, 2, name)[-1].errors["restitution"] < bound
    for quantity in ("restitution", "contact time (s)"):
        assert order(family(points, 2, TRAPEZOIDAL), quantity) == pytest.approx(
            2.0, abs=0.3
        )
    (paper,) = (point for point in impact if point.method.is_paper)
    assert paper.errors["energy residual / kinetic"] > 0.1


def test_the_paper_fails_with_clearance_and_others_converge(points):
    press = family(points, 3)
    failed = {point.method.label for point in press if point.failure}
    assert failed == {"dae, RK4, step 0.0001", "dae, RK4, step 2e-05"}
    assert all("energy balance" in point.failure for point in press if point.failure)
    for name in {point.method.family for point in press}:
        sound = [point for point in family(points, 3, name) if not point.failure]
        if len(sound) > 1:
            for quantity in ("touchdowns (s)", "energy residual / exchanged"):
                assert sound[-1].errors[quantity] < sound[0].errors[quantity]


@pytest.mark.parametrize("words", ["3 of the first 10", "error of restitution"])
def test_a_method_that_fails_is_a_point(words):
    problem = benchmark_problems.single_impact(SCENE, SHORT, silent)

    def errors(run: object) -> list[float]:
        if "error" in words:
            return [np.nan] * 3
        raise pw.RunFailed("3 of the first 10 touchdowns missing")

    point = first_run(replace(problem, errors=errors), problem.methods[-1])
    assert words in point.failure
    assert not point.errors


def test_a_scene_without_clearance_is_refused():
    with refused("no clearance"):
        benchmark.work_precision(replace(SCENE, joints="none"), SHORT, silent)
    with refused("clearance at A and C"):
        benchmark.feature_costs(
            replace(SCENE, joints="A"), benchmark.FeatureExtent(), silent
        )


def rows_of(file: Path) -> list[dict[str, str]]:
    return list(csv.DictReader(file.read_text().splitlines()))


def test_the_command_writes_table_and_figure(points, tmp_path, monkeypatch, command):
    extents: list[Extent] = []
    folder = tmp_path / "out"

    def measured(scene: object, extent: Extent, report: object) -> list[Point]:
        extents.append(extent)
        return points

    monkeypatch.setattr(benchmark, "work_precision", measured)
    shown = command(f"benchmark --quick --repeats 3 --out {folder}")
    assert extents == [replace(benchmark_problems.QUICK, repeats=3)]
    assert "step 0.0001 failed" in shown
    # Only messages may be longer than 80 characters outside of a terminal.
    for line in shown.splitlines():
        assert len(line) <= 80 or str(folder) in line or " failed: " in line
    assert (folder / "benchmark.png").stat().st_size > 10_000
    rows = rows_of(folder / "benchmark.csv")
    assert len(rows) == sum(len(point.problem.quantities) for point in points)
    first = points[0]
    assert float(rows[0]["error"]) == first.errors["output (m)"]
    assert float(rows[0]["cpu_s"]) == min(first.timing.times)
    assert int(rows[0]["steps"]) == first.timing.steps
    assert all(row["error"] == row["cpu_s"] == "" for row in rows if row["failure"])
    assert "not empty" in command(f"benchmark --out {folder}", 2)


FEW = {
    "exudyn-tree": ["friction", "wear", "torques stored"],
    "exudyn-joints": ["torques stored"],
}


def costs_of(engines: dict[str, list[str]]) -> list[dict[str, Any]]:
    """Return short measurements of some features."""
    extent = benchmark.FeatureExtent(
        repeats=2, tree_cycles=0.1, joints_cycles=0.02, wear_cycles=1
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(benchmark, "ENGINES", engines)
        return benchmark.feature_costs(SCENE, extent, silent)


@pytest.fixture(scope="module")
def costs():
    return costs_of(FEW)


def test_features_are_timed_on_and_off(costs):
    check_costs(costs, FEW)


@pytest.mark.slow
def test_every_feature_is_timed_on_and_off():
    check_costs(costs_of(benchmark.ENGINES), benchmark.ENGINES)


def check_costs(costs: list[dict[str, Any]], engines: dict[str, list[str]]) -> None:
    """Check rows, ratios, and which features change the steps."""
    for engine, features in engines.items():
        for feature in features:
            rows = [
                row
                for row in costs
                if row["engine"] == engine and row["feature"] == feature
            ]
            assert [row["state"] for row in rows] == list(benchmark.FEATURES[feature])
            first = rows[0]["cpu_s_per_step"]  # without the feature
            for row in rows:
                steps = row["steps"] + row["rejected_steps"]
                assert row["cpu_s_per_step"] == row["cpu_s"] / steps
                assert row["ratio_per_step"] == row["cpu_s_per_step"] / first
            if engine == "exudyn-tree":
                has_equal_steps = rows[0]["steps"] == rows[1]["steps"]
                # Neither computed wear nor stored torques change the motion.
                assert has_equal_steps == (feature in ("wear", "torques stored"))


def test_the_features_command_writes_its_table(costs, tmp_path, monkeypatch, command):
    monkeypatch.setattr(benchmark, "feature_costs", lambda *arguments: costs)
    folder = tmp_path / "out"
    assert "torques stored: on" in command(
        f"benchmark --features --quick --out {folder}"
    )
    ratios = [float(row["ratio_per_step"]) for row in rows_of(folder / "features.csv")]
    assert ratios == [row["ratio_per_step"] for row in costs]
