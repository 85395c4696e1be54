"""Bad command lines, drawn at random, and what tries them."""

import sys

import pytest

from presswear.tools.errors import InputError, one_line
from presswear.trials.endure import inputs
from presswear.trials.endure.cases import beyond_ranges, wrong_units
from presswear.trials.endure.inputs import Answer, answered, bad_scenes, drawn, nothing_runs


def test_bad_input_is_refused_in_one_line(monkeypatch: pytest.MonkeyPatch) -> None:
    # A process takes seconds to start: three of them.
    monkeypatch.setattr(inputs, "IN_PROCESSES", 2)
    found = bad_scenes(500, seed=1)
    assert found.tried == 500
    assert found.survived == 500, found.note


@pytest.mark.slow
def test_much_bad_input_is_refused_in_one_line() -> None:
    found = bad_scenes(5000, seed=2)
    assert found.tried == 5000
    assert found.survived == 5000, found.note


def test_a_line_that_runs_or_breaks_is_no_refusal() -> None:
    with nothing_runs():
        ran = answered(["run", "ideal"])
    assert not ran.is_refusal
    assert "run_campaign" in ran.problem
    assert not answered(["list"]).is_refusal
    assert answered(["run", "nothing"]).is_refusal
    for answer in (
        Answer(1, "", "presswear: no\n"),
        Answer(2, "", "presswear: one\npresswear: two\n"),
        Answer(2, "", "one\n"),
        Answer(2, "", ""),
        Answer(2, "something", "presswear: no\n"),
    ):
        assert not answer.is_refusal


def test_the_same_seed_draws_the_same() -> None:
    one, same, other = (drawn(beyond_ranges(), 30, seed) for seed in (1, 1, 2))
    assert one == same != other
    assert len(drawn(wrong_units(), 30, 1)) == 30


def test_what_is_missing_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "hypothesis", None)
    with pytest.raises(InputError, match=r"pip install 'presswear\[test\]'"):
        bad_scenes(1, seed=1)


def test_a_message_is_one_short_line_of_what_can_be_shown() -> None:
    assert one_line("a\nb\x1b[2J\udcff") == "a\\nb\\x1b[2J\\udcff"
    assert one_line("µ, °") == "µ, °"
    assert len(one_line("x" * 10_000)) <= 1000
