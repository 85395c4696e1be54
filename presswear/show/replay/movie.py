"""Stills and films from the renderer, without a display."""

import multiprocessing
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from itertools import chain
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from presswear.show.replay.picture import Picture
from presswear.show.replay.reel import Reel, instants
from presswear.tools.errors import InputError, RunFailed
from presswear.tools.files import write_whole
from presswear.tools.workers import cores, end_with_parent, undisturbed

Pixels = NDArray[np.uint8]
Frames = Sequence[Sequence[int]]

MOVIES = (".mp4", ".gif")
_COLOURS = 64
"""Colours of a GIF: flat ones need few."""


def still(reels: Sequence[Reel], frames: Sequence[int], size: tuple[int, int]) -> Pixels:
    """One picture, shape (height, width, 3)."""
    picture = Picture(reels, size)
    try:
        first, last = reels[0].span
        part = (reels[0].film.time[frames[0]] - first) / (last - first)
        picture.set(instants(reels, frames, frames), float(part), "")
        return picture.image()
    finally:
        picture.close()


def write_still(file: Path, pixels: Pixels) -> None:
    """Write a picture as PNG, whole or not at all."""
    write_whole(file, lambda part: Image.fromarray(pixels).save(part, format="png"))


_worker: dict[str, Any] = {}
"""Reels, frames and picture of a worker process."""


def _begin(reels: Sequence[Reel], frames: Frames, note: str, size: tuple[int, int]) -> None:
    end_with_parent()
    picture = Picture(reels, size)
    picture.container.visualizationSettings.raytracer.numberOfThreads = 1
    _worker.update(reels=reels, frames=frames, note=note, picture=picture)


def _draw(number: int) -> Pixels:
    frames, picture = _worker["frames"], _worker["picture"]
    shown = instants(_worker["reels"], frames[max(number - 1, 0)], frames[number])
    picture.set(shown, number / max(len(frames) - 1, 1), _worker["note"])
    image: Pixels = picture.image()
    return image


def pictures(
    reels: Sequence[Reel], frames: Frames, note: str, size: tuple[int, int]
) -> Iterator[Pixels]:
    """Pictures in order, drawn by as many processes as there are cores.

    Parameters
    ----------
    frames : sequence of sequence of int
        Frame of each reel in every picture.
    note : str
        Words on how they are played.

    Raises
    ------
    RunFailed
        Where a process is ended from outside or by the renderer.
    """
    context = multiprocessing.get_context("spawn")
    jobs = min(cores(), len(frames))
    pool = ProcessPoolExecutor(jobs, context, _begin, (reels, frames, note, size))
    try:
        with undisturbed():
            drawn = pool.map(_draw, range(len(frames)))
        yield from drawn
    except BrokenProcessPool:
        raise RunFailed("a process that draws pictures has ended by itself") from None
    finally:
        pool.shutdown(cancel_futures=True)


def check_movie(file: Path) -> None:
    """InputError unless a film can be written under such a name here."""
    if file.suffix.lower() not in MOVIES:
        raise InputError(f"--movie {file}: a name that ends in .mp4 or .gif is expected")
    if file.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        raise InputError(
            f"--movie {file}: .mp4 needs ffmpeg, which is not installed; .gif works without"
        )


def write_movie(
    file: Path,
    images: Iterator[Pixels],
    count: int,
    rate: float,
    progress: Callable[[float], None] = lambda part: None,
) -> None:
    """Write pictures as a film, whole or not at all.

    Parameters
    ----------
    count : int
        Number of the pictures, for the progress.
    rate : float
        Pictures a second.
    progress : callable
        Told the part of the pictures that is written, 0 .. 1.
    """

    def told() -> Iterator[Pixels]:
        for number, image in enumerate(images):
            yield image
            progress((number + 1) / count)

    encode = _gif if file.suffix.lower() == ".gif" else _mp4
    write_whole(file, lambda part: encode(part, told(), rate))


def _gif(part: BinaryIO, images: Iterator[Pixels], rate: float) -> None:
    """Pillow takes the pictures one by one; all share the palette of the first."""
    first = Image.fromarray(next(images)).quantize(_COLOURS)
    rest = (
        Image.fromarray(image).quantize(palette=first, dither=Image.Dither.NONE) for image in images
    )
    # A GIF counts in hundredths of a second.
    duration = 10 * max(round(100.0 / rate), 2)
    first.save(part, format="gif", save_all=True, append_images=rest, duration=duration, loop=0)


def _mp4(part: BinaryIO, images: Iterator[Pixels], rate: float) -> None:
    image = next(images)
    height, width = image.shape[:2]
    command = [
        *("ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24"),
        *("-s", f"{width}x{height}", "-r", f"{rate:g}", "-i", "-"),
        # Players expect even sizes and this way of storing colours.
        *("-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"),
        *("-movflags", "+faststart", "-f", "mp4", part.name),
    ]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        assert encoder.stdin is not None
        assert encoder.stderr is not None
        try:
            for each in chain([image], images):
                encoder.stdin.write(each.tobytes())
            encoder.stdin.close()
        except BrokenPipeError:
            pass  # the encoder says why
        except BaseException:
            encoder.kill()
            raise
        said = encoder.stderr.read().decode(errors="replace").strip().splitlines()
    if encoder.returncode != 0:
        raise RunFailed(f"ffmpeg could not write the film: {said[-1] if said else 'no reason'}")
