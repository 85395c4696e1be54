"""Parts that commands share: scenes and settings, folders, tables, progress and logging."""

import logging
import shlex
import sys
import textwrap
from argparse import Namespace
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import chain, count, takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE
from rich.console import Console
from rich.progress import (
    BarColumn,
    Progress,
    ProgressColumn,
    Task,
    TaskProgressColumn,
    TextColumn,
)
from rich.table import Column, Table
from rich.text import Text

from presswear.scene.catalog import SCENES, scene_named
from presswear.scene.files import EXAMPLES, SUFFIX, scene_from
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.errors import InputError, KernelError, RunFailed, printable
from presswear.tools.files import check_folder
from presswear.tools.numbers import duration_text
from presswear.tools.processes import check_stopped, is_stopped

if TYPE_CHECKING:
    from presswear.results.result import Result

MIN_BAR = 12  # width of a progress bar, characters
MIN_SHARE = 0.02  # share of a task after which the time left is estimated


def parse_settings(items: Iterable[str]) -> dict[str, str]:
    """Return the values of ``--set KEY=VALUE`` options by key."""
    settings: dict[str, str] = {}
    for item in items:
        key, equals, value = map(str.strip, item.partition("="))
        if not equals:
            raise InputError(f"--set {item}: expected KEY=VALUE")
        if key in settings:
            raise InputError(f"--set {key} is given twice")
        settings[key] = value
    return settings


def load_scene(name: str) -> Scene:
    """Return a named scene, or the scene of a file or of a result folder."""
    if (Path(name) / "result.json").exists():
        from presswear.results.result import stored_scene

        scene, *_ = stored_scene(Path(name))
        return scene
    if name.endswith(SUFFIX):
        return scene_from(Path(name))
    if name.endswith(".py"):
        raise InputError(
            f"{name} is a Python script; run it with: python {shlex.quote(name)}"
        )
    if name in EXAMPLES and name not in SCENES:
        raise InputError(
            f"{name} is a mechanism; write a file of it with: presswear new {name}"
        )
    if Path(name).suffix[1:].isalpha() or Path(name).exists():
        expected = f"a scene of presswear list, a file NAME{SUFFIX}, or a result folder"
        raise InputError(f"{name}: expected {expected}")
    return scene_named(name)


def requested_scene(arguments: Namespace) -> Scene:
    """Return the scene with the settings of ``--set``, checked."""
    scene = changed(load_scene(arguments.scene), parse_settings(arguments.set))
    scene.check()
    return scene


def merge_options(
    settings: Mapping[str, str], options: Mapping[str, Any]
) -> dict[str, str]:
    """Return the settings of ``--set`` and of options; an option of None is not set.

    Raises InputError if an option and ``--set`` set different values.
    """
    merged = dict(settings)
    for key, value in options.items():
        if value is None:
            continue
        if merged.get(key, value) != value:
            flag = key.rpartition(".")[2].replace("_", "-")
            raise InputError(f"--{flag} and --set {key} cannot be combined")
        merged[key] = value
    return merged


def _folders(name: str) -> Iterator[Path]:
    """Yield results/NAME, results/NAME-2, -3, ... in which runs of a name are stored."""
    names = chain([name], (f"{name}-{number}" for number in count(2)))
    return map(Path("results").joinpath, names)


def free_folder(name: str) -> Path:
    """Return the first folder of a name that does not exist."""
    return next(path for path in _folders(name) if not path.exists())


def unfinished_folder(name: str) -> Path | None:
    """Return the last folder of a name, if it holds an unfinished run."""
    from presswear.results.folder import FINISHED, read_stored

    existing = list(takewhile(Path.exists, _folders(name)))
    if not existing:
        return None
    try:
        is_finished = read_stored(existing[-1]).status in FINISHED
    except InputError:  # it holds something else
        return None
    return None if is_finished else existing[-1]


def check_resume(resume: bool, path: Path | None) -> None:
    """Raise InputError if ``--resume`` has no folder, or one that does not exist."""
    if not resume:
        return
    if path is None:
        raise InputError("--resume needs the folder to continue in: --out DIR")
    try:
        check_folder(path)
    except InputError as error:
        raise InputError(
            f"--resume --out {error}; omit --resume to start a new run"
        ) from None


def output_folder(arguments: Namespace, name: str) -> Path:
    """Return the folder of ``--out``, or a free one; raise InputError if it may not be written."""
    check_resume(arguments.resume, arguments.out)
    folder: Path = arguments.out or free_folder(name)
    if not arguments.resume and folder.exists() and any(folder.iterdir()):
        raise InputError(
            f"--out {folder}: it is not empty; name a new folder, or add --resume"
        )
    return folder


def resume_command(arguments: Namespace, path: Path, scene: Scene) -> str:
    """Return the command that continues a run, or a sweep, of a scene in a folder."""
    flag = " --trust" if scene.user_laws else ""
    words = shlex.join(
        [arguments.command, arguments.scene, "--resume", "--out", str(path)]
    )
    return f"continue with: presswear {words}{flag}"


@contextmanager
def resumable(command: str, path: Path, stored: Callable[[], str]) -> Iterator[None]:
    """Add the command that continues a run to the message of a failure or an interrupt.

    ``stored`` returns what is stored, in words.
    """
    try:
        yield
    except KernelError:
        raise
    except RunFailed as error:
        message = f"{error}; {command}" if path.exists() else f"{error}"
        raise RunFailed(message) from error
    except BaseException as error:
        if not isinstance(error, KeyboardInterrupt) and not is_stopped():
            raise
        state = f"{stored()}; {command}" if path.exists() else "nothing was started"
        raise KeyboardInterrupt(f"interrupted; {state}") from None


