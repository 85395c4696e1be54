"""Messages in one line."""

from pathlib import Path

import pytest

from presswear.tools.errors import nearest, one_line, unknown
from presswear.tools.not_modelled import PAGE, answers
from presswear.tools.numbers import large

ROOT = Path(__file__).parents[2]


def test_a_message_keeps_narrow_spaces_and_escapes_what_is_not_printable():
    words = (
        f"stored up to refinement 2 of the life, {large(27_000.0, digits=2)} strokes"
    )
    assert "27\u202f000 strokes" in words
    assert one_line(words) == words
    assert one_line("a\nb\x1b") == "a\\nb\\x1b"


@pytest.mark.parametrize(
    ("name", "near"), [("body", "bodies"), ("speeed", "speed"), ("spiel", "")]
)
def test_only_near_names_are_proposed(name, near):
    known = ["speed", "bodies"]
    assert nearest(name, known) == (f"; did you mean {near}?" if near else "")


@pytest.mark.parametrize(
    "name", ["gear_ratio", "Gears", "tool.temperature", "temperatur", "3D"]
)
def test_a_word_for_what_is_not_modelled_is_answered(name):
    message = f"{unknown('key', name, ['speed', 'integrator'])}"
    assert message.startswith(f"unknown key {name!r}. Not modelled: ")
    assert message.endswith(f"; see {PAGE}")


@pytest.mark.parametrize(
    ("name", "answer"),
    [
        ("lubricants", "viscosity"),
        ("H8/f7", "110 H8/f7"),
        ("flywheel", "motor.inertia"),
        ("spiel", "radial play of a pin is its clearance"),
        ("jeu", "radial play of a pin is its clearance"),
        ("motor.power", "22 kW at 1440 rpm are 146 N m"),
    ],
)
def test_a_word_for_what_has_another_name_is_answered(name, answer):
    message = f"{unknown('key', name, ['speed', 'motion'])}"
    assert message.startswith(f"unknown key {name!r}. ")
    assert "Not modelled" not in message
    assert answer in message


def test_a_name_of_the_user_that_is_such_a_word_is_found_first():
    message = f"{unknown('body', 'beams', ['beam', 'crank', 'rod'])}"
    assert "did you mean beam?" in message
    assert "Not modelled" not in f"{unknown('key', 'spead', ['speed', 'motion'])}"


def test_a_near_name_is_the_answer_in_place_of_another_name_for_one_of_its_words():
    message = f"{unknown('response', 'B.load_distance', ['B.sliding_distance'])}"
    assert message.endswith("did you mean B.sliding_distance?")


def test_the_page_lists_all_that_is_not_modelled():
    page = (ROOT / PAGE).read_text(encoding="utf-8")
    for row in answers()["not_modelled"]:
        cells = (", ".join(row["words"]), row["answer"].replace("; ", " | "))
        assert f"| {' | '.join(cells)} |" in page
    for row in answers()["other_names"]:
        assert f"| {', '.join(row['words'])} | {row['answer']} |" in page
