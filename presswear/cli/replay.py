"""``presswear replay``: a stored run in the Exudyn renderer."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from presswear.cli.terminal import finished_part, progress_bar
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder
from presswear.tools.quantities import Quantity, parse_quantity

if TYPE_CHECKING:
    from presswear.show.replay.clip import Clip

_SIZES = (160, 4096)
"""Least and greatest width or height, pixels."""


def add(commands: Any) -> None:
    """Add the parser of ``replay``."""
    parser = commands.add_parser(
        "replay",
        description="Plays a stored run in the Exudyn renderer: the press, and its clearance "
        "joints enlarged. Keys in the window: space pauses, left and right step, up and down "
        "change the speed, home begins again, q quits; a click on the bar jumps in time.",
        epilog="example: presswear replay results/wear-times --stage 1 --movie press.gif; "
        "presswear replay results/wear-times --still press.png --at 0.31s",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a run")
    parser.add_argument("--stage", metavar="K", help="0 unworn, 1 after the first wear, ...")
    parser.add_argument(
        "--compare", metavar="WHAT", help="beside it: another stage, 1, or folder, or DIR:STAGE"
    )
    parser.add_argument(
        "--life", action="store_true", help="through a life: the last cycle of each stage in turn"
    )
    parser.add_argument("--movie", type=Path, metavar="FILE", help="write a film, .mp4 or .gif")
    parser.add_argument("--still", type=Path, metavar="FILE", help="write one picture, .png")
    parser.add_argument("--at", metavar="T", help="time of the still, for instance 0.31s")
    parser.add_argument(
        "--from", dest="start", metavar="T", help="where a film begins (default: second cycle)"
    )
    parser.add_argument(
        "--to", dest="end", metavar="T", help="where it ends (default: one cycle of each stage)"
    )
    parser.add_argument("--slow", metavar="N", help="times slower (default: a cycle in 10 s)")
    parser.add_argument("--rate", default="25", metavar="N", help="pictures a second (25)")
    parser.add_argument("--size", default="960x640", metavar="WxH", help="pixels (960x640)")
    parser.set_defaults(run=_run)


def _run(arguments: argparse.Namespace, console: Console) -> int:
    check_folder(arguments.folder)
    size = _size(arguments.size)
    _check(arguments)
    reels = [_first(arguments, console)]
    if arguments.compare is not None:
        from presswear.show.replay.clip import equal_limits

        reels = equal_limits([*reels, _compared(arguments, console)])
    if arguments.still is not None:
        return _still(arguments, console, reels, size)
    if arguments.movie is not None:
        return _movie(arguments, console, reels, size)
    return _window(arguments, reels, size)


def _check(arguments: argparse.Namespace) -> None:
    """InputError where options contradict each other or a file cannot be written."""
    if arguments.still is not None and arguments.movie is not None:
        raise InputError("--still and --movie are two calls: give one of them")
    if arguments.at is not None and arguments.still is None:
        raise InputError("--at is the time of a --still; a film has --from and --to")
    if arguments.life and (arguments.stage, arguments.compare) != (None, None):
        raise InputError("--life goes through all stages: give no --stage and no --compare")
    if arguments.still is not None and arguments.still.suffix.lower() != ".png":
        raise InputError(f"--still {arguments.still}: the name must end in .png")
    for file in (arguments.still, arguments.movie):
        if file is None:
            continue
        if file.is_dir():
            raise InputError(f"{file} is a folder; name a file")
        if not file.parent.is_dir():
            raise InputError(f"{file}: there is no folder {file.parent}")
    if arguments.movie is not None:
        from presswear.show.replay.output import check_movie

        check_movie(arguments.movie)


def _first(arguments: argparse.Namespace, console: Console) -> "Clip":
    if not arguments.life:
        return _reel(arguments.folder, arguments.stage, console)
    from presswear.show.replay.clip import life_clip

    return life_clip(finished_part(arguments.folder, console))


def _reel(folder: Path, stage: str | None, console: Console) -> "Clip":
    from presswear.show.replay.clip import stage_clip

    result = finished_part(folder, console)
    last = len(result.stages) - 1
    if last < 0:
        raise InputError(f"{folder} has no finished stage")
    if stage is None:
        return stage_clip(result, last)
    if not (stage.isascii() and stage.isdigit() and int(stage) <= last):
        raise InputError(f"--stage {stage}: {folder} has stages 0 to {last}")
    return stage_clip(result, int(stage))


def _compared(arguments: argparse.Namespace, console: Console) -> "Clip":
    """The reel that stands beside the first."""
    what: str = arguments.compare
    if what.isascii() and what.isdigit():
        return _reel(arguments.folder, what, console)
    folder, colon, stage = what.rpartition(":")
    if colon and stage.isascii() and stage.isdigit():
        return _reel(Path(folder), stage, console)
    return _reel(Path(what), arguments.stage, console)


def _time(option: str, text: str | None, reel: "Clip", otherwise: float) -> float:
    """The time within a film that an option says, s, if it does; a bare number is in seconds."""
    if text is None:
        return otherwise
    first, last = reel.span
    bare = re.fullmatch(r"[0-9.eE+-]+", text.strip())
    return float(
        parse_quantity(option, f"{text}s" if bare else text, Quantity("s", first, last, "", ""))
    )


def _size(text: str) -> tuple[int, int]:
    low, high = _SIZES
    match = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", text)
    if match is None or not all(low <= int(part) <= high for part in match.groups()):
        raise InputError(f"--size {text}: WIDTHxHEIGHT is expected, each {low} to {high} pixels")
    return int(match[1]), int(match[2])


def _still(
    arguments: argparse.Namespace, console: Console, reels: "list[Clip]", size: tuple[int, int]
) -> int:
    from presswear.show.replay.clip import frames_at
    from presswear.show.replay.output import still, write_still

    time = _time("--at", arguments.at, reels[0], reels[0].default_start)
    write_still(arguments.still, still(reels, frames_at(reels, time), size))
    console.print(f"picture in {arguments.still}", highlight=False)
    return 0


def _movie(
    arguments: argparse.Namespace, console: Console, reels: "list[Clip]", size: tuple[int, int]
) -> int:
    from presswear.show.replay.clip import frames_between, speed_text
    from presswear.show.replay.output import pictures, write_movie

    first = reels[0]
    start = _time("--from", arguments.start, first, first.default_start)
    whole = first.period * len(first.chapters)
    end = _time("--to", arguments.end, first, min(start + whole, first.span[1]))
    if end <= start:
        raise InputError(f"--to {end:g} s: it must be after --from, {start:g} s")
    slowed = _slowed(arguments, first)
    rate = float(parse_quantity("--rate", arguments.rate, Quantity("", 1.0, 60.0, "", "")))
    frames = frames_between(reels, start, end, slowed, rate)
    count, note = len(frames), speed_text(slowed)
    with progress_bar(console) as bar:
        task = bar.add_task(f"{count} pictures", total=1.0)
        images = pictures(reels, frames, note, size)
        write_movie(
            arguments.movie, images, count, rate, lambda part: bar.update(task, completed=part)
        )
    console.print(
        f"film in {arguments.movie}: {count} pictures, {count / rate:.1f} s, {note}",
        highlight=False,
    )
    return 0


def _slowed(arguments: argparse.Namespace, reel: "Clip") -> float:
    if arguments.slow is None:
        return reel.default_slow
    return float(parse_quantity("--slow", arguments.slow, Quantity("", 0.01, 1e5, "", "")))


def _window(arguments: argparse.Namespace, reels: "list[Clip]", size: tuple[int, int]) -> int:
    from presswear.show.replay.output import check_display, play

    check_display()
    first = reels[0]
    start = _time("--from", arguments.start, first, first.default_start)
    play(reels, size, start, _slowed(arguments, first))
    return 0
