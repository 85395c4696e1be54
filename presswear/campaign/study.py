"""Studies: scenes in several variants, and an answer drawn from all.

A study's folder holds ``study.json``, which says what is to be run, and one result folder
for each variant.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from presswear.results.provenance import provenance, provenance_differs
from presswear.results.result import FINISHED, Result, load, read_document
from presswear.results.stored import schema_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.tools.files import read_json
from presswear.tools.lock import is_free
from presswear.tools.typed import misfits

Change = Callable[[Scene], Scene]
"""A change that a person asks for in the scene that a study starts from."""

FILE = "study.json"
SCHEMA = 2
_KEY = re.compile(r"[A-Za-z0-9][A-Za-z0-9.+=,_-]*")
_CYCLES_OF_MAPS = 0.06
"""Cycles until wear maps are known to a tolerance, times its square: a rough measure."""


def unchanged(scene: Scene) -> Scene:
    """The change that is none."""
    return scene


@dataclass(frozen=True)
class Variant:
    """One way of running the scene of a study.

    Attributes
    ----------
    key : str
        Name of its folder.
    label : str
        What is varied, in a few words.
    """

    key: str
    label: str
    scene: Scene

    @property
    def extent(self) -> float:
        """Simulated time that it takes, s: of a run that ends by itself a rough guess."""
        scene = self.scene
        cycles = scene.cycles
        if cycles is None:
            cycles = min(round(_CYCLES_OF_MAPS / scene.tolerance**2) + 9, scene.most_cycles)
        # Worn surfaces take more steps.
        return cycles * scene.mechanism.period * (1.0 + 1.5 * scene.wears)


@dataclass(frozen=True)
class Study:
    """A question that takes more than one run.

    Attributes
    ----------
    variants : tuple of Variant
        The first is the one that the others are compared with.
    """

    name: str
    title: str
    question: str
    variants: tuple[Variant, ...]

    def as_dict(self) -> dict[str, Any]:
        """The study as plain data."""
        return {
            "schema": SCHEMA,
            "name": self.name,
            "title": self.title,
            "question": self.question,
            "variants": [
                {"key": v.key, "label": v.label, "scene": v.scene.as_dict()} for v in self.variants
            ],
        }


def is_study(folder: Path) -> bool:
    """True where a folder is that of a study."""
    return (folder / FILE).exists()


def load_study(folder: Path) -> Study:
    """The study of a folder; InputError says what is wrong with it."""
    file = folder / FILE
    data = read_json(file, f"{folder} is no study's folder: it has no {FILE}")
    schema_of(data, file, SCHEMA)
    try:
        variants = tuple(
            Variant(v["key"], v["label"], Scene.from_dict(v["scene"])) for v in data["variants"]
        )
        study = Study(data["name"], data["title"], data["question"], variants)
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    except (LookupError, TypeError) as error:
        raise InputError(f"{file} is not whole: {error!r}") from None
    wrong = next(misfits(study), None)
    if wrong is not None:
        raise InputError(f"{file}: {wrong} is not what it should be")
    keys = [variant.key for variant in variants]
    # A key names a folder: it must not lead anywhere else.
    strange = [key for key in keys if not _KEY.fullmatch(key) or keys.count(key) > 1]
    if strange or not keys:
        raise InputError(f"{file}: {strange[:1] or 'nothing'} cannot name a variant's folder")
    return study


def is_finished(path: Path) -> bool:
    """True where a folder holds the whole result of a scene."""
    if not (path / "result.json").exists():
        return False
    # The other files of one at work change while they are read.
    return read_document(path)["status"] in FINISHED and load(path).status in FINISHED


def waiting(study: Study, folder: Path, resume: bool) -> list[Variant]:
    """The variants that have to run, or to go on.

    Raises
    ------
    InputError
        Where the folder holds something and nothing is to be resumed, or another study, or one
        begun with other versions.
    """
    if not resume:
        if not is_free(folder):
            raise InputError(
                f"--out {folder}: it exists and is not empty; name a new one or --resume"
            )
        return list(study.variants)
    if is_free(folder):
        return list(study.variants)
    found = load_study(folder)
    wanted = {v.key: v.scene for v in study.variants}
    there = {v.key: v.scene for v in found.variants}
    for key in dict.fromkeys([*wanted, *there]):
        if wanted.get(key) != there.get(key):
            raise InputError(
                f"--out {folder}: it holds another study ({key} differs); "
                "give the options of the first start, or name a new folder"
            )
    here = provenance()
    versions = provenance_differs(read_json(folder / FILE, "").get("provenance", here), here)
    if versions:
        raise InputError(
            f"--out {folder}: it was begun by another program, with which its numbers would not "
            f"agree: {versions}"
        )
    return [v for v in study.variants if not is_finished(folder / v.key)]


def results_of(study: Study, folder: Path) -> Iterator[tuple[Variant, Result | None]]:
    """Each variant with its result; None for one that failed before its first stage ended."""
    for variant in study.variants:
        path = folder / variant.key
        yield variant, load(path) if (path / "result.json").exists() else None
