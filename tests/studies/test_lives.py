"""Lives beside each other, from lives that are made up."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from presswear.results.folder import ResultFolder
from presswear.results.life import Ended, LifeResult, LimitResult, PassResult
from presswear.scene.catalog import press_blanking
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.studies import write_report
from presswear.studies.lives.report import Ratio
from presswear.studies.lives.variants import make
from presswear.studies.plan import results_of
from presswear.tools.errors import InputError


def lived(strokes: float, sampling: float, ended: Ended = "limit") -> LifeResult:
    """A life that ended after some strokes."""
    reached = strokes if ended == "limit" else None
    limit = LimitResult("A.depth", "m", 5e-5, reached, sampling, 0.0, 5e-5, 1e-6)
    curve = np.array([[0.0, 0.0, 0.0], [5e-5, 4.9e-5, 5.1e-5]])
    return LifeResult(
        ended,
        "" if ended == "limit" else "no limit is passed within 5e+07 strokes",
        strokes,
        sampling,
        0.0,
        0.9,
        (limit,),
        (PassResult(1e-3, 100, reached, sampling),),
        (),
        curves={"strokes": np.array([0.0, strokes]), "A.depth": curve},
    )


@pytest.fixture
def scene() -> Scene:
    """A scene with a life."""
    return changed(press_blanking(), {"conventions": "refined", "life": "limits"})


def test_ratios_have_the_errors_of_both() -> None:
    ratio = Ratio.of(lived(2e6, 0.03), lived(1e6, 0.04))
    assert ratio.value == 2.0
    assert ratio.half_width == pytest.approx(0.05)
    assert ratio.longer == pytest.approx(1.0)
    assert Ratio(1.0, 0.1).longer == pytest.approx(0.5)
    # Half a standard deviation beside one.
    half = 0.1
    assert Ratio(math.exp(0.5 * half / 1.959964), half).longer == pytest.approx(0.691462, abs=1e-5)


def test_what_changes_nothing_is_refused(scene: Scene) -> None:
    with pytest.raises(InputError, match=r"clearance=0\.8mm: it changes nothing"):
        make(scene, {"clearance=0.8mm": {"clearance": "0.8mm"}})
    with pytest.raises(InputError, match="colour"):
        make(scene, {"colour=red": {"colour": "red"}})


def test_the_report_compares_what_is_known(tmp_path: Path, scene: Scene) -> None:
    """Each with its ratio and its probability; what has no life says why."""
    others = {"bush replaced: A@1e6": {"life.replaced": "A@1e6"}, "thin": {"clearance": "0.4mm"}}
    study = make(scene, {**others, "thick": {"clearance": "1mm"}})
    assert [own.key for own in study.variants] == [
        "plain",
        "1-bush-replaced-A-1e6",
        "2-thin",
        "3-thick",
    ]
    told = (lived(1e6, 0.04), lived(1.5e6, 0.03), lived(5e7, 0.0, "at_most"))
    for variant, life in zip(study.variants, told, strict=False):
        with ResultFolder(tmp_path / variant.key, variant.scene) as store:
            store.life(life)
            store.close("completed", "")
    assert [result is None for _, result in results_of(study, tmp_path)] == [False] * 3 + [True]
    sentence, page = write_report(study, tmp_path)
    assert sentence == (
        "As it is, it lives 1 million strokes (0.96 to 1.04 million). bush replaced: A@1e6: 1.50 "
        "(1.43 to 1.58) times as long, longer with a probability of 1. thin: no limit is passed "
        "within 5e+07 strokes. thick: it did not run."
    )
    text = page.read_text()
    assert "more than 50 million strokes: no limit is passed" in text
    assert (tmp_path / "lives.png").exists()
    read = [result.life for _, result in results_of(study, tmp_path) if result]
    assert read[0] is not None
    assert replace(read[0], curves={}) == replace(told[0], curves={})
