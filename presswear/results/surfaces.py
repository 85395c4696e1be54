"""Surfaces for a scene to begin on, by the word that names them on the command line."""

from pathlib import Path

from presswear.results.result import load
from presswear.scene.bearing import Surfaces
from presswear.scene.files import TABLE, read_profiles
from presswear.tools.errors import InputError
from presswear.tools.files import check_folder


def read_surfaces(source: str | Path) -> Surfaces:
    """Surfaces of a stage of a result, or measured ones.

    Parameters
    ----------
    source : str or Path
        ``DIR:STAGE``: those that the stage ran on, such as 1 for those after the first wear, the
        mean of its starts; ``DIR``: those of its last stage; ``FILE.csv``: a table of profiles,
        see ``presswear.scene.files``.

    Raises
    ------
    InputError
        Naming what is not there or cannot be read.
    """
    text = f"{source}"
    if text.lower().endswith(TABLE):
        return read_profiles(Path(text))
    folder, colon, stage = text.rpartition(":")
    if not colon or Path(text).is_dir():
        folder, stage = text, ""
    elif not (stage.isascii() and stage.isdigit() and len(stage) < 10):
        raise InputError(f"{text}: behind the colon a stage, 0, 1, 2 ..., is expected")
    check_folder(Path(folder))
    result = load(folder)
    if not result.stages:
        raise InputError(f"{folder} has no finished stage")
    return result.stage(int(stage or result.stages[-1].index)).surfaces
