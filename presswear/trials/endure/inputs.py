"""Trials of input: what is bad is refused in one line, before anything runs or is written."""

import contextlib
import io
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from unittest.mock import patch

from presswear.__main__ import main
from presswear.tools.errors import InputError
from presswear.trials.endure.cases import families
from presswear.trials.endure.trial import Trial

Progress = Callable[[float], None]
"""Told the part that is done, 0 .. 1."""

RUNNERS = (
    "presswear.campaign.campaign.run_campaign",
    "presswear.commands.studies.run_study",
    "presswear.trials.crosscheck.check.check_engines",
    "presswear.trials.precision.study.measure",
    "presswear.trials.costs.study.study",
    "presswear.trials.verify.verify.verify",
)
"""What begins to compute; no bad input may come so far."""
IN_PROCESSES = 24
"""Bad command lines that go to a process of their own as well, at most."""
_PATIENCE = 60.0
"""Wall time after which such a process counts as hung, s."""


@dataclass(frozen=True)
class Answer:
    """How a command line ended.

    Attributes
    ----------
    code : int
    output, errors : str
        What it wrote to standard output and standard error.
    """

    code: int
    output: str
    errors: str

    @property
    def is_refusal(self) -> bool:
        """Whether it is exit code 2, nothing said but one line of errors."""
        line = self.errors.removesuffix("\n")
        said = line.strip().startswith("presswear: ") and len(line.splitlines()) == 1
        return self.code == 2 and said and not self.output

    @property
    def problem(self) -> str:
        """What is wrong with it as a refusal, in a few words."""
        return f"exit code {self.code}, {(self.errors or self.output)[-200:]!r}"


class Ran(BaseException):
    """Something began to compute; no command catches it."""


def needs_hypothesis() -> None:
    """InputError where what draws random input is not installed."""
    try:
        import hypothesis  # noqa: F401
    except ImportError:
        raise InputError("hypothesis is missing: pip install 'presswear[test]'") from None


def answered(line: list[str]) -> Answer:
    """A command line in this process; a traceback counts as exit code 1, as in a shell."""
    output, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(output), contextlib.redirect_stderr(errors):
        try:
            code = main(line)
        except SystemExit as ended:
            code = ended.code if isinstance(ended.code, int) else 1
        except Ran as ran:
            return Answer(0, output.getvalue(), f"it ran {ran}")
        except Exception as error:
            return Answer(1, output.getvalue(), f"{type(error).__name__}: {error}")
    return Answer(code, output.getvalue(), errors.getvalue())


def answered_by_process(line: list[str]) -> Answer:
    """A command line as a person types it."""
    try:
        found = subprocess.run(
            [sys.executable, "-m", "presswear", *line],
            capture_output=True,
            text=True,
            errors="backslashreplace",
            timeout=_PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return Answer(1, "", f"it still went on after {_PATIENCE:g} s")
    return Answer(found.returncode, found.stdout, found.stderr)


@contextlib.contextmanager
def nothing_runs() -> Iterator[None]:
    """Whatever begins to compute is stopped at once, with ``Ran``."""
    with contextlib.ExitStack() as stack:
        for name in RUNNERS:
            stack.enter_context(patch(name, side_effect=Ran(name)))
        yield


@contextlib.contextmanager
def elsewhere() -> Iterator[Path]:
    """A folder of its own to be in; what the program leaves there is seen."""
    before = Path.cwd()
    with tempfile.TemporaryDirectory() as name:
        os.chdir(name)
        try:
            yield Path(name)
        finally:
            os.chdir(before)


def drawn(strategy: Any, count: int, seed: int) -> list[Any]:
    """So many examples of a strategy of hypothesis, the same for the same seed."""
    import hypothesis

    found: list[Any] = []
    few = hypothesis.settings(
        max_examples=count,
        database=None,
        deadline=None,
        phases=[hypothesis.Phase.generate],
        suppress_health_check=list(hypothesis.HealthCheck),
    )
    for attempt in range(100):

        def keep(example: Any) -> None:
            found.append(example)

        seeded: Any = hypothesis.seed(1000 * seed + attempt)
        seeded(few(hypothesis.given(strategy)(keep)))()  # type: ignore[no-untyped-call]
        if len(found) >= count:
            break
    return found[:count]


def bad_scenes(count: int, seed: int, progress: Progress = lambda part: None) -> Trial:
    """Bad command lines of every kind, refused in one line with exit code 2, nothing written.

    Parameters
    ----------
    count : int
        Of all kinds together; some of them go to processes of their own as well.
    """
    needs_hypothesis()
    tried = survived = processes = 0
    first = ""
    with elsewhere() as here, nothing_runs():
        file, folder, empty = here / "a-file", here / "a-folder", here / "empty"
        file.write_text("somebody's")
        folder.mkdir()
        (folder / "precious").write_text("somebody's")
        kinds = families(str(folder), str(file))
        each = -(-count // len(kinds))
        lines = [
            (name, line) for name, strategy in kinds.items() for line in drawn(strategy, each, seed)
        ][:count]
        empty.mkdir()
        os.chdir(empty)
        for place, (name, line) in enumerate(lines):
            answers = [answered(line)]
            # The operating system passes no zero byte on.
            if place % (count // IN_PROCESSES + 1) == 0 and not any("\0" in word for word in line):
                answers.append(answered_by_process(line))
                processes += 1
            wrong = next((a.problem for a in answers if not a.is_refusal), "")
            if any(empty.iterdir()) or len(list(folder.iterdir())) != 1:
                wrong = wrong or "something was written"
            tried += 1
            survived += not wrong
            first = first or (f"{name}: {line!r:.300}: {wrong}" if wrong else "")
            progress(tried / count)
    note = f"{len(kinds)} kinds, {processes} in processes of their own"
    return Trial(
        "bad command lines refused with one line and exit code 2", tried, survived, first or note
    )
