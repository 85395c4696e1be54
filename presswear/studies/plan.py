"""Studies: scenes in several variants, and an answer drawn from all.

A study's folder holds ``study.json``, which says what is to be run, one result folder for each
variant, and the records of ``sweeps.store``, by which processes share it.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from presswear.campaign.ensemble import most_runs
from presswear.recording.sampling import STARTUP_CYCLES
from presswear.results.provenance import Provenance, provenance, provenance_differs
from presswear.results.result import FINISHED, Result, load, read_document
from presswear.scene.scene import Scene
from presswear.scene.settings import begun_on
from presswear.sweeps.store import CLAIMS, RECORDS, can_begin
from presswear.tools.documents import read_json, typed
from presswear.tools.errors import InputError

Change = Callable[[Scene], Scene]
"""A change that a person asks for in the scene that a study starts from."""

FILE = "study.json"
SCHEMA = 4
_KEY = re.compile(r"[A-Za-z0-9][A-Za-z0-9.+=,_-]*")
_CYCLES_OF_MAPS = 0.2
"""Cycles until wear maps are known to a tolerance, times its square: a rough measure."""
_CYCLES_OF_STEPS = 250
"""Cycles in a wear in steps, about."""
_WORN = {"radial": 2.0, "foundation": 5.0}
"""What a cycle on worn surfaces takes beside one on round ones, about."""
_EXUDYN = 6.0
"""What a cycle through Exudyn takes beside one in-house, about."""


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
        The change from the others, in a few words.
    scene : Scene
    on : str
        ``KEY:STAGE``, the stage of a variant before it on whose surfaces it begins; or nothing.
    """

    key: str
    label: str
    scene: Scene
    on: str = ""

    @property
    def source(self) -> str:
        """Key of the variant that runs before it, or nothing."""
        return self.on.rpartition(":")[0]

    def scene_in(self, folder: Path) -> Scene:
        """The scene on the surfaces that it begins on, in the study's folder.

        InputError where the variant that they are of never came to that stage.
        """
        if not self.on:
            return self.scene
        path, stage = folder / self.source, int(self.on.rpartition(":")[2])
        stages = load(path).stages if (path / "result.json").exists() else ()
        if stage >= len(stages):
            raise InputError(f"{self.source} never came to stage {stage}, on which it begins")
        return begun_on(self.scene, stages[stage].surfaces, self.on)

    @property
    def extent(self) -> float:
        """What it takes, in cycles on round surfaces in-house: a rough guess."""
        scene = self.scene
        worn = _WORN[scene.conventions.contact]
        known = round(_CYCLES_OF_MAPS / scene.tolerance**2) + STARTUP_CYCLES * scene.draws
        cycles = 0.0
        for index in range(scene.wear_updates + 1):
            jumps = index < scene.wear_updates and not scene.wears_in_steps
            own = scene.max_cycles if jumps else min(known, scene.max_cycles)
            own = own if scene.cycles is None else scene.cycles * scene.draws
            if index == 0:
                cycles += own
            else:
                cycles += worn * own * most_runs(scene) / scene.draws
            if index < scene.wear_updates and scene.wears_in_steps:
                cycles += worn * _CYCLES_OF_STEPS
        return cycles if scene.engine == "dae" else _EXUDYN * cycles


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
                {"key": v.key, "label": v.label, "scene": v.scene.as_dict(), "on": v.on}
                for v in self.variants
            ],
        }


@dataclass(frozen=True)
class StoredVariant:
    """A variant in ``study.json``; the scene is checked by ``Scene`` itself."""

    key: str
    label: str
    scene: dict[str, Any]
    on: str


@dataclass(frozen=True)
class StoredStudy:
    """The whole of ``study.json``; see ``Study``."""

    name: str
    title: str
    question: str
    variants: tuple[StoredVariant, ...]
    provenance: Provenance


def is_study(folder: Path) -> bool:
    """True where a folder is that of a study."""
    return (folder / FILE).exists()


def load_study(folder: Path) -> Study:
    """The study of a folder; InputError says what is wrong with it."""
    return _study_of(_stored(folder), folder)


def _stored(folder: Path) -> StoredStudy:
    file = folder / FILE
    data = read_json(file, f"{folder} is no study's folder: it has no {FILE}", SCHEMA)
    return typed(data, StoredStudy, f"{file}")


def _study_of(stored: StoredStudy, folder: Path) -> Study:
    file = folder / FILE
    try:
        variants = tuple(
            Variant(v.key, v.label, Scene.from_dict(v.scene), v.on) for v in stored.variants
        )
    except InputError as error:
        raise InputError(f"{file}: {error}") from None
    keys = [variant.key for variant in variants]
    # A key names a folder: it must not lead anywhere else.
    taken = {RECORDS, CLAIMS}
    strange = [k for k in keys if not _KEY.fullmatch(k) or keys.count(k) > 1 or k in taken]
    if strange or not keys:
        raise InputError(f"{file}: {strange[:1] or 'nothing'} cannot name a variant's folder")
    for place, variant in enumerate(variants):
        stage = variant.on.rpartition(":")[2]
        is_place = stage.isascii() and stage.isdigit() and variant.source in keys[:place]
        if variant.on and not is_place:
            raise InputError(
                f"{file}: {variant.key} begins on {variant.on!r}; KEY:STAGE of a variant before it "
                "is expected"
            )
    return Study(stored.name, stored.title, stored.question, variants)


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
    if can_begin(folder):
        return list(study.variants)
    if not resume:
        raise InputError(f"--out {folder}: it exists and is not empty; name a new one or --resume")
    stored = _stored(folder)
    wanted = {v.key: (v.scene, v.on) for v in study.variants}
    there = {v.key: (v.scene, v.on) for v in _study_of(stored, folder).variants}
    for key in dict.fromkeys([*wanted, *there]):
        if wanted.get(key) != there.get(key):
            raise InputError(
                f"--out {folder}: it holds another study ({key} differs); "
                "give the options of the first start, or name a new folder"
            )
    versions = provenance_differs(stored.provenance, provenance())
    if versions:
        raise InputError(
            f"--out {folder}: it was begun by another program, with which its numbers would not "
            f"agree: {versions}"
        )
    return [v for v in study.variants if not is_finished(folder / v.key)]


def results_of(study: Study, folder: Path) -> Iterator[tuple[Variant, Result | None]]:
    """Each variant with its result; None for one that failed before its first stage ended.

    Nor has one a result whose surfaces were never reached.
    """
    for variant in study.variants:
        path = folder / variant.key
        yield variant, load(path) if (path / "result.json").exists() else None
