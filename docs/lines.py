"""Runs the command lines of pages and helps as they are typed, while the site is built.

Those in cells run with their page; the others here, each page's in their order in a folder of its
own, behind what they speak of.  One that takes long is stopped as a person stops it, and has to end
as it then should.  Run:  python docs/lines.py [PAGE ...]
"""

import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from presswear.cli import COMMANDS
from presswear.cli.parser import parser_with

DOCS = Path(__file__).resolve().parent
ROOT = DOCS.parent
PAGES = sorted(
    page
    for page in [*ROOT.glob("*.md"), *DOCS.rglob("*.md")]
    if page.relative_to(ROOT).parts[1:2] != ("_build",)
)
LONGEST = 3.0
"""Time after which a command is stopped, s."""
LEFT = 60.0
"""Time that it then has to end, s."""
PAGES_AT_ONCE = 2
PATH = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
"""Where commands are looked for: in the environment that runs this, first."""
MADE = {
    "results/wear-times": "run wear-times --engine dae --cycles 4 --wear-updates 1",
    "results/mine": "run wear-times --engine dae --cycles 2 --wear-updates 1 --out results/mine",
    "results/long": "run wear-times --engine dae --cycles 2 --wear-updates 1 --out results/long",
    "results/press-blanking-life": "life press-blanking --engine dae --set replicates=2 "
    "--tolerance 1 --until 'C.depth > 0.01 um'",
    "results/clearances": "sweep wear-times --vary clearance=0.2mm,1.0mm --response A.force_max "
    "--set engine=dae --set cycles=2 --set wear_updates=0 --out results/clearances",
    "theirs.csv": "export results/mine theirs.csv",
    "my-press.toml": "new four-bar my-press.toml",
    "press.toml": "new press press.toml",
}
"""What lines speak of, by the command that makes a small one."""
WORN = ["joint,side,angle (deg),depth (um)", *(f"A,bearing,{10 * k},{k % 6}" for k in range(36))]
"""Lines of ``worn.csv``: a surface that somebody measured."""


def lines_of(text: str) -> Iterator[str]:
    """Command lines in blocks of code, each whole, comments and what comes before them left out."""
    joined = re.sub(r"\\\n\s*", " ", text)
    for line in joined.splitlines():
        for part in re.split(r"&&|\|\|", line.strip()):
            if found := re.match(r"(?:\S*/)?presswear (?=[a-z-])(.*)", part.strip()):
                yield found[1]


def lines_in_cells(text: str) -> list[str]:
    """The lines that run with their page."""
    cells = re.findall(r"^```\{code-cell\} ipython3\n%%bash\n(.*?)^```", text, re.M | re.S)
    return [line for cell in cells for line in lines_of(cell)]


def _failure(line: str, folder: Path, longest: float | None) -> str:
    """How a command fails, or nothing; after some time it is stopped by Ctrl-C."""
    with tempfile.TemporaryFile("w+") as said:
        running = subprocess.Popen(
            ["bash", "-c", f"exec presswear {line}"],
            cwd=folder,
            env={**os.environ, "HOME": str(folder), "PATH": PATH},
            stdin=subprocess.DEVNULL,
            stdout=said,
            stderr=subprocess.STDOUT,
        )
        allowed = {0}  # else stopped; while Python ends it is ended by the signal itself
        try:
            code = running.wait(longest)
        except subprocess.TimeoutExpired:
            running.send_signal(signal.SIGINT)
            allowed |= {128 + signal.SIGINT, -signal.SIGINT}
            try:
                code = running.wait(LEFT)
            except subprocess.TimeoutExpired:
                running.kill()
                code = running.wait()
        said.seek(0)
        return "" if code in allowed else f"presswear {line}: exit code {code}\n{said.read()}"


def lines_to_run(page: Path) -> list[str]:
    """The lines of a page that do not run with it."""
    text = page.read_text()
    of_cells = lines_in_cells(text)
    return [line for line in lines_of(text) if line not in of_cells]


def examples() -> list[str]:
    """The lines that the helps of commands give as examples."""
    parsers = parser_with(COMMANDS)[1].parsers.values()
    told = [parser.epilog.removeprefix("example: ") for parser in parsers if parser.epilog]
    return [line for epilog in told for own in epilog.split("; ") for line in lines_of(own)]


def _failures(made: Path, longest: float, place: str, lines: list[str]) -> list[str]:
    """How the lines of a place fail."""
    failed = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scenarios").symlink_to(ROOT / "scenarios")
        for line in lines:
            makes = line.startswith("new ") or ("--out" in line and "--resume" not in line)
            for thing in () if makes else [own for own in (*MADE, "worn.csv") if own in line]:
                copy = shutil.copytree if (made / thing).is_dir() else shutil.copy
                shutil.rmtree(folder / thing, ignore_errors=True)
                (folder / thing).parent.mkdir(exist_ok=True)
                copy(made / thing, folder / thing)
            if "DISPLAY" in os.environ or not _wants_window(line):
                failed.append(_failure(line, folder, longest))
    return [f"{place}: {own}" for own in failed if own]


def _wants_window(line: str) -> bool:
    is_replay = line.startswith("replay ") and not re.search("--(movie|still) ", line)
    return is_replay or "--live" in line


@contextmanager
def display() -> Iterator[None]:
    """A display that nobody looks at, where there is none and one can be had."""
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
    with os.fdopen(read) as told:
        os.environ["DISPLAY"] = f":{told.readline().strip()}"
    try:
        yield
    finally:
        del os.environ["DISPLAY"]
        server.kill()
        server.wait()


def all_lines() -> dict[str, list[str]]:
    """What there is to run, by the place where it stands."""
    places = {str(page.relative_to(ROOT)): lines_to_run(page) for page in PAGES}
    return {**places, "help": examples()}


def failures(places: dict[str, list[str]], longest: float = LONGEST) -> list[str]:
    """How commands fail, by the places where they stand."""
    named = " ".join(line for lines in places.values() for line in lines)
    cache = os.environ.get("XDG_CACHE_HOME", str(Path.home() / ".cache"))
    os.environ["XDG_CACHE_HOME"] = cache
    with tempfile.TemporaryDirectory() as name, display():
        made = Path(name)
        (made / "worn.csv").write_text("\n".join(WORN))
        needed = " ".join([named, *(line for thing, line in MADE.items() if thing in named)])
        not_made = [_failure(line, made, None) for thing, line in MADE.items() if thing in needed]
        if any(not_made):
            return [own for own in not_made if own]
        with ThreadPoolExecutor(PAGES_AT_ONCE) as threads:
            found = threads.map(partial(_failures, made, longest), places, places.values())
            return [own for page in found for own in page]


if __name__ == "__main__":
    wanted = sys.argv[1:] or all_lines()
    sys.exit("\n".join(failures({place: all_lines()[place] for place in wanted})))
