"""Parts that the commands share: progress, tables, folders, and options read from text."""

import math
import shlex
import time as clock
from argparse import ArgumentTypeError
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE
from rich.console import Console
from rich.markup import escape
from rich.progress import (
    BarColumn,
    Progress,
    TaskProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)
from rich.table import Column, Table

from presswear.scene.catalog import scene_named
from presswear.scene.files import SUFFIX, scene_from
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import check_folder
from presswear.tools.numbers import lasting
from presswear.tools.processes import is_stopped
from presswear.tools.quantities import Quantity, parse_quantity

if TYPE_CHECKING:
    from presswear.results.result import Result

_ANY = Quantity("", -math.inf, math.inf, "", "")

_LEAST_BAR = 8
"""Characters."""
_WIDE = 70
"""Characters of a terminal from which on the time passed is shown as well."""
_SHOWS = 5.0
"""Time after which it shows how long something takes, s."""
_LONG = 30.0
"""Time that is worth a word, s."""
LONGEST = 86400.0
"""Time that an option may say, s: a day."""


def add_out(parser: Any, name: str) -> None:
    """Add the option ``--out``, of results/NAME where nothing is said."""
    parser.add_argument("--out", type=folder_given, help=f"new folder (default results/{name})")


def add_settings(parser: Any) -> None:
    """Add the option ``--set`` to a command that is not ``run``."""
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="as in presswear run"
    )


def add_limits(parser: Any) -> None:
    """Add the option ``--limit``."""
    parser.add_argument(
        "--limit",
        action="append",
        metavar="RESPONSE>=VALUE",
        help="lower or upper limit on a response of a sweep, such as 'life>=2e6' or "
        "'A.force_max<=15kN': the report estimates how often it is violated; repeatable",
    )


def add_trust(parser: Any) -> None:
    """Add the option ``--trust``."""
    parser.add_argument(
        "--trust",
        action="store_true",
        help="with --resume: execute the Python source code of user laws that is stored in --out",
    )


def add_where(parser: Any, of: str = "") -> None:
    """Add the options ``--on`` and ``--shard``, which say what does the runs of many scenes."""
    parser.add_argument(
        "--on",
        default="",
        metavar="WHERE",
        help=f"{of}dask (a local cluster), dask://HOST:PORT, or MODULE:FACTORY, which gives a "
        "concurrent.futures.Executor (default: the cores of this machine)",
    )
    parser.add_argument(
        "--shard",
        metavar="K/N",
        help=f"{of}every N-th run from the K-th, for one job of an array",
    )


def settings_given(items: list[str]) -> dict[str, str]:
    """Read the options ``--set``, by key."""
    settings: dict[str, str] = {}
    for item in items:
        key, equals, value = item.partition("=")
        if not equals:
            raise InputError(f"--set {item}: KEY=VALUE is expected")
        if key.strip() in settings:
            raise InputError(f"--set {key.strip()} is given twice")
        settings[key.strip()] = value.strip()
    return settings


def scene_given(name: str) -> Scene:
    """A scene by its name or from a file; InputError lists the names."""
    if name.endswith(SUFFIX):
        return scene_from(Path(name))
    return scene_named(name)


def count_given(option: str, text: str, most: int) -> int:
    """A whole number from 1 that an option says."""
    few = text.isascii() and text.isdigit() and len(text) <= len(f"{most}")
    if not (few and 1 <= int(text) <= most):
        raise InputError(f"{option} {text}: a whole number from 1 to {most} is expected")
    return int(text)


def repeats_given(text: str) -> int:
    """Read the option ``--repeats``."""
    return count_given("--repeats", text, 1000)


def jobs_given(text: str | None) -> int | None:
    """Read the option ``--jobs``; None where it is not given."""
    return None if text is None else count_given("--jobs", text, 256)


def seconds_given(option: str, text: str) -> float:
    """A time in seconds that an option says."""
    try:
        seconds = float(text)
    except ValueError:
        seconds = -1.0
    if not 0.0 <= seconds <= LONGEST:
        raise InputError(f"{option} {text}: a number of seconds from 0 to {LONGEST:g} is expected")
    return seconds


def number_given(text: str) -> float:
    """A finite number that an option says, in digits as they are typed everywhere."""
    try:
        value = parse_quantity("", text, _ANY)
    except InputError:
        raise ArgumentTypeError(f"{text!r}: a finite number is expected") from None
    return float(value)


def place_given(text: str) -> int:
    """A count from 0 that an option says."""
    if not (text.isascii() and text.isdigit() and len(text) < 10):
        raise ArgumentTypeError(f"{text!r}: a whole number from 0 is expected")
    return int(text)


def folder_given(text: str) -> Path:
    """Read the option ``--out``; nothing is no name, not the folder that one is in."""
    if not text.strip():
        raise ArgumentTypeError("a name is expected")
    return Path(text)


