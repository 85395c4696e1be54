"""The plan of a sweep: which scenes, counted without making them."""

import json
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from presswear.scene.scene import Scene
from presswear.scene.settings import changed, setting_of
from presswear.sweeps.designs import design
from presswear.sweeps.distributions import Distribution, parse
from presswear.sweeps.table import Array, Column
from presswear.sweeps.values import Factor, Group, Typed, group_of
from presswear.tools.errors import InputError
from presswear.tools.files import digest
from presswear.tools.quantities import Quantity

MOST_ROWS = 10_000_000
MOST_DRAWS = 10_000
_TRIED = 16
"""Rows that are made before anything runs, over the whole plan."""
SEED = "seed"
"""Setting in which independent runs at one point differ."""


@dataclass(frozen=True)
class Plan:
    """A scene at many points; its rows are counted and made one by one.

    Every value of what is varied goes with every other and with every point of the sample, the
    last varied changes first; runs at one point that differ in their seed stand together.

    Attributes
    ----------
    scene : Scene
        What is not varied.
    vary : tuple of str
        As typed; see ``values``.
    sample : str
        ``KIND:SIZE`` of a design; nothing: no sample.
    ranges : tuple of str
        ``KEY=DISTRIBUTION`` of what is sampled.
    draws : int
        Independent runs at each point.
    seed : int
        Of the design.
    """

    scene: Scene
    vary: tuple[str, ...] = ()
    sample: str = ""
    ranges: tuple[str, ...] = ()
    draws: int = 1
    seed: int = 0

    def __post_init__(self) -> None:
        """InputError names what is unknown, empty, out of range or too large."""
        if not 1 <= self.draws <= MOST_DRAWS:
            raise InputError(f"draws = {self.draws}: allowed is 1 to {MOST_DRAWS}")
        if bool(self.sample) != bool(self.ranges):
            raise InputError("--sample and --range go together: points, and what they are of")
        if not self.groups:
            raise InputError("nothing is varied: --vary KEY=VALUES, or --sample and --range")
        keys = [column.key for column in self.columns]
        for place, key in enumerate(keys):
            if key in keys[:place]:
                raise InputError(f"{key} is varied twice")
        if self.draws > 1:
            if SEED in keys:
                raise InputError("seed is varied, and draws ask for several seeds: one is meant")
            changed(self.scene, {SEED: self.scene.seed + self.draws - 1})
        if self.rows > MOST_ROWS:
            raise InputError(f"{self.rows} rows are planned; allowed is up to {MOST_ROWS}")
        _ = self.example

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """What is varied together, the sample first."""
        groups = self._groups
        if not self.sample:
            return groups
        return (_sampled(self._ranged, self.sample, self.seed), *groups)

    @property
    def distributions(self) -> dict[str, Distribution]:
        """Distributions of what is sampled, by key."""
        return {key: known for key, (_, known) in self._ranged.items()}

    @cached_property
    def _ranged(self) -> dict[str, tuple[Factor, Distribution]]:
        return _ranged(_with_words(self.scene, self._groups), self.ranges)

    @cached_property
    def _groups(self) -> tuple[Group, ...]:
        # A process, or another mechanism, has keys of its own: words first.
        found: dict[str, Group] = {}
        for text in sorted(self.vary, key=lambda own: "." in own.partition("=")[0]):
            found[text] = group_of(_with_words(self.scene, found.values()), text)
        return tuple(found[text] for text in self.vary)

    @property
    def columns(self) -> tuple[Column, ...]:
        """What is varied, in the order of a point's values."""
        return tuple(own.column for group in self.groups for own in group.factors)

    @property
    def crossed(self) -> int:
        """Number of the last columns, which a sample is crossed with."""
        return sum(len(group.factors) for group in self._groups) if self.sample else 0

    @property
    def points(self) -> int:
        """Number of points."""
        return math.prod(len(group.values) for group in self.groups)

    @property
    def rows(self) -> int:
        """Number of runs."""
        return self.points * self.draws

    def draw(self, row: int) -> int:
        """Which of the runs at its point a row is."""
        return row % self.draws

    def point(self, row: int) -> Array:
        """Values of what is varied in a row, shape (d,)."""
        rest, found = row // self.draws, []
        for group in reversed(self.groups):
            rest, place = divmod(rest, len(group.values))
            found.append(group.values[place])
        return np.concatenate(found[::-1])

    def settings(self, row: int) -> dict[str, Typed]:
        """What a row changes in the scene."""
        factors = (own for group in self.groups for own in group.factors)
        found = {
            own.column.key: own.typed(float(value))
            for own, value in zip(factors, self.point(row), strict=True)
        }
        if self.draws > 1:
            found[SEED] = self.scene.seed + self.draw(row)
        return found

    def scene_of(self, row: int) -> Scene:
        """The scene of a row; InputError where its values do not fit together."""
        scene = changed(self.scene, self.settings(row))
        scene.check()
        return scene

    @cached_property
    def _base(self) -> str:
        return scene_digest(self.scene)

    def shortcut(self, row: int) -> str:
        """A digest of a row that costs no scene: of that of the plan, and of what is changed."""
        told = json.dumps([self._base, self.settings(row)], sort_keys=True)
        return digest(told.encode())

    @cached_property
    def example(self) -> Scene:
        """The first scene out of some that can be made; InputError where none can."""
        problem = None
        for row in np.unique(np.linspace(0, self.rows - 1, _TRIED).astype(int)):
            try:
                return self.scene_of(int(row))
            except InputError as error:
                problem = problem or error
        raise InputError(f"no scene of this plan can be made: {problem}")

    def as_dict(self) -> dict[str, Any]:
        """The plan as plain data."""
        return {
            "scene": self.scene.as_dict(),
            "vary": list(self.vary),
            "sample": self.sample,
            "ranges": list(self.ranges),
            "draws": self.draws,
            "seed": self.seed,
        }

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Plan":
        """A plan from ``as_dict``."""
        own = {**data, "scene": Scene.from_dict(data["scene"])}
        return Plan(**{**own, "vary": tuple(data["vary"]), "ranges": tuple(data["ranges"])})


