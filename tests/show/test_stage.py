"""Text of a stage."""

from made_up_result import BOTH, made_up


def test_a_printed_stage_is_short_and_names_what_it_has() -> None:
    stage = made_up(BOTH, 3).stages[1]
    text = repr(stage)
    assert len(text.splitlines()) <= 25
    for word in ("completed", "2 cycles", "A: mean peak force 80", "3.00"):
        assert word in text
    assert "arrays" in text
