"""What a person may change in a study."""

from dataclasses import replace
from typing import Any

import pytest

from presswear.studies import make_study, study
from presswear.tools.errors import InputError


@pytest.mark.parametrize(
    ("name", "settings"),
    [
        ("paper", {"clearance": "1 mm"}),
        ("paper", {"speed": "5pi rad/s"}),
        ("paper", {"geometry": "swapped"}),
        ("paper", {"friction": 0.05}),
        ("runaway", {"angles": 90}),
    ],
)
def test_what_names_the_variants_is_not_changed(name: str, settings: dict[str, Any]) -> None:
    (key,) = settings
    with pytest.raises(InputError, match=f"the study {name} varies it itself") as refused:
        study(name, **settings)
    assert str(refused.value).startswith(f"{key} = ")


@pytest.mark.parametrize("name", ["paper", "runaway"])
def test_all_else_can_be_changed(name: str) -> None:
    found = study(name, cycles=3, bearing_share=0.25, seed=7)
    assert all(variant.scene.bearings.materials.bearing_share == 0.25 for variant in found.variants)
    finer = make_study(name, lambda scene: replace(scene, tolerance=0.02))
    assert [variant.key for variant in finer.variants] == [one.key for one in found.variants]
