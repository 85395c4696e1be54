"""``presswear report``, ``export`` and ``replay``: results of a folder."""

import argparse
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console

from presswear.cli import dynamics, terminal
from presswear.cli.dynamics import is_diagram
from presswear.cli.terminal import load_result, print_lines
from presswear.tools.errors import InputError
from presswear.tools.files import check_ending, check_folder, write_whole
from presswear.tools.quantities import Quantity, parse_quantity

if TYPE_CHECKING:
    from presswear.show.replay.clip import Clip


def report(arguments: argparse.Namespace, console: Console) -> int:
    """Write the report of a stored run or sweep with all figures, or of two runs."""
    if arguments.second is not None:
        return _compare(arguments, console)
    if arguments.out is not None:
        raise InputError("--out needs two folders, which one page compares")
    check_folder(arguments.folder)
    is_pdf = arguments.format == "pdf"
    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        if is_pdf:
            raise InputError(f"--format pdf needs a run; {arguments.folder} is a sweep")
        if arguments.figures:
            raise InputError(f"--figures needs a run; {arguments.folder} is a sweep")
        return sweep.report(arguments, console)
    if is_diagram(arguments.folder):
        return dynamics.report(arguments, console)
    if arguments.limit:
        raise InputError(f"--limit needs a sweep; {arguments.folder} is a run")
    from presswear.show.report import write_report

    names = terminal.names_in(arguments.figures)
    result = load_result(arguments.folder, console)
    if is_pdf:
        from presswear.show.pdf import write_pdf

        file = write_pdf(result, extra_figures=names)
    else:
        file = write_report(result, extra_figures=names)
    print_lines(console, f"report in {file}")
    return 0


def _compare(arguments: argparse.Namespace, console: Console) -> int:
    """Write a page on two stored runs side by side."""
    first = arguments.folder
    second = arguments.second
    if arguments.limit or arguments.figures or arguments.format == "pdf":
        option = "--limit" if arguments.limit else "--figures"
        option = "--format pdf" if arguments.format == "pdf" else option
        raise InputError(f"{option} cannot be combined with two folders")
    for folder in (first, second):
        check_folder(folder)
        if (folder / "sweep.json").exists():
            raise InputError(f"{folder} is a sweep; two runs are compared")
    names = [folder.resolve().name for folder in (first, second)]
    file = arguments.out or Path(first.parent, f"{'-and-'.join(names)}.html")
    check_ending(file, ".html", option="--out")
    ours, theirs = (load_result(folder, console) for folder in (first, second))
    from presswear.show.comparison import write_comparison

    print_lines(console, f"report in {write_comparison(ours, theirs, file)}")
    return 0


def export(arguments: argparse.Namespace, console: Console) -> int:
    """Write stored results as tables for other programs."""
    from presswear.results.export import (
        cycles_table,
        life_table,
        strokes_table,
        table_of,
        write_table,
    )

    if (arguments.folder / "sweep.json").exists():
        from presswear.cli import sweep

        return sweep.export(arguments, console)
    if is_diagram(arguments.folder):
        return dynamics.export(arguments, console)
    result = load_result(arguments.folder, console)
    stage = arguments.stage
    if arguments.life:
        table = life_table(result)
    elif arguments.strokes:
        table = strokes_table(result, stage)
    elif arguments.cycles:
        table = cycles_table(result, stage)
    else:
        table = table_of(result, stage)
    write_table(arguments.file, table)
    rows = next(iter(table.values())).size
    source = "service life" if arguments.life else result.stage_name(stage)
    text = f"{source}: {rows} rows of {len(table)} columns in {arguments.file}"
    print_lines(console, text)
    return 0


