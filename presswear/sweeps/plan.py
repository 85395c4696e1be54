"""Plan of a sweep: the scene of each row, and the table of the rows."""

import csv
import io
import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, compress
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from presswear.results import frames
from presswear.scene.catalog import scene_named
from presswear.scene.files import SUFFIX, SWEEP, read_toml, scene_from
from presswear.scene.scene import Scene
from presswear.scene.setting_keys import setting_of
from presswear.scene.setting_list import SET, settings_of
from presswear.scene.settings import changed
from presswear.sweeps.parameters import (
    Column,
    Display,
    Distribution,
    Group,
    Value,
    column_of,
    design,
    parse_distribution,
    parse_group,
)
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, unknown
from presswear.tools.files import digest
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Checked, check_fields, make

if TYPE_CHECKING:
    import pandas
    import xarray

MAX_ROWS = 1_000_000  # rows of a plan
MAX_REPLICATES = 10_000
TRIED_ROWS = 16  # rows whose scenes are made before anything runs
SEED = "seed"  # setting in which the replicates of a point differ
NOT_RUN = "not run yet"


@dataclass(frozen=True)
class Plan:
    """Scene at many points.

    Every value of a parameter is combined with every value of the others and with every
    point of the sample. The last parameter varies fastest; replicates of a point are
    neighbouring rows.
    """

    scene: Scene  # scene whose settings vary
    vary: tuple[str, ...] = ()  # KEY=VALUES
    sample: str = ""  # design, KIND:SIZE
    ranges: tuple[str, ...] = ()  # KEY=DISTRIBUTION of the sampled parameters
    # runs at each point, with the seed of the scene and the next ones
    replicates: int = 1
    seed: int = 0  # seed of the design

    def __post_init__(self) -> None:
        """Check the plan; `InputError` names a value that is unknown, missing or out of range."""
        check_fields(self)  # lists become tuples
        if not 1 <= self.replicates <= MAX_REPLICATES:
            raise InputError(
                f"replicates = {self.replicates}: must be 1 to {MAX_REPLICATES}"
            )
        if bool(self.sample) != bool(self.ranges):
            raise InputError("a sample and ranges must be used together")
        if not self.groups:
            raise InputError(
                "nothing varies: vary a key (KEY=VALUES), or use a sample and ranges"
            )
        counts = Counter(column.key for column in self.columns)
        ((key, count),) = counts.most_common(1)
        if count > 1:
            raise InputError(f"{key} varies twice")
        if self.replicates > 1 and SEED in counts:
            raise InputError("vary seed and replicates cannot be combined")
        rows = self.replicates * math.prod(len(group.values) for group in self.groups)
        if rows > MAX_ROWS:
            raise InputError(
                f"the plan has {rows} rows; at most {MAX_ROWS} are allowed"
            )
        _ = self.example  # raises if no scene of the plan can run

    @cached_property
    def groups(self) -> tuple[Group, ...]:
        """Groups of parameters that vary together, the sample first."""
        if not self.sample:
            return self._varied
        kind, _, size = self.sample.partition(":")
        if not (size.isascii() and size.isdigit() and len(size) < 9):
            raise InputError(
                f"sample = {self.sample}: expected KIND:SIZE, such as sobol:512"
            )
        columns, distributions = zip(*self._sampled, strict=True)
        unit = design(kind, int(size), len(columns), self.seed)
        pairs = zip(distributions, unit.T, strict=True)
        values = [distribution.ppf(column) for distribution, column in pairs]
        return (Group(columns, np.column_stack(values)), *self._varied)

    @cached_property
    def _varied(self) -> tuple[Group, ...]:
        # A key with a dot, such as process.force, exists only with a kind of process. Keys
        # without a dot, such as process, are therefore read first.
        groups: dict[str, Group] = {}
        for text in sorted(self.vary, key=lambda text: "." in text.partition("=")[0]):
            scene = _with_words(self.scene, groups.values())
            groups[text] = parse_group(scene, text)
        return tuple(groups[text] for text in self.vary)

    @cached_property
    def _sampled(self) -> list[tuple[Column, Distribution]]:
        scene = _with_words(self.scene, self._varied)
        sampled = []
        for text in self.ranges:
            key, _, words = map(str.strip, text.partition("="))
            if not words:
                raise InputError(f"range {text}: expected KEY=DISTRIBUTION")
            setting = setting_of(scene, key)
            if not isinstance(setting.meaning, Quantity):
                raise InputError(
                    f"range {text}: {key} is not a number; vary words instead"
                )
            distribution = parse_distribution(words, key, setting.meaning)
            sampled.append((column_of(setting), distribution))
        return sampled

    @property
    def distributions(self) -> dict[str, Distribution]:
        """Distributions of the sampled parameters by key."""
        return {column.key: distribution for column, distribution in self._sampled}

    @property
    def columns(self) -> tuple[Column, ...]:
        """Parameters, in the order of the coordinates of a point."""
        return tuple(chain.from_iterable(group.columns for group in self.groups))

    @cached_property
    def points(self) -> Array:
        """Points, shape (points, parameters)."""
        shape = [len(group.values) for group in self.groups]
        places = np.indices(shape).reshape(len(shape), -1)
        groups = zip(self.groups, places, strict=True)
        return np.column_stack([group.values[place] for group, place in groups])

    @property
    def rows(self) -> int:
        """Number of runs."""
        return len(self.points) * self.replicates

    def settings(self, row: int) -> dict[str, Value]:
        """Return the settings that a row changes in the scene."""
        point, replicate = divmod(row, self.replicates)
        pairs = zip(self.columns, self.points[point].tolist(), strict=True)
        settings = {column.key: column.setting(value) for column, value in pairs}
        if replicate > 0:
            settings[SEED] = self.scene.seed + replicate
        return settings

    def scene_of(self, row: int) -> Scene:
        """Return the scene of a row; `InputError` if its settings do not fit together.

        The run checks whether it can run.
        """
        scene = _with_requested_wear(changed(self.scene, self.settings(row)))
        if scene.purpose == "auto" and scene.wear_updates == 0:
            # Rows are compared by peaks and means.
            scene = replace(scene, purpose="forces")
        has_updates = scene.wear_updates > 0 and scene.life is None
        if has_updates and scene.cycles_per_update is None:
            advice = "set it, as in cycles_per_update=1e6, so that all rows wear by equal strokes"
            raise InputError(f"cycles_per_update = none: {advice}, or wear_updates=0")
        return scene

    @property
    def remark(self) -> str:
        """Reason why the rows have no wear updates although the scene has some; else empty."""
        if self.scene.wear_updates == 0 or self.example.wear_updates > 0:
            return ""
        return "no wear updates: set cycles_per_update, so that all rows wear by equal strokes"

    def identity(self, row: int) -> str:
        """Return a text that is equal for equal rows, without making the scene of the row."""
        base, present = self._base
        settings = self.settings(row).items()
        changes = {key: value for key, value in settings if (key, value) not in present}
        return json.dumps([base, changes], sort_keys=True)

    @cached_property
    def _base(self) -> tuple[str, list[tuple[str, Any]]]:
        """Digest of all that decides the numbers of the scene, and the values of its settings."""
        data = self.scene.as_dict()
        for key in ("name", "title", "origins"):  # they change no number
            data.pop(key, None)
        settings = settings_of(self.scene)
        values = [(setting.key, setting.value) for setting in settings]
        return digest(json.dumps(data, sort_keys=True).encode()), values

    @cached_property
    def example(self) -> Scene:
        """First scene that can run; `InputError` if none can."""
        problem = None
        for row in np.unique(np.linspace(0, self.rows - 1, TRIED_ROWS).astype(int)):
            try:
                scene = self.scene_of(int(row))
                scene.check()
                return scene
            except InputError as error:
                problem = problem or error
        raise InputError(f"no scene of this plan can be made: {problem}")

    @staticmethod
    def from_plain(data: Mapping[str, Any]) -> "Plan":
        """Return a plan from plain data."""
        return Plan(**{**data, "scene": Scene.from_dict(data["scene"])})


