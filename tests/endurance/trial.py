"""What came of trying something many times."""

from dataclasses import dataclass

SEED = 20240131
"""Of all random moments, places and scenes of the trials at full length."""


@dataclass
class Trial:
    """A kind of thing that is tried, how often, and how often it was survived.

    Attributes
    ----------
    what : str
        What should happen.
    tried, survived : int
    allowed : int
        Misses that are no failure of the program.
    note : str
        What was measured, in a few words.
    miss : str
        What went wrong the first time that anything did.
    """

    what: str = ""
    tried: int = 0
    survived: int = 0
    allowed: int = 0
    note: str = ""
    miss: str = ""

    def add(self, problem: str = "", times: int = 1) -> None:
        """Count something that was tried, once or in one go several times.

        Parameters
        ----------
        problem : str
            What went wrong; empty where it was survived.
        """
        self.tried += times
        self.survived += 0 if problem else times
        self.miss = self.miss or problem
        if problem:
            print(problem)  # pytest shows every miss of a trial that fails

    @property
    def passed(self) -> bool:
        """Whether something was tried and all of it survived that must."""
        return 0 < self.tried <= self.survived + self.allowed

    @property
    def row(self) -> list[str]:
        """Cells of the table: what, tried, survived, verdict, note."""
        told = ("pass" if self.passed else "MISS") if self.tried else ""
        return [self.what, f"{self.tried}", f"{self.survived}", told, self.miss or self.note]
