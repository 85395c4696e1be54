"""What a run is put through, and whether it came through."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Trial:
    """What was tried, how often, and how often it was survived."""

    what: str
    tried: int
    survived: int
    note: str