def _with_words(scene: Scene, groups: Iterable[Group]) -> Scene:
    """Return the scene with the first word of each parameter that is not a number."""
    columns = chain.from_iterable(group.columns for group in groups)
    words = {column.key: column.choices[0] for column in columns if column.choices}
    return changed(scene, words)


def _with_requested_wear(scene: Scene) -> Scene:
    """Return a scene without the default number of wear updates if their strokes are not set.

    A new file contains this number.
    """
    is_default = scene.wear_updates == Scene.wear_updates
    is_default = is_default and scene.origins.get("wear_updates") != SET
    if is_default and scene.life is None and scene.cycles_per_update is None:
        return replace(scene, wear_updates=0)
    return scene


@dataclass(frozen=True)
class SweepFile(Checked):
    """Table ``[sweep]`` of a TOML file; its keys are the options of the command.

    `scene` names a scene or another file; it is omitted in the file of a scene.
    """

    scene: str = ""
    vary: tuple[str, ...] = ()
    sample: str = ""
    ranges: tuple[str, ...] = ()
    responses: tuple[str, ...] = ()
    limits: tuple[str, ...] = ()
    replicates: int = 1
    seed: int = 0
    keep: Literal["responses", "results"] = "responses"


def read_sweep(file: Path) -> tuple[Scene, SweepFile]:
    """Read the scene and the table ``[sweep]`` of a file; `InputError` names a wrong key."""
    data = read_toml(file)
    options = make(f"[{SWEEP}] in {file}", SweepFile, data.get(SWEEP, {}))
    if not options.scene:
        return scene_from(file), options
    if data.keys() - {SWEEP}:
        raise InputError(
            f"{file}: {SWEEP}.scene names a scene, but the file describes one"
        )
    if options.scene.endswith(SUFFIX):
        return scene_from(file.parent / options.scene), options
    return scene_named(options.scene), options


