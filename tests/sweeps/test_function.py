"""A scene as a function, handed to Exudyn's own studies as it is."""

import pickle

import numpy as np
import pytest
from exudyn.processing import ComputeSensitivities, GeneticOptimization, ParameterVariation

import presswear as pw
from presswear.scene.settings import changed

SCENE = pw.scenes.wear_times(
    engine="dae",
    integrator="dopri5",
    integration_tolerance=1e-6,
    wear_updates=0,
    cycles=1,
    replicates=1,
)


def alone_at(settings: dict[str, float]) -> float:
    """Mean peak force at A of a run by itself."""
    told = pw.run(changed(SCENE, settings), jobs=1).stages[0].joints["A"].statistics
    return told.peak_force_per_cycle.mean


def test_one_measure_gives_a_number_and_several_a_list() -> None:
    one = pw.function_of(SCENE, "A.force_max")
    some = pw.function_of(SCENE, ["A.force_max", "C.force_max"])
    point = {"clearance": "0.5 mm", "A.friction": 0.03}
    expected = alone_at({"clearance": 5e-4, "A.friction": 0.03})
    assert one(point) == expected
    found = some(point)
    assert isinstance(found, list)
    assert found[0] == expected
    assert pickle.loads(pickle.dumps(one))(point) == expected


@pytest.mark.parametrize("several", [False, True])
def test_parameter_variation_takes_it(several: bool) -> None:
    function = pw.function_of(SCENE, "A.force_max")
    varied, values = ParameterVariation(
        function,
        {"clearance": (4e-4, 6e-4, 2), "friction": [0.02, 0.05]},
        useMultiProcessing=several,
        numberOfThreads=2,
        showProgress=False,
        addComputationIndex=True,
        parameterFunctionData={"seed": 1},
    )
    points = zip(varied["clearance"], varied["friction"], strict=True)
    expected = [
        alone_at({"clearance": float(c), "friction": float(f), "seed": 1}) for c, f in points
    ]
    assert values == expected


def test_genetic_optimization_takes_it() -> None:
    function = pw.function_of(SCENE, "A.force_max", otherwise=1e9)
    best, value, parameters, values = GeneticOptimization(
        function,
        {"clearance": (3e-4, 8e-4)},
        populationSize=4,
        numberOfGenerations=2,
        elitistRatio=0.25,
        randomizerInitialization=1,
        addComputationIndex=True,
        showProgress=False,
    )
    assert value == min(values)
    assert alone_at({"clearance": float(best["clearance"])}) == value
    assert len(parameters["clearance"]) == len(values)


def test_compute_sensitivities_takes_it() -> None:
    function = pw.function_of(SCENE, ["bdc_error", "drive_work"])
    _, reference, _, slopes = ComputeSensitivities(
        function,
        {"clearance": (5e-4, 1e-2, 1)},
        scaledByReference=False,
        useMultiProcessing=False,
        showProgress=False,
    )
    low, high = (function({"clearance": 5e-4 * (1.0 + off)}) for off in (-1e-2, 1e-2))
    assert isinstance(low, list)
    assert isinstance(high, list)
    assert list(reference) == function({"clearance": 5e-4})
    expected = (np.array(high) - np.array(low)) / (2e-2 * 5e-4)
    assert np.asarray(slopes)[0] == pytest.approx(expected, rel=1e-6, abs=0)


def test_a_run_that_fails_raises_or_gives_what_was_asked_for() -> None:
    settings = {"integrator": "rk4-paper"}
    with pytest.raises(pw.RunFailed, match="no longer finite"):
        pw.function_of(SCENE, "A.force_max")(settings)
    assert pw.function_of(SCENE, "A.force_max", otherwise=1e9)(settings) == 1e9
    with pytest.raises(pw.InputError, match="did you mean clearance"):
        pw.function_of(SCENE, "A.force_max")({"clearence": 1e-3})