def check_resumed(resume: bool, folder: Path | None) -> None:
    """InputError where a folder to go on in is not named, or not there."""
    if not resume:
        return
    if folder is None:
        raise InputError("--resume needs the folder to go on in: --out DIR")
    try:
        check_folder(folder)
    except InputError as error:
        raise InputError(f"--resume --out {error}; without --resume a new one is begun") from None


def free_folder(name: str) -> Path:
    """results/NAME, or the first of results/NAME-2, -3 ... that is free."""
    base = Path("results") / name
    folder, number = base, 1
    while folder.exists():
        number += 1
        folder = base.with_name(f"{base.name}-{number}")
    return folder


def progress_bar(console: Console) -> Progress:
    """Progress with times passed and left; silent where there is no terminal.

    Where it is narrow the words give way: bar and time left stay.
    """
    words = Column(ratio=3, no_wrap=True, overflow="ellipsis")
    columns = (
        TextColumn("{task.description}", table_column=words),
        BarColumn(None, table_column=Column(ratio=2, min_width=_LEAST_BAR)),
        TaskProgressColumn(table_column=Column(no_wrap=True)),
        *([TimeElapsedColumn(Column(no_wrap=True))] if console.width >= _WIDE else []),
        TextColumn("left", table_column=Column(no_wrap=True)),
        TimeRemainingColumn(table_column=Column(no_wrap=True)),
    )
    return Progress(*columns, console=console, disable=not console.is_terminal, expand=True)


class Foretold:
    """Says once, as soon as that shows, how long something takes; short things are not told of.

    Parameters
    ----------
    say : callable
        Told the words.
    what, more : str
        What takes it, and what stands behind the time.
    """

    def __init__(self, say: Callable[[str], None], what: str, more: str = "") -> None:
        self._say: Callable[[str], None] | None = say
        self._what, self._more = what, more
        self._began: tuple[float, float] | None = None

    def wait(self) -> None:
        """Take what follows for no progress, until it is heard again."""
        self._began = None

    def hear(self, part: float) -> None:
        """Hear the part of the whole, 0 .. 1, that is done."""
        now = clock.perf_counter()
        if self._began is None:
            self._began = now, part
        since, first = self._began
        if self._say is None or now - since < _SHOWS or part <= first:
            return
        left = (now - since) * (1.0 - first) / (part - first)
        if left >= _LONG:
            self._say(f"{self._what} takes about {lasting(left)}{self._more}")
        self._say = None


def print_table(
    console: Console,
    texts: Sequence[str],
    numbers: Sequence[str],
    rows: Iterable[Sequence[str]],
    more: Sequence[str] = (),
    **look: Any,
) -> None:
    """A table: columns that fold, then numbers to the right, then further texts.

    Parameters
    ----------
    texts, numbers, more : sequence of str
        Names of the columns.
    rows : iterable of sequence of str
        Cells in the order of the columns; rich's markup is kept in those behind the
        numbers only.
    look
        Changes rich's table.
    """
    table = Table(box=SIMPLE, pad_edge=False, **look)
    for name in texts:
        table.add_column(name, overflow="fold")
    for name in numbers:
        table.add_column(name, justify="right", no_wrap=True)
    for name in more:
        table.add_column(name)
    plain = len(texts) + len(numbers)
    for row in rows:
        table.add_row(*(escape(cell) for cell in row[:plain]), *row[plain:])
    console.print(table, highlight=False)


def verdict(passed: bool) -> str:
    """Pass or miss, in rich's markup."""
    return "pass" if passed else "[bold red]MISS[/]"


def finished_part(path: Path, console: Console) -> "Result":
    """A stored run, with a word on one that has not come to its end; something must be stored."""
    from presswear.results.result import load, unfinished

    check_folder(path)
    result = load(path)
    words = unfinished(result)
    if words and not result.stages:
        scene = result.scene
        raise InputError(f"{words}; {go_on_with(scene.name, path, trust=bool(scene.user_laws))}")
    if words:
        console.print(f"{words}: what follows is of these", highlight=False, soft_wrap=True)
    return result


@contextmanager
def goes_on(go_on: str, folder: Path, kept: Callable[[], str]) -> Iterator[None]:
    """Name the command that goes on with what is stopped or fails inside.

    Parameters
    ----------
    kept : callable
        Tells what is kept.
    """
    try:
        yield
    except RunFailed as error:
        raise RunFailed(f"{error}; {go_on}" if folder.exists() else f"{error}") from error
    except BaseException as error:
        if not isinstance(error, KeyboardInterrupt) and not is_stopped():
            raise
        told = f"{kept()}; {go_on}" if folder.exists() else "nothing had begun"
        raise KeyboardInterrupt(f"interrupted; {told}") from None


def go_on_with(name: str, folder: Path, command: str = "run", trust: bool = False) -> str:
    """The command that goes on with a run."""
    out = f"{shlex.quote(str(folder))}{' --trust' if trust else ''}"
    return f"go on with: presswear {command} {name} --resume --out {out}"