@dataclass(frozen=True)
class Table:
    """Rows of a sweep: parameters, responses and errors, in SI units."""

    parameters: tuple[Column, ...]
    responses: tuple[Column, ...]
    points: Array  # shape (rows, parameters)
    values: Array  # shape (rows, responses); NaN where a run has none
    # shape (rows, responses), of the 95 % intervals; NaN where a run has none
    half_widths: Array
    # shape (rows, responses), whether a value is a lower bound
    censored: NDArray[np.bool_]
    errors: tuple[str, ...]  # reason why a row has no values; empty where it has
    replicates: int = 1  # neighbouring rows that are replicates of one point
    # degrees of freedom of the half widths; none: infinite
    freedom: tuple[float, ...] = ()

    def index(self, key: str) -> int:
        """Return the column of a response; `InputError` if there is none of this name."""
        keys = [column.key for column in self.responses]
        if key not in keys:
            raise unknown("response", key, keys)
        return keys.index(key)

    def at(self, values: Array) -> "Table":
        """Return the rows at which the last parameters have some values, without these columns."""
        count = len(values)
        rows = (self.points[:, -count:] == values).all(axis=1)
        return replace(
            self,
            parameters=self.parameters[:-count],
            points=self.points[rows, :-count],
            values=self.values[rows],
            half_widths=self.half_widths[rows],
            censored=self.censored[rows],
            errors=tuple(compress(self.errors, rows)),
        )

    def columns(self) -> dict[str, list[Any]]:
        """Return the columns of an exported table by name."""
        columns: dict[str, list[Any]] = {}
        for column, values in zip(self.parameters, self.points.T, strict=True):
            columns[column.key] = [column.setting(value) for value in values.tolist()]
        rows = range(len(self.errors))
        columns["replicate"] = [row % self.replicates for row in rows]
        for k, column in enumerate(self.responses):
            columns[column.key] = self.values[:, k].tolist()
            columns[f"{column.key}_half_width"] = self.half_widths[:, k].tolist()
            columns[f"{column.key}_is_lower_bound"] = self.censored[:, k].tolist()
        columns["error"] = list(self.errors)
        return columns

    def texts(self, count: int) -> list[list[str]]:
        """Return the titles of the columns and the first rows as texts.

        A lower bound has the sign ``>``, a missing value is a dash.
        """
        columns = []
        for column, values in zip(self.parameters, self.points.T, strict=True):
            shown = Display(column, values)
            texts = [shown.number(value, 4) for value in values[:count]]
            columns.append([shown.label, *texts])
        for k, column in enumerate(self.responses):
            shown = Display(column, self.values[:, k])
            texts = []
            for row in range(min(count, len(self.errors))):
                sign = ">" if self.censored[row, k] else ""
                text = shown.with_half_width(
                    self.values[row, k], self.half_widths[row, k], digits=4
                )
                texts.append(f"{sign}{text}")
            columns.append([shown.label, *texts])
        return [list(line) for line in zip(*columns, strict=True)]

    def csv(self) -> str:
        """Return the table as CSV; a comment in the second line holds the units."""
        columns = self.columns()
        units = self.units
        names = [f"{name} {units.get(name, '')}".rstrip() for name in columns]
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(columns)
        text.write(f"# units: {','.join(names)}\n")
        for row in zip(*columns.values(), strict=True):
            writer.writerow([_csv_cell(value) for value in row])
        return text.getvalue()

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table as a data frame, a row for each run; needs pandas.

        ``attrs["units"]`` holds the units of parameters and responses.
        """
        return frames.frame(self.columns(), self.units)

    def to_xarray(self) -> "xarray.Dataset":
        """Return the responses over the parameters and the replicates; needs xarray.

        Points of a grid fill an array with a dimension for each parameter. Others, such
        as those of a sample, have the dimension ``row``.
        """
        names = [column.key for column in self.parameters]
        return frames.data_set(self.columns(), self.units, [*names, "replicate"])

    @property
    def units(self) -> dict[str, str]:
        """Units of parameters and responses by column."""
        columns = (*self.parameters, *self.responses)
        units = {column.key: column.unit for column in columns}
        for response in self.responses:
            units[f"{response.key}_half_width"] = response.unit
        return units


def _csv_cell(value: Any) -> Any:
    """Return a value as it is written to CSV: 0 or 1 for a truth value, empty for NaN."""
    if isinstance(value, bool):
        return int(value)
    is_missing = isinstance(value, float) and math.isnan(value)
    return "" if is_missing else value