def replay(arguments: argparse.Namespace, console: Console) -> int:
    """Play a stored run in Exudyn's renderer, or write it as a film or a picture."""
    check_folder(arguments.folder)
    still = arguments.still
    movie = arguments.movie
    if arguments.at is not None and still is None:
        raise InputError("--at needs --still; use --from and --to for a film")
    if arguments.life and (arguments.stage, arguments.compare) != (None, None):
        raise InputError(
            "--life shows all stages: it cannot be combined with --stage or --compare"
        )
    if still is not None:
        check_ending(still, ".png", option="--still")
    if movie is not None:
        kind = check_ending(movie, ".mp4", ".gif", option="--movie")
        if kind == ".mp4" and shutil.which("ffmpeg") is None:
            raise InputError(
                f"--movie {movie}: .mp4 needs ffmpeg; install it or write a .gif"
            )
    from presswear.show.replay.clip import equal_limits, life_clip

    if arguments.life:
        clips = [life_clip(load_result(arguments.folder, console))]
    else:
        clips = [_clip(arguments.folder, arguments.stage, console)]
    if arguments.compare is not None:
        folder = Path(arguments.compare)
        stage = arguments.stage
        # K or DIR:K
        if match := re.fullmatch(r"(?:(.+):)?([0-9]+)", arguments.compare):
            folder = Path(match[1] or arguments.folder)
            stage = int(match[2])
        clips = equal_limits([*clips, _clip(folder, stage, console)])
    if still is not None:
        return _still(arguments, console, clips)
    if movie is not None:
        return _movie(arguments, console, clips)
    from presswear.show.replay.output import play

    start = _time("--from", arguments.start, clips[0], clips[0].default_start)
    play(clips, arguments.size, start, arguments.slow or clips[0].default_slow)
    return 0


def _clip(folder: Path, stage: int | None, console: Console) -> "Clip":
    from presswear.show.replay.clip import stage_clip

    result = load_result(folder, console)
    last = len(result.stages) - 1
    if last < 0:
        raise InputError(f"{folder} has no finished stage")
    if stage is not None and stage > last:
        raise InputError(f"--stage {stage}: {folder} has stages 0 to {last}")
    return stage_clip(result, last if stage is None else stage)


def _time(flag: str, text: str | None, clip: "Clip", default: float) -> float:
    """Return a time within the clip, s; a number without unit is in seconds."""
    if text is None:
        return default
    is_number = re.fullmatch(r"[0-9.eE+-]+", text.strip())
    limits = Quantity("s", *clip.span, "", "")
    return float(parse_quantity(flag, f"{text}s" if is_number else text, limits))


def _still(arguments: argparse.Namespace, console: Console, clips: "list[Clip]") -> int:
    from PIL import Image

    from presswear.show.replay.clip import frames_at
    from presswear.show.replay.output import still

    time = _time("--at", arguments.at, clips[0], clips[0].default_start)
    pixels = still(clips, frames_at(clips, time), arguments.size)
    write_whole(
        arguments.still, lambda file: Image.fromarray(pixels).save(file, format="png")
    )
    print_lines(console, f"picture in {arguments.still}")
    return 0


def _movie(arguments: argparse.Namespace, console: Console, clips: "list[Clip]") -> int:
    from presswear.show.replay.clip import frames_between, speed_text
    from presswear.show.replay.output import pictures, write_movie

    clip = clips[0]
    rate = arguments.rate
    start = _time("--from", arguments.start, clip, clip.default_start)
    duration = clip.period * len(clip.chapters)
    _, last = clip.span
    end = _time("--to", arguments.end, clip, min(start + duration, last))
    if end <= start:
        raise InputError(f"--to {end:g} s: must be after --from, {start:g} s")
    slow = arguments.slow or clip.default_slow
    frames = frames_between(clips, start, end, slow, rate)
    count = len(frames)
    note = speed_text(slow)
    with terminal.progress_bar(console) as bar:
        images = pictures(clips, frames, note, arguments.size)
        tracked = bar.track(images, total=count, description=f"{count} pictures")
        write_movie(arguments.movie, iter(tracked), rate)
    print_lines(
        console,
        f"film in {arguments.movie}: {count} pictures, {count / rate:.1f} s, {note}",
    )
    return 0
