"""Messages in one line."""

from presswear.tools.errors import one_line
from presswear.tools.numbers import large


def test_a_message_keeps_narrow_spaces_and_escapes_what_is_not_printable() -> None:
    words = (
        f"stored up to refinement 2 of the life, {large(27_000.0, digits=2)} strokes"
    )
    assert "27\u202f000 strokes" in words
    assert one_line(words) == words
    assert one_line("a\nb\x1b") == "a\\nb\\x1b"
