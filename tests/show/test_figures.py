"""Figures of small made-up results: which there are, and how a script asks for them."""

import re
from dataclasses import replace
from pathlib import Path

import matplotlib
import matplotlib.pyplot as pyplot
import pytest
from made_up_result import BODY, BOTH, IDEAL, ONE, grown, legend_of, made_up
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Sheet

from presswear.scene.scene import Scene
from presswear.show.figures import NAMES, drawings, save
from presswear.tools.errors import InputError

UNIT = re.compile(
    r"\((m|mm|µm|nm|s|N|m/s|m/s²|N m|W|degrees|strokes|%|orders|N²/Hz|\(m/s²\)²/Hz)\)"
)
BODY_A = replace(BODY, joints="A")
BOTTOM = "bottom-dead-centre.png"
NOT_MADE_UP = ("life", "tonnage")
"""Figures that need what made-up results have not."""
MOTION = [
    *("response.png", BOTTOM, "contact-force.png", "centre-trajectory.png"),
    *("phase.png", "poincare.png", "impacts.png", "modes.png", "spectrum.png"),
]


@pytest.mark.parametrize(
    ("scene", "stages", "files"),
    [
        (BOTH, 2, ["wear-depth.png", "worn-surface-A.png", "worn-surface-C.png", *MOTION]),
        (BODY_A, 2, ["wear-depth.png", "worn-surface-A.png", *MOTION]),
        (ONE, 1, ["wear-depth.png", *MOTION]),
        (IDEAL, 1, ["response.png"]),
    ],
    ids=["both joints", "maps on bodies", "one joint, one stage", "ideal"],
)
def test_draws_what_makes_sense(
    scene: Scene, stages: int, files: list[str], tmp_path: Path
) -> None:
    found = list(drawings(made_up(scene, stages)))
    files = ["mechanism.png", "stroke.png", *files]
    assert [drawing.file for drawing in found] == files
    for drawing in found:
        assert save(drawing, tmp_path / "figures").read_bytes().startswith(b"\x89PNG")
        assert drawing.title
        assert drawing.caption.endswith(".")
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == sorted(files)


def labels(axes: Axes) -> list[str]:
    return [label for label in (axes.get_xlabel(), axes.get_ylabel()) if label]


@pytest.mark.parametrize("scene", [BOTH, BODY], ids=["fixed maps", "maps on bodies"])
def test_every_axis_label_has_a_unit(scene: Scene) -> None:
    for drawing in drawings(made_up(scene, 2)):
        found = [label for axes in drawing.sheet.axes for label in labels(axes)]
        assert found
        assert all(UNIT.search(label) for label in found), found


def test_plot_gives_the_axes_of_every_figure_in_memory() -> None:
    result = grown()
    assert result.path is None
    counts = {name: len(result.plot(name)) for name in NAMES if name not in NOT_MADE_UP}
    assert counts.pop("mechanism") == 1
    torque = {"drives": 4}
    motion = {"stroke": 1, "response": 7, "bottom": 3, "force": 6, "path": 6}
    moved = {"phase": 9, "poincare": 6, "impacts": 6, "modes": 6, "spectrum": 3}
    assert counts == {"wear": 2, "growth": 2, "surfaces": 6, **motion, **torque, **moved}
    assert len(result.plot()) == 1 + sum(counts.values())
    assert len(result.plot("path", "wear")) == counts["path"] + counts["wear"]


@pytest.mark.parametrize(
    "name", [name for name in NAMES if name not in ("mechanism", "growth", *NOT_MADE_UP)]
)
def test_plot_of_one_stage_shows_it_alone(name: str) -> None:
    (sheet,) = {axes.figure for axes in grown().plot(name, stage=1)[:3]}
    assert isinstance(sheet, Sheet)
    words = [text.get_text() for axes in sheet.axes for text in (axes.title, *axes.texts)]
    told = " ".join([*legend_of(sheet), *words])
    assert "first wear" in told
    assert "second wear" not in told
    assert "third wear" not in told


@pytest.mark.parametrize(
    ("names", "stage", "message"),
    [
        (
            ["forces"],
            None,
            "unknown figure 'forces'; did you mean force?; known are life, mechanism, stroke",
        ),
        (["growth"], None, "wear-times has nothing to draw as 'growth'"),
        (["wear"], 0, "stage 0 of wear-times has nothing to draw as 'wear'"),
        (["force"], 7, "wear-times has no stage 7; it has 0, 1, 2; did you mean 2?"),
    ],
)
def test_plot_refuses_in_a_line(names: list[str], stage: int | None, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        made_up(BOTH, 3).plot(*names, stage=stage)


def test_a_script_keeps_its_matplotlib_as_it_is() -> None:
    """No setting changes, and figures that nobody asked to see are not kept by pyplot."""
    before = dict(matplotlib.rcParams)
    made_up(IDEAL, 1).plot()
    assert dict(matplotlib.rcParams) == before
    assert pyplot.get_fignums() == []


def test_pyplot_shows_figures_where_it_is_interactive() -> None:
    pyplot.switch_backend("agg")
    with pyplot.ion():
        axes = made_up(IDEAL, 1).plot("response")
    assert [pyplot.figure(number) for number in pyplot.get_fignums()] == [axes[0].figure]
    pyplot.close("all")
