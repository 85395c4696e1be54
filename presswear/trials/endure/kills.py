"""Runs stopped at random moments, gone on with, and held against one that was left alone."""

import contextlib
import math
import random
import signal
import subprocess
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

from presswear.results.sameness import folder_differences
from presswear.tools.errors import InputError
from presswear.tools.lock import holder
from presswear.trials.endure.subject import SUBJECTS, Progress, Subject
from presswear.trials.endure.trial import Trial

_MOST_RUNS = 4
"""Runs that are tried for each stop wanted: most end before they are stopped where this fails."""


@dataclass
class _Chain:
    """One run, stopped and gone on with until it comes to its end.

    Attributes
    ----------
    stops : int
        How often it was stopped.
    problems : list of str
        What was not as it should be.
    """

    subject: Subject
    out: Path
    stops: int = 0
    problems: list[str] = field(default_factory=list)

    def run(
        self, number: signal.Signals, most: int, wait: random.Random, longest: float
    ) -> float | None:
        """Stop it at most so many times, each time after a random time up to ``longest``, s.

        Returns the time that it took where it came to its end before it was stopped even once.
        """
        while self.stops < most:
            began = time.monotonic()
            process = self.subject.start(self.out, "--resume")
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(wait.uniform(0.0, longest))
            had_begun = f"process {process.pid} " in (holder(self.out) or "")
            process.send_signal(number)
            said, error = process.communicate()
            if process.returncode == 0:
                return None if self.stops else time.monotonic() - began
            self.stops += 1
            self._judge(number, process.returncode, error, had_begun)
        code, said = self.subject.finish(self.out, "--resume")
        if code != 0:
            self.problems.append(f"ended with code {code}: {said.strip()[-300:]}")
        return None

    def _judge(self, number: signal.Signals, code: int, error: str, had_begun: bool) -> None:
        """Whether it stopped as it should."""
        if number == signal.SIGKILL:
            expected: tuple[int, ...] = (-number,)
        else:
            # As Python itself starts, it answers in its own way.
            expected = (128 + number,) if had_begun else (128 + number, -number)
        if code not in expected:
            self.problems.append(f"stopped with code {code}: {error.strip()[-300:]}")
        elif had_begun and number != signal.SIGKILL and error.strip().count("\n"):
            self.problems.append(f"said more than a line: {error.strip()[-300:]}")


def killed(
    number: signal.Signals, count: int, seed: int, progress: Progress, subjects: int = 3
) -> Trial:
    """Stop runs of all engines in turn so many times in all by a signal.

    Parameters
    ----------
    number : Signals
        SIGKILL, SIGINT or SIGTERM.
    seed : int
        Of the random moments.
    subjects : int
        How many of the engines are tried.
    """
    what = f"{number.name} at a random moment, gone on with"
    wait = random.Random(seed)
    tried = survived = chains = 0
    notes: list[str] = []
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        lasts: dict[str, float] = {}
        while tried < count and chains < _MOST_RUNS * count:
            subject = SUBJECTS[chains % subjects]
            whole = folder / f"whole-{subject.engine}"
            if subject.engine not in lasts:
                progress(f"{what}: {subject.engine} left alone", tried / count)
                began = time.monotonic()
                code, said = subject.finish(whole)
                lasts[subject.engine] = time.monotonic() - began
                if code != 0:
                    raise InputError(f"{subject.engine} does not run: {said.strip()}")
            progress(f"{what}: {subject.engine}", tried / count)
            chain = _Chain(subject, folder / f"run-{chains}")
            took = chain.run(number, min(4, count - tried), wait, lasts[subject.engine])
            # The one that was left alone may have waited for the compiler.
            lasts[subject.engine] = min(lasts[subject.engine], took or math.inf)
            problems = chain.problems
            if not problems:
                problems = _apart(whole, chain.out)
            tried += chain.stops
            survived += 0 if problems else chain.stops
            notes += [f"{subject.engine}: {problem}" for problem in problems]
            chains += 1
    if tried < count:
        notes.append(f"only {tried} of {count} stops in {chains} runs")
    note = "; ".join(notes) or (
        f"{chains} runs of {min(chains, subjects)} engines end equal, bit for bit"
    )
    return Trial(what, count, survived, note)


def _apart(whole: Path, out: Path) -> list[str]:
    """What differs between two runs' folders, or why that cannot be told."""
    try:
        return folder_differences(whole, out)[:3]
    except InputError as error:
        return [str(error)]
