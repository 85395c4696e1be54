"""Run the command lines of pages and help texts:  python docs/_tools/lines.py [PAGE ...]

The build of the site calls this.  Command lines in cells run with their page.  The
others run in the order of their page, in one folder per page that contains the results
which they read.  A command that takes longer than ``LONGEST`` is stopped as by Ctrl-C.
Each command is a process that is forked from one which has imported the program.
"""

import faulthandler
import multiprocessing
import os
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from itertools import chain, takewhile
from pathlib import Path
from typing import Any

from presswear.__main__ import main
from presswear.cli import COMMANDS

DOCS = Path(__file__).resolve().parents[1]
ROOT = DOCS.parent
PAGES = sorted(
    page
    for page in [*ROOT.glob("*.md"), *DOCS.rglob("*.md")]
    if page.relative_to(ROOT).parts[1:2] != ("_build",)
)
LONGEST = 1.0  # s; a command that takes longer is stopped
TIME_TO_END = 60.0  # s; after it was stopped, and time to begin
PAGES_AT_ONCE = 2
# Modules that nearly all commands import
IMPORTED = ["presswear.cli.run", "presswear.campaign.runs", "presswear.show.report"]
PATH = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
# Commands that make small versions of the results that command lines read
MADE = {
    "results/wear-times": "run wear-times --engine dae --cycles 4 --wear-updates 1",
    "results/mine": "run wear-times --engine dae --cycles 2 --wear-updates 1 --out results/mine",
    "results/long": "run wear-times --engine dae --cycles 2 --wear-updates 1 --out results/long",
    "results/press-blanking-life": "life press-blanking --engine dae --set replicates=2 "
    "--tolerance 1 --until 'C.depth > 0.01 um'",
    "results/clearances": "sweep wear-times --vary clearance=0.2mm,1.0mm --response A.force_max "
    "--set engine=dae --set cycles=2 --set wear_updates=0 --out results/clearances",
    "results/slider-crank-dynamics": "dynamics slider-crank --over 'speed=50:60:2 rad/s' "
    "--exponent 0",
    "theirs.csv": "export results/mine theirs.csv",
    "my-press.toml": "new four-bar my-press.toml",
    "press.toml": "new press press.toml",
}
_LAWS = (DOCS / "how-to/laws.md").read_text()
# Tables and laws of a user that command lines read
TABLES = {
    "laws.py": "\n".join(re.findall(r"```python\n(.*?)```", _LAWS, re.DOTALL)),
    "worn.csv": "joint,side,angle (deg),depth (um)\n"
    + "\n".join(f"A,bearing,{10 * k},{k % 6}" for k in range(36)),
    "readings.csv": "joint,strokes,depth (um),error (um)\n"
    "C,1500000,9,2\nC,3000000,14,2\nC,4500000,20,2\n",
}


def lines_of(text: str) -> Iterator[str]:
    """Yield the presswear commands of a text, without ``presswear`` itself."""
    joined = re.sub(r"\\\n\s*", " ", text)
    for line in joined.splitlines():
        for command in re.split(r"&&|\|\|", line.strip()):
            pattern = r"(?:\S*/)?presswear (?=[a-z-])(.*)"
            if match := re.match(pattern, command.strip()):
                yield match[1]


def lines_in_cells(text: str) -> list[str]:
    """Return the commands in code cells."""
    cells = re.findall(
        r"^```\{code-cell\} ipython3\n%%bash\n(.*?)^```", text, re.M | re.S
    )
    return list(chain(*map(lines_of, cells)))


def all_lines() -> dict[str, list[str]]:
    """Return the commands outside of cells of each page, and the examples of help texts."""
    places = {}
    for page in PAGES:
        text = page.read_text()
        in_cells = lines_in_cells(text)
        lines = [line for line in lines_of(text) if line not in in_cells]
        places[str(page.relative_to(ROOT))] = lines
    examples = []
    for command in COMMANDS.values():
        examples += command["example"].split("; ")
    return {**places, "help": list(chain(*map(lines_of, examples)))}


