"""``presswear replay``: a stored run in Exudyn's renderer."""

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rich.console import Console

from presswear.cli.parser import integer, number
from presswear.cli.terminal import load_result, print_lines, progress_bar
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder
from presswear.tools.quantities import Quantity, parse_quantity

if TYPE_CHECKING:
    from presswear.show.replay.clip import Clip

MIN_SIZE, MAX_SIZE = 160, 4096  # width and height, pixels


def add(commands: Any) -> None:
    """Add the parser of ``replay``."""
    parser = commands.add_parser(
        "replay",
        description="Plays a stored run in Exudyn's renderer: the mechanism, and its clearance "
        "joints enlarged. Keys in the window: space pauses, left and right step, up and down "
        "change the speed, home and end go to the ends, q quits; a click on the time bar jumps.",
        epilog="example: presswear replay results/wear-times --stage 1 --movie press.gif; "
        "presswear replay results/wear-times --still press.png --at 0.31s",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of a run")
    parser.add_argument(
        "--stage",
        type=integer(0),
        metavar="K",
        help="0 unworn, 1 after the first wear update, ... (default: the last)",
    )
    parser.add_argument(
        "--compare",
        metavar="K|DIR|DIR:K",
        help="show another stage, or a stage of another run, beside it",
    )
    parser.add_argument(
        "--life", action="store_true", help="last cycle of each stage through a service life"
    )
    parser.add_argument("--movie", type=Path, metavar="FILE", help="write a film, .mp4 or .gif")
    parser.add_argument("--still", type=Path, metavar="FILE", help="write one picture, .png")
    parser.add_argument("--at", metavar="TIME", help="time of the picture, such as 0.31s")
    parser.add_argument(
        "--from", dest="start", metavar="TIME", help="start of the film (default: second cycle)"
    )
    parser.add_argument(
        "--to", dest="end", metavar="TIME", help="end of the film (default: after one cycle)"
    )
    parser.add_argument(
        "--slow",
        type=number(0.01, 1e5),
        metavar="N",
        help="times slower than real speed (default: a cycle in 10 s)",
    )
    parser.add_argument(
        "--rate", type=number(1.0, 60.0), default=25.0, metavar="N", help="pictures per second (25)"
    )
    parser.add_argument(
        "--size", type=_size, default=(960, 640), metavar="WxH", help="pixels (960x640)"
    )
    parser.set_defaults(run=_run)


def _size(text: str) -> tuple[int, int]:
    match = re.fullmatch(r"([0-9]{1,5})x([0-9]{1,5})", text)
    if match is None or not all(MIN_SIZE <= int(part) <= MAX_SIZE for part in match.groups()):
        raise argparse.ArgumentTypeError(
            f"{text[:80]}: must be WIDTHxHEIGHT, each {MIN_SIZE} to {MAX_SIZE} pixels"
        )
    return int(match[1]), int(match[2])


def _run(arguments: argparse.Namespace, console: Console) -> int:
    check_folder(arguments.folder)
    _check(arguments)
    from presswear.show.replay.clip import equal_limits, life_clip

    if arguments.life:
        clips = [life_clip(load_result(arguments.folder, console))]
    else:
        clips = [_clip(arguments.folder, arguments.stage, console)]
    if arguments.compare is not None:
        clips = equal_limits([*clips, _compared(arguments, console)])
    if arguments.still is not None:
        return _still(arguments, console, clips)
    if arguments.movie is not None:
        return _movie(arguments, console, clips)
    from presswear.show.replay.output import check_display, play

    check_display()
    start = _time("--from", arguments.start, clips[0], clips[0].default_start)
    play(clips, arguments.size, start, arguments.slow or clips[0].default_slow)
    return 0


def _check(arguments: argparse.Namespace) -> None:
    """Raise InputError for options that cannot be combined and files that cannot be written."""
    if arguments.still is not None and arguments.movie is not None:
        raise InputError("--still and --movie cannot be combined")
    if arguments.at is not None and arguments.still is None:
        raise InputError("--at needs --still; use --from and --to for a film")
    if arguments.life and (arguments.stage, arguments.compare) != (None, None):
        raise InputError("--life shows all stages: it cannot be combined with --stage or --compare")
    if arguments.still is not None and arguments.still.suffix.lower() != ".png":
        raise InputError(f"--still {arguments.still}: the name must end in .png")
    for file in (arguments.still, arguments.movie):
        if file is not None and file.is_dir():
            raise InputError(f"{file} is a folder; name a file")
        if file is not None and not file.parent.is_dir():
            raise InputError(f"{file}: there is no folder {file.parent}")
    if arguments.movie is not None:
        from presswear.show.replay.output import check_movie

        check_movie(arguments.movie)


def _clip(folder: Path, stage: int | None, console: Console) -> "Clip":
    from presswear.show.replay.clip import stage_clip

    result = load_result(folder, console)
    last = len(result.stages) - 1
    if last < 0:
        raise InputError(f"{folder} has no finished stage")
    if stage is not None and stage > last:
        raise InputError(f"--stage {stage}: {folder} has stages 0 to {last}")
    return stage_clip(result, last if stage is None else stage)


def _compared(arguments: argparse.Namespace, console: Console) -> "Clip":
    """Return the clip that is shown beside the first."""
    text: str = arguments.compare
    if text.isascii() and text.isdigit():
        return _clip(arguments.folder, int(text), console)
    folder, colon, stage = text.rpartition(":")
    if colon and stage.isascii() and stage.isdigit():
        return _clip(Path(folder), int(stage), console)
    return _clip(Path(text), arguments.stage, console)


def _time(flag: str, text: str | None, clip: "Clip", default: float) -> float:
    """Return a time within the clip, s; a number without unit is in seconds."""
    if text is None:
        return default
    is_number = re.fullmatch(r"[0-9.eE+-]+", text.strip())
    limits = Quantity("s", *clip.span, "", "")
    return float(parse_quantity(flag, f"{text}s" if is_number else text, limits))


def _still(arguments: argparse.Namespace, console: Console, clips: "list[Clip]") -> int:
    from presswear.show.replay.clip import frames_at
    from presswear.show.replay.output import still, write_still

    time = _time("--at", arguments.at, clips[0], clips[0].default_start)
    write_still(arguments.still, still(clips, frames_at(clips, time), arguments.size))
    print_lines(console, f"picture in {arguments.still}")
    return 0


def _movie(arguments: argparse.Namespace, console: Console, clips: "list[Clip]") -> int:
    from presswear.show.replay.clip import frames_between, speed_text
    from presswear.show.replay.output import pictures, write_movie

    clip, rate = clips[0], arguments.rate
    start = _time("--from", arguments.start, clip, clip.default_start)
    whole = clip.period * len(clip.chapters)
    end = _time("--to", arguments.end, clip, min(start + whole, clip.span[1]))
    if end <= start:
        raise InputError(f"--to {end:g} s: must be after --from, {start:g} s")
    slow = arguments.slow or clip.default_slow
    frames = frames_between(clips, start, end, slow, rate)
    count, note = len(frames), speed_text(slow)
    with progress_bar(console) as bar:
        task = bar.add_task(f"{count} pictures", total=1.0)
        images = pictures(clips, frames, note, arguments.size)
        write_movie(
            arguments.movie, images, count, rate, lambda part: bar.update(task, completed=part)
        )
    seconds = count / rate
    print_lines(console, f"film in {arguments.movie}: {count} pictures, {seconds:.1f} s, {note}")
    return 0
