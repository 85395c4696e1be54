"""Numbers as people read them."""

from presswear.tools.numbers import lasting


def test_times_are_told_as_people_say_them() -> None:
    told = [lasting(own) for own in (0.04, 59.0, 90.0, 5400.0, 1e6)]
    assert told == ["0.04 s", "59 s", "1.5 minutes", "1.5 hours", "11.6 days"]
