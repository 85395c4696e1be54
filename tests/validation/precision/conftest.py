"""One short study, which all tests of precision look at."""

import pytest

from precision.short_study import SHORT
from presswear.scene.catalog import scene_named
from presswear.validation.precision import chaos, wear
from presswear.validation.precision.chaos import ChaosExtent
from presswear.validation.precision.diagram import Diagram
from presswear.validation.precision.study import Precision, study
from presswear.validation.precision.wear import Means


@pytest.fixture(scope="session")
def told() -> list[tuple[str, float]]:
    return []


@pytest.fixture(scope="session")
def found(told: list[tuple[str, float]]) -> Precision:
    few = {"dae, DOPRI5": (1e-5,), "dae, RK4": (1e-4,)}
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(chaos, "QUICK", ChaosExtent(1, replicates=1, cycles=5, reference=1, few=few))
        patch.setattr(wear, "QUICK", {"paper": Means((90,), (), 4)})
        return study(scene_named("wear-times"), SHORT, lambda name, part: told.append((name, part)))


@pytest.fixture(scope="session")
def ideal(found: Precision) -> Diagram:
    return found.diagrams[0]


@pytest.fixture(scope="session")
def squeezer(found: Precision) -> Diagram:
    return found.diagrams[1]


@pytest.fixture(scope="session")
def impact(found: Precision) -> Diagram:
    return found.diagrams[2]


@pytest.fixture(scope="session")
def press(found: Precision) -> Diagram:
    return found.diagrams[3]
