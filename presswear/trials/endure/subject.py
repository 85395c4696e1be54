"""The short runs that are put through it: real processes of ``presswear run``."""

import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

Progress = Callable[[str, float], None]
"""Told what is tried and which part of it is done, 0 .. 1."""

_PROGRAM = """
import signal, sys
signal.signal(signal.SIGINT, signal.default_int_handler)
from presswear.__main__ import main
sys.exit(main(sys.argv[1:]))
"""
"""As ``python -m presswear``; a shell's background jobs have SIGINT ignored."""


@dataclass(frozen=True)
class Subject:
    """A short run.

    Attributes
    ----------
    engine : str
    arguments : tuple of str
        Behind ``presswear run``.
    """

    engine: str
    arguments: tuple[str, ...]

    def start(self, out: Path, *more: str) -> "subprocess.Popen[str]":
        """Start it in a process and a session of its own."""
        return subprocess.Popen(
            [sys.executable, "-c", _PROGRAM, "run", *self.arguments, "--out", str(out), *more],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
            env={**os.environ, "COLUMNS": "200"},
        )

    def finish(self, out: Path, *more: str) -> tuple[int, str]:
        """Run it to its end; returns its exit code and what it said."""
        process = self.start(out, *more)
        said, error = process.communicate()
        return process.returncode, said + error


def _subject(engine: str, scene: str, *settings: str) -> Subject:
    changes = [word for setting in settings for word in ("--set", setting)]
    return Subject(
        engine,
        (scene, "--engine", engine, "--wears", "1", "--checkpoint", "0", *changes),
    )


_PRESS = ("speed=60rad/s", "represented_cycles=1e6", "extrapolation=steps", "depth_step=0.012")
SUBJECTS = (
    _subject("exudyn-tree", "wear-times", *_PRESS, "cycles=2"),
    _subject("dae", "wear-times", *_PRESS, "cycles=2", "starts=2"),
    _subject(
        "exudyn-joints",
        "slider-crank",
        "cycles=1",
        "represented_cycles=2e4",
        "steps_per_contact=20",
        "steps_sustained=5",
    ),
)
"""One for each engine: several cycles, starts and steps of a wear, a few seconds each."""
