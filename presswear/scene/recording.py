"""What is kept of a run beside its statistics: series, their rows, and Poincare sections."""

import math
from dataclasses import dataclass

from presswear.tools.quantities import choice, count, quantity
from presswear.tools.serialize import check_fields


@dataclass(frozen=True)
class Recording:
    """The recording plan of each stage; see the fields' own texts for units and ranges."""

    recorded_cycles: int | None = count(
        None,
        1,
        1000,
        "chosen",
        "cycles at the start of a stage whose series and contacts are kept; none given: 5, or "
        "with work on the punch as many as its strokes are judged by",
    )
    rows_per_cycle: int = count(
        2000, 100, 20_000, "chosen", "rows of a series in a cycle, at least; contacts add rows"
    )
    series: str = choice(
        "all",
        ("all", "watched"),
        "series that are kept: all, or those of the watched point without those of the joints",
    )
    digits: str = choice(
        "double",
        ("double", "single"),
        "of the series of joints: 16 digits, or 7 in less room",
    )
    sections: int = count(
        0, 0, 360, "chosen", "Poincare sections of every cycle, at equal angles of the cycle"
    )
    section_angle: float = quantity(
        0.0, "rad", 0.0, 2.0 * math.pi, "chosen", "angle of the cycle of the first section"
    )

    def __post_init__(self) -> None:
        check_fields(self)

    @property
    def phases(self) -> tuple[float, ...]:
        """Parts of a cycle at which its sections lie, rising, each above 0 up to 1, its end."""
        first = self.section_angle / (2.0 * math.pi)
        return tuple(
            sorted(1.0 - (1.0 - first - k / self.sections) % 1.0 for k in range(self.sections))
        )