def load_result(path: Path, console: Console) -> "Result":
    """Return a stored run; print a note if it is incomplete, or raise InputError if it is empty."""
    from presswear.results.result import load, unfinished

    check_folder(path)
    result = load(path)
    note = unfinished(result)
    if note and not result.stages and result.life is None:
        arguments = Namespace(command="run", scene=str(path))
        raise InputError(f"{note}; {resume_command(arguments, path, result.scene)}")
    if note:
        print_lines(console, f"{note}: only these are used")
    return result


def names_in(text: str) -> list[str]:
    """Return the names in a text that are separated by commas."""
    return [name.strip() for name in text.split(",") if name.strip()]


def print_lines(console: Console, *lines: str) -> None:
    """Print lines without colours or markup; they wrap in a terminal.

    Texts of a result may come from anybody: control characters are printed as escapes.
    """
    for line in map(printable, lines):
        indent = line[: len(line) - len(line.lstrip())] + "  "
        wrapped = textwrap.wrap(
            line,
            console.width,
            subsequent_indent=indent,
            break_long_words=False,
            break_on_hyphens=False,
        )
        printed = wrapped if console.is_terminal else [line]
        for text in printed:
            console.print(text, highlight=False, markup=False, soft_wrap=True)


def print_table(
    console: Console,
    heads: Sequence[str],
    rows: Iterable[Sequence[Any]],
    title: str = "",
) -> None:
    """Print a table with columns of texts, which wrap, and of numbers, aligned to the right.

    The heading of a column of numbers begins with ``>``, which is not printed.
    """
    table = Table(box=SIMPLE, pad_edge=False, title=title or None, title_justify="left")
    for head in heads:
        if head.startswith(">"):
            table.add_column(head[1:], justify="right", no_wrap=True)
        else:
            table.add_column(head, overflow="fold")
    for row in rows:
        cells = []
        for cell in row:
            cells.append(Text(printable(cell)) if isinstance(cell, str) else cell)
        table.add_row(*cells)
    console.print(table, highlight=False)


def verdict(passed: bool) -> Text:
    """Return ``pass``, or ``MISS`` in red."""
    return Text("pass") if passed else Text("MISS", "bold red")


class _TimeLeft(ProgressColumn):
    """Time left at the mean speed so far.

    Fields of the task: ``idle`` is the time spent on compilation, s; ``share`` is the
    latest estimate of the completed share; ``start`` is the share that was completed
    before the run was resumed.
    """

    def render(self, task: Task) -> Text:
        """Return the time in words."""
        return Text(time_left(task))


def time_left(task: Task) -> str:
    """Return the time left in words, or "" before ``MIN_SHARE``."""
    share = task.fields.get("share", task.percentage / 100.0)
    completed = share - task.fields.get("start", 0.0)
    # The first comparison is false for NaN.
    if not completed >= MIN_SHARE or share >= 1.0 or task.elapsed is None:
        return ""
    working_time = task.elapsed - task.fields.get("idle", 0.0)
    seconds = working_time * (1.0 - share) / completed
    return f"{duration_text(round(max(seconds, 0.0)))} left"


def progress_bar(console: Console) -> Progress:
    """Return a progress bar with the time left; silent without a terminal."""
    words = Column(ratio=1, overflow="fold")
    return Progress(
        TextColumn("{task.description}", markup=False, table_column=words),
        BarColumn(None, table_column=Column(min_width=MIN_BAR, max_width=MIN_BAR)),
        TaskProgressColumn(table_column=Column(no_wrap=True)),
        _TimeLeft(Column(no_wrap=True)),
        console=console,
        disable=not console.is_terminal,
        expand=True,
    )


@contextmanager
def named_progress(
    console: Console, name: str
) -> Iterator[Callable[[str, float], None]]:
    """Show a progress bar; yield a function of the present step and the completed share.

    It raises KeyboardInterrupt after a signal.
    """
    with progress_bar(console) as bar:
        task = bar.add_task(name, total=1.0)

        def report(step: str, share: float) -> None:
            check_stopped()
            bar.update(task, description=step, completed=share)

        yield report


@contextmanager
def resumable_steps(
    console: Console, name: str, path: Path, stored: str
) -> Iterator[Callable[[str, float], None]]:
    """Show a progress bar of a command that ``--resume`` continues; see ``named_progress``."""
    command = f"the same command with --resume --out {path} continues"
    with (
        resumable(command, path, lambda: stored),
        named_progress(console, name) as report,
    ):
        yield report


class _StandardError(logging.Handler):
    """Handler that looks up ``sys.stderr`` each time, because a progress bar replaces it."""

    def emit(self, record: logging.LogRecord) -> None:
        print(self.format(record), file=sys.stderr)


@contextmanager
def logging_to_stderr(is_verbose: bool) -> Iterator[None]:
    """Log to standard error: each step if ``is_verbose``, else warnings only."""
    logger = logging.getLogger("presswear")
    handler = _StandardError()
    line = "%(asctime)s %(name)s: %(message)s" if is_verbose else "warning: %(message)s"
    handler.setFormatter(logging.Formatter(line, "%H:%M:%S"))
    level = logger.level
    logger.addHandler(handler)
    if is_verbose:
        logger.setLevel(logging.INFO)
    try:
        yield
    finally:
        logger.setLevel(level)
        logger.removeHandler(handler)
