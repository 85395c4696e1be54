"""Counts of attempts and passes."""

from dataclasses import dataclass

SEED = 20240131  # of all random moments, positions and scenes of the full trials


@dataclass
class Trial:
    """Number of attempts of one kind and of those that passed."""

    title: str = ""
    attempts: int = 0
    passes: int = 0
    allowed: int = 0  # misses that are not failures of the program
    note: str = ""
    first_miss: str = ""

    def add(self, problem: str = "", times: int = 1) -> None:
        self.attempts += times
        self.passes += 0 if problem else times
        self.first_miss = self.first_miss or problem
        if problem:
            print(problem)  # pytest shows it for a trial that fails

    @property
    def passed(self) -> bool:
        return 0 < self.attempts <= self.passes + self.allowed

    @property
    def row(self) -> list[str]:
        verdict = ("pass" if self.passed else "MISS") if self.attempts else ""
        note = self.first_miss or self.note
        return [self.title, f"{self.attempts}", f"{self.passes}", verdict, note]
