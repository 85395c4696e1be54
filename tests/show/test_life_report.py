"""Service lives in the report of small made-up results."""

from dataclasses import replace

import made_up_result as made
import numpy as np
import pytest
from made_up_result import altered, lived, made_up, not_passed
from test_page import Page

import presswear as pw
from presswear.show.report import render_report


def page_of(result: pw.Result) -> Page:
    return Page(render_report(result))


LIVED = lived(made_up(made.BODY, 3))


def test_the_answer_on_a_life():
    # The hours are rounded to two digits, as the life is.
    rate = 60.0 / LIVED.scene.mechanism.period
    hours = round(made.LIFE / rate / 60.0, -1)
    page = page_of(LIVED)
    expected = (
        "The first limit, depth of C over 50 µm, is exceeded after 5 million strokes (4.8 to 5.3 "
        f"million), {hours:.0f} hours at {rate:.0f} strokes per minute. The wear coefficient "
        "scatters by 50 %: with this scatter the life is 3 to 8.3 million strokes."
    )
    assert expected in page.text
    assert (
        "with an unknown error"
        in page_of(lived(LIVED, made.made_up_life(None, 0.1))).text
    )
    row = page.row("depth of A over 50 µm")
    assert row[1:] == ["not exceeded", "–", "–", "20.0\u00a0± 1.0 µm"]
    first = page.row("depth of C over 50 µm")
    assert (first[1:3], first[4]) == (
        ["5 million", "4.8 to 5.3 million"],
        "60.0\u00a0± 3.0 µm",
    )
    assert "After 2 million strokes: bushing of A replaced." in page.text
    stages = ["after 2.5 million strokes", "after 5 million strokes"]
    assert page.row("bottom dead centre")[2:] == stages
    assert "Service life" not in page_of(made_up(made.BODY, 3)).words


def test_a_pin_that_ends_a_life_with_a_new_bushing_is_named():
    """The depth of the joint ends the life, and the bushing alone was replaced."""
    life = made.made_up_life()
    stage = LIVED.stages[-1]
    first = replace(life.limits[1], key="A.depth")
    sentence = (
        "The pin of A ends this life: it is worn by 50.0 µm at the end, its bushing by"
    )
    for side, key, is_named in (
        ("pin", "A", True),
        ("bearing", "A", False),
        ("pin", "C", False),
    ):
        depth = {"A_depth_bearing": np.full(72, 2e-5), "A_depth_pin": np.full(72, 2e-5)}
        depth[f"A_depth_{side}"][3] = 5e-5
        result = altered(LIVED, len(LIVED.stages) - 1, arrays={**stage.arrays, **depth})
        limits = (replace(first, key=f"{key}.depth"),)
        text = page_of(replace(result, life=replace(life, limits=limits))).text
        assert (sentence in text.replace("\u00a0", " ")) == is_named


@pytest.mark.parametrize(
    ("ended", "message", "line"),
    [
        ("at_most", "", "life.at_most"),
        ("worn", "A: worn through", "The simulation stopped there: A: worn through."),
        ("cycles", "", "life.max_cycles"),
    ],
)
def test_an_unknown_life_is_not_guessed(ended, message, line):
    page = page_of(lived(LIVED, not_passed(ended, message)))
    assert "No limit is exceeded within 5 million strokes, " in page.text
    assert "depth of A 25.0 µm of 50 µm" in page.text
    assert line in page.text


@pytest.mark.parametrize(("strokes", "is_named"), [(5.4e6, True), (7e6, False)])
def test_a_limit_that_may_be_the_first_is_named(strokes, is_named):
    life = made.made_up_life()
    rival = replace(life.limits[0], strokes=strokes, sampling=0.05, step=0.0)
    text = page_of(lived(LIVED, replace(life, limits=(rival, *life.limits[1:])))).text
    assert ("its interval overlaps that of the life: depth of A." in text) == is_named