def _with_words(scene: Scene, groups: Iterable[Group]) -> Scene:
    """The scene with the first of the words that are varied."""
    first = {
        factor.column.key: factor.column.words[0]
        for group in groups
        for factor in group.factors
        if factor.column.words
    }
    return changed(scene, first) if first else scene


def _ranged(scene: Scene, texts: Sequence[str]) -> dict[str, tuple[Factor, Distribution]]:
    """What is sampled, by key."""
    found: dict[str, tuple[Factor, Distribution]] = {}
    for text in texts:
        key, equals, given = (own.strip() for own in text.partition("="))
        if not equals or not given:
            raise InputError(f"--range {text}: KEY=DISTRIBUTION is expected")
        setting = setting_of(scene, key)
        if not isinstance(setting.meaning, Quantity):
            raise InputError(f"--range {text}: {key} is no number; --vary takes its words")
        if key in found:
            raise InputError(f"{key} is varied twice")
        found[key] = Factor.of(setting), parse(given, key, setting.meaning)
    return found


def _sampled(ranged: Mapping[str, tuple[Factor, Distribution]], sample: str, seed: int) -> Group:
    """The points of a sample."""
    kind, colon, size = sample.partition(":")
    if not colon or not (size.isascii() and size.isdigit() and len(size) < 9):
        raise InputError(f"--sample {sample}: KIND:SIZE is expected, such as sobol:512")
    unit = design(kind, int(size), len(ranged), seed)
    factors, known = zip(*ranged.values(), strict=True)
    values = [own.at(unit[:, k]) for k, own in enumerate(known)]
    return Group(factors, np.column_stack(values))


def scene_digest(scene: Scene) -> str:
    """Digest of all that decides the numbers of a scene; what it is called does not."""
    told = {
        key: value
        for key, value in scene.as_dict().items()
        if key not in ("name", "title", "origins")
    }
    return digest(json.dumps(told, sort_keys=True).encode())
