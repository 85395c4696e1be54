"""Hard cases: where a run could hang, break, or be wrong without a word."""

from collections.abc import Iterator

from presswear.trials.hard.case import HardCase


def hard_cases() -> Iterator[HardCase]:
    """Every hard case, long ones included."""
    from presswear.trials.hard.bodies import body_cases
    from presswear.trials.hard.drift import drift_cases
    from presswear.trials.hard.scenes import scene_cases

    yield from body_cases()
    yield from scene_cases()
    yield from drift_cases()