def _run(
    line: str, folder: Path, output: str, environment: dict[str, str], started: Any
) -> None:
    """Run a command in this process, which is a new one, and end it with the exit code."""
    # Where other processes were started before, it inherits blocked signals.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT, signal.SIGTERM})
    os.chdir(folder)
    os.environ.clear()
    os.environ.update(environment)
    with open(output, "wb") as file:
        for stream in (1, 2):
            os.dup2(file.fileno(), stream)
    faulthandler.enable()  # a crash prints where it happened
    words = shlex.split(line, comments=True)
    started.set()
    sys.exit(main(list(takewhile(lambda word: word != ">", words))))


def _failure(line: str, folder: Path, longest: float | None) -> str:
    """Run a command and return its output if it fails, else an empty text."""
    environment = {**os.environ, "HOME": str(folder), "PATH": PATH}
    context = multiprocessing.get_context("forkserver")
    with tempfile.NamedTemporaryFile("r") as output:
        started = context.Event()
        arguments = line, folder, output.name, environment, started
        process = context.Process(target=_run, args=arguments)
        process.start()
        started.wait(TIME_TO_END)
        process.join(longest)
        allowed = {0}
        if process.is_alive():
            os.kill(process.pid or 0, signal.SIGINT)
            # The latter while Python exits
            allowed |= {128 + signal.SIGINT, -signal.SIGINT}
            process.join(TIME_TO_END)
            if process.is_alive():
                process.kill()
                process.join()
        if process.exitcode in allowed:
            return ""
        return f"presswear {line}: exit code {process.exitcode}\n{output.read()}"


def _failures(source: Path, longest: float, place: str, lines: list[str]) -> list[str]:
    """Run the commands of a page and return the messages of those that fail.

    Results and files that a command reads are copied from the folder ``source``.
    """
    failed = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scenarios").symlink_to(ROOT / "scenarios")
        for line in lines:
            is_new = "--out" in line and "--resume" not in line
            items = [item for item in (*MADE, *TABLES) if item in line]
            if line.startswith("new ") or is_new:
                items = []
            for item in items:
                copy = shutil.copytree if (source / item).is_dir() else shutil.copy
                shutil.rmtree(folder / item, ignore_errors=True)
                (folder / item).parent.mkdir(exist_ok=True)
                copy(source / item, folder / item)
            has_file = re.search("--(movie|still) ", line)
            needs_window = line.startswith("replay ") and not has_file
            if "DISPLAY" in os.environ or not needs_window:
                failed.append(_failure(line, folder, longest))
    return [f"{place}: {message}" for message in failed if message]


@contextmanager
def display() -> Iterator[None]:
    """Start a virtual display if there is none and Xvfb is installed."""
    if "DISPLAY" in os.environ or shutil.which("Xvfb") is None:
        yield
        return
    read, write = os.pipe()
    server = subprocess.Popen(
        ["Xvfb", "-displayfd", str(write), "-screen", "0", "1280x900x24", "-noreset"],
        pass_fds=[write],
        stderr=subprocess.DEVNULL,
    )
    os.close(write)
    with os.fdopen(read) as number:
        os.environ["DISPLAY"] = f":{number.readline().strip()}"
    try:
        yield
    finally:
        del os.environ["DISPLAY"]
        server.kill()
        server.wait()


def failures(places: dict[str, list[str]], longest: float = LONGEST) -> list[str]:
    """Run all commands and return a message for each that fails, with its place."""
    text = " ".join(chain(*places.values()))
    cache = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    os.environ["XDG_CACHE_HOME"] = cache
    multiprocessing.get_context("forkserver").set_forkserver_preload(IMPORTED)
    with tempfile.TemporaryDirectory() as name, display():
        source = Path(name)
        for table, rows in TABLES.items():
            (source / table).write_text(rows)
        makers = [line for item, line in MADE.items() if item in text]
        needed = " ".join([text, *makers])
        messages = []
        for item, line in MADE.items():
            if item in needed:
                messages.append(_failure(line, source, None))
        if any(messages):
            return list(filter(None, messages))
        run_page = partial(_failures, source, longest)
        with ThreadPoolExecutor(PAGES_AT_ONCE) as threads:
            return list(chain(*threads.map(run_page, places, places.values())))


if __name__ == "__main__":
    wanted = sys.argv[1:] or all_lines()
    messages = failures({place: all_lines()[place] for place in wanted})
    sys.exit("\n".join(messages) or None)
