"""Rows of a sweep that wait in place of computing, and leave a mark where they ran."""

import os
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from presswear.sweeps.measures import Found
from presswear.sweeps.plan import Plan
from presswear.sweeps.work import Outcome
from presswear.tools.errors import InputError
from presswear.tools.files import digest
from presswear.tools.workers import Report

KEY = "number"


@dataclass(frozen=True)
class MadeUpJob:
    """A job that waits, or keeps its core busy, and gives the number of its row.

    Attributes
    ----------
    seconds : float
    is_busy : bool
    marks : str
        File to which it adds its row when it has ended; nothing: none.
    deadly : str
        File that is there while the job is to kill the process that it is in; nothing: none.
    """

    row: int
    seconds: float = 0.0
    is_busy: bool = False
    marks: str = ""
    deadly: str = ""

    def __call__(self, report: Report) -> Outcome:
        report(0.0)
        until = time.perf_counter() + self.seconds
        while self.is_busy and time.perf_counter() < until:
            pass
        time.sleep(max(until - time.perf_counter(), 0.0))
        if self.deadly and os.path.exists(self.deadly):
            os.unlink(self.deadly)
            os.kill(os.getpid(), 9)
        if self.marks:
            file = os.open(self.marks, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
            os.write(file, f"{self.row}\n".encode())
            os.close(file)
        values = {KEY: Found(float(self.row), 0.5)}
        return Outcome(values, 1, "odd luck" if self.row % 1000 == 13 else "", self.seconds)


@dataclass(frozen=True)
class MadeUpWork:
    """As many rows as are asked for, named by their numbers alone."""

    rows: int
    seconds: float = 0.0
    is_busy: bool = False
    marks: str = ""
    deadly: str = ""
    with_folder: bool = False
    refused: int = -1

    def shortcut(self, row: int) -> str:
        return digest(f"row {row}".encode())

    def job(self, row: int) -> tuple[str, MadeUpJob]:
        if row == self.refused:
            raise InputError("this row cannot be made")
        own = MadeUpJob(row, self.seconds, self.is_busy, self.marks, self.deadly)
        return digest(f"scene {row}".encode()), own


@dataclass(frozen=True)
class PlannedWork:
    """The rows of a plan, which cost nothing."""

    plan: Plan
    with_folder: bool = False

    @property
    def rows(self) -> int:
        return self.plan.rows

    def shortcut(self, row: int) -> str:
        return self.plan.shortcut(row)

    def job(self, row: int) -> tuple[str, MadeUpJob]:
        return digest(f"scene {row}".encode()), MadeUpJob(row)


def marked(file: Path) -> Counter[int]:
    """How often each row has ended."""
    return Counter(map(int, file.read_text().split())) if file.exists() else Counter()
