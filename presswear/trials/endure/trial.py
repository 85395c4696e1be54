"""What came of trying something many times."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Trial:
    """A kind of thing that was tried, how often, and how often it was survived.

    Attributes
    ----------
    what : str
        What should happen.
    tried, survived : int
    note : str
        What was measured, in a few words; of a miss, the first one.
    """

    what: str
    tried: int
    survived: int
    note: str

    @property
    def passed(self) -> bool:
        """Whether something was tried and all of it survived."""
        return 0 < self.tried == self.survived
