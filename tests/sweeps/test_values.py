"""Values that are varied, as they are typed."""

import numpy as np
import pytest

import presswear as pw
from presswear.sweeps.values import group_of, texts_of

SCENE = pw.scenes.wear_times()


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("clearance=0.2mm:1.0mm:5", [[2e-4], [4e-4], [6e-4], [8e-4], [1e-3]]),
        ("wear_coefficient=1e-16/Pa:1e-14/Pa:3:log", [[1e-16], [1e-15], [1e-14]]),
        ("A.friction=0.02,0.05,0.1", [[0.02], [0.05], [0.1]]),
        ("engine=dae,exudyn", [[0.0], [1.0]]),
        ("replicates=2:4:3", [[2.0], [3.0], [4.0]]),
        ("A.friction=0.1,0.2 & C.friction=0.1,0.3", [[0.1, 0.1], [0.2, 0.3]]),
    ],
)
def test_texts_give_values(text: str, values: list[list[float]]) -> None:
    assert group_of(SCENE, text).values.tolist() == values


def test_values_are_typed_as_settings_need_them() -> None:
    whole, word = group_of(SCENE, "replicates=2,3"), group_of(SCENE, "engine=dae,exudyn")
    assert [repr(whole.factors[0].typed(own)) for own in (2.0, 3.0)] == ["2", "3"]
    assert [word.factors[0].typed(own) for own in (0.0, 1.0)] == ["dae", "exudyn"]
    column = group_of(SCENE, "A.friction=0.02").factors[0].column
    assert (column.key, column.unit, column.words) == ("A.friction", "", ())
    assert group_of(SCENE, "clearance=1mm").factors[0].column.unit == "m"


def test_a_finer_range_meets_the_coarser_one_and_what_is_typed() -> None:
    coarse, fine = (
        set(group_of(SCENE, f"clearance=0.1mm:0.9mm:{count}").values[:, 0]) for count in (9, 17)
    )
    assert coarse < fine
    assert {0.1e-3 * k for k in (1, 2, 4, 8)} <= coarse


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("clearence=1mm", "unknown key 'clearence'; did you mean clearance"),
        ("A.frction=1", r"unknown key 'A\.frction'; did you mean A\.friction"),
        ("clearance=", "KEY=VALUES is expected"),
        ("clearance", "KEY=VALUES is expected"),
        ("clearance=0.4,0.5", "clearance = '0.4' has no unit"),
        ("clearance=1mm:2mm", "FIRST:LAST:COUNT"),
        ("engine=dae,exudyntree", "did you mean exudyn-tree"),
        ("friction=0.1,0.1", "a value is there twice"),
        ("A.friction=0.1,0.2 & C.friction=0.1", "as many values of each are expected, not 2 and 1"),
    ],
)
def test_what_cannot_be_read_is_refused(text: str, told: str) -> None:
    with pytest.raises(pw.InputError, match=told):
        group_of(SCENE, text)


def test_lists_of_a_script_are_those_that_would_be_typed() -> None:
    varied = {
        "clearance": np.array([1e-4, 2.5e-4]),
        "A.friction & C.friction": [(0.1, 0.2), (0.3, 0.4)],
        "engine": ["dae", "exudyn"],
        "replicates": [2, 3],
        "friction": "0:0.1:3",
    }
    groups = [group_of(SCENE, text) for text in texts_of(SCENE, varied)]
    assert [own.values.tolist() for own in groups] == [
        [[1e-4], [2.5e-4]],
        [[0.1, 0.2], [0.3, 0.4]],
        [[0.0], [1.0]],
        [[2.0], [3.0]],
        [[0.0], [0.05], [0.1]],
    ]


@pytest.mark.parametrize("values", [[], 3, [None], [float("nan")], [True], {"a": 1}])
def test_what_a_script_gives_that_is_no_list_is_refused(values: object) -> None:
    with pytest.raises(pw.InputError, match="friction"):
        texts_of(SCENE, {"friction": values})
