"""Counterparts of the paper's figures, of a small made-up study."""

import re
from dataclasses import replace
from typing import Any

import matplotlib
import numpy as np
import pytest
from invented import cut, every_evidence, every_result

from presswear.paper.evidence import Evidence
from presswear.paper.figures import drawers
from presswear.paper.printed import JOINTS, Place, shown_in
from presswear.paper.variants import BASE, variant_key
from presswear.show.figures import Drawing
from presswear.show.figures.style import SETTINGS

NUMBERS = range(8, 26)
UNIT = re.compile(r"\((m|mm|µm|s|N|m/s|m/s²|degrees)\)")


def study(stages: dict[str, int], **changes: Any) -> Evidence:
    """Some settings, each with so many stages."""
    whole = every_result()
    return Evidence(
        {
            variant_key(BASE, setting): cut(whole[variant_key(BASE, setting)], count, **changes)
            for setting, count in stages.items()
        }
    )


@pytest.fixture(scope="module")
def drawn() -> dict[int, Drawing]:
    return by_number(every_evidence())


def by_number(evidence: Evidence) -> dict[int, Drawing]:
    drawings = [drawing for draw in drawers(evidence) for drawing in draw()]
    found = {int(drawing.title.split()[1]): drawing for drawing in drawings}
    assert len(found) == len(drawings)
    return found


def marked(drawing: Drawing, kind: str) -> list[tuple[float, float]]:
    """Places of the marks of one kind."""
    lines = (line for axes in drawing.sheet.axes for line in axes.get_lines())
    return [
        (float(np.ravel(line.get_xdata())[0]), float(np.ravel(line.get_ydata())[0]))
        for line in lines
        if line.get_gid() == kind
    ]


def test_every_figure_is_drawn_once_in_order(drawn: dict[int, Drawing]) -> None:
    assert list(drawn) == list(NUMBERS)
    for number, drawing in drawn.items():
        assert drawing.file == f"fig-{number:02d}.png"
        assert drawing.title.startswith(f"Fig. {number} ")
        assert drawing.caption.endswith(".")
        width, height = drawing.sheet.get_size_inches()
        assert (width, height <= 9.6) == (7.0, True)


def test_every_axis_label_has_a_unit(drawn: dict[int, Drawing]) -> None:
    for drawing in drawn.values():
        every = [f() for axes in drawing.sheet.axes for f in (axes.get_xlabel, axes.get_ylabel)]
        assert any(every)
        assert all(UNIT.search(label) for label in every if label), every


@pytest.mark.parametrize("number", [8, 11, 14, 17, 18, 20, 21, 23, 24])
def test_printed_values_are_marked_where_they_are(drawn: dict[int, Drawing], number: int) -> None:
    found = sorted(marked(drawn[number], "printed"))
    own = shown_in(number)
    if number < 17:
        angles = [float(np.degrees(one.value)) for one in own if one.quantity == "angle"]
        depths = [1e6 * one.value for one in own if one.quantity == "depth"]
        np.testing.assert_allclose(found, sorted(zip(angles, depths, strict=True)))
    else:
        np.testing.assert_allclose([x for x, _ in found], sorted(one.value for one in own))


def test_peaks_are_those_of_all_cycles_and_of_the_one_shown(drawn: dict[int, Drawing]) -> None:
    """Figures 18 and 17, which show the first cycle, every step of it."""
    places = [
        Place("wear-times", wear_updates, joint) for joint in JOINTS for wear_updates in range(3)
    ]
    known = [every_evidence().measured(BASE, place, "force") for place in places]
    means = [x for x, _ in marked(drawn[18], "mean")]
    np.testing.assert_allclose(means, [one.value for one in known if one is not None])
    stages = every_result()[variant_key(BASE, "wear-times")].stages
    names = ("displacement_max", "velocity_max", "acceleration_max")
    expected = [stage.each_cycle(name)[0] for name in names for stage in stages]
    np.testing.assert_allclose([x for x, _ in marked(drawn[17], "shown")], expected)


def test_depth_is_the_mean_map(drawn: dict[int, Drawing]) -> None:
    for axes, joint in zip(drawn[8].sheet.axes, "AC", strict=True):
        curves = [line for line in axes.get_lines() if len(np.ravel(line.get_xdata())) > 2]
        for wear_updates, line in enumerate(curves, start=1):
            known = every_evidence().wear_map(BASE, Place("wear-times", wear_updates, joint))
            assert known is not None
            np.testing.assert_allclose(np.asarray(line.get_ydata()), 1e6 * known.mean)
        assert len(curves) == 2


def test_doubtful_print_is_starred(drawn: dict[int, Drawing]) -> None:
    texts = [text.get_text() for text in drawn[8].sheet.axes[0].texts]
    assert texts == ["1.221 µm*", "1\u202f178 µm"]
    assert "*: below the depth at C" in drawn[8].caption
    assert "*" not in drawn[11].caption


@pytest.mark.parametrize(("column", "period"), [(0, 0.5), (1, 0.25)])
def test_one_cycle_is_shown(drawn: dict[int, Drawing], column: int, period: float) -> None:
    """Figure 23: both speeds over a cycle of their own."""
    axes = drawn[23].sheet.axes[column]
    assert axes.get_xlim() == pytest.approx((0.0, period))
    for line in axes.get_lines():
        end = float(np.ravel(line.get_xdata())[-1])
        assert 0.98 * period <= end <= period * (1.0 + 1e-9)


def test_surfaces_are_those_after_the_wear(drawn: dict[int, Drawing]) -> None:
    """Also where no stage ran on them: figure 9 ends with the second wear."""
    without_last = by_number(study({"wear-times": 2}))
    assert without_last[9].caption == drawn[9].caption


@pytest.mark.parametrize(
    ("stages", "missing"),
    [
        ({"wear-times": 3}, set(range(11, 17)) | set(range(20, 26))),
        ({"wear-times": 1, "friction-0.1": 2}, {14, 15, 16, 23, 24, 25}),
        ({"friction-0.05": 1, "speed-8pi": 2}, {8, 9, 10, 17, 18, 19}),
        ({}, set(NUMBERS)),
    ],
    ids=["one setting", "one wear", "others", "nothing"],
)
def test_missing_runs_leave_the_rest(stages: dict[str, int], missing: set[int]) -> None:
    found = by_number(study(stages))
    assert set(NUMBERS) - set(found) == missing
    with matplotlib.rc_context(SETTINGS):
        for number in set(found) & {19, 21, 23}:
            found[number].sheet.draw_without_rendering()


def test_failed_stage_is_not_shown(drawn: dict[int, Drawing]) -> None:
    ((key, run),) = study({"wear-times": 3}).results.items()
    stages = (*run.stages[:2], replace(run.stages[2], status="failed"))
    found = by_number(Evidence({key: replace(run, stages=stages)}))
    assert len(found[19].sheet.axes) == 4
    assert len(drawn[19].sheet.axes) == 6


def test_closed_joint_is_left_out() -> None:
    found = by_number(study({"wear-times": 3}, joints="A"))
    assert 10 not in found
    assert len(found[8].sheet.axes) == 1
    assert len(found[19].sheet.axes) == 3
    assert set(by_number(study({"wear-times": 1}, joints="none", wear_updates=0))) == {17}


def test_settings_of_matplotlib_are_left_alone() -> None:
    before = dict(matplotlib.rcParams)
    assert drawers(every_evidence())[0]()
    assert dict(matplotlib.rcParams) == before
