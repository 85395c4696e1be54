"""Sweeps: run a scene at many points and keep the responses in a folder."""

import math
import os
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from presswear.results import frames
from presswear.results.provenance import program_digest, provenance
from presswear.results.result import Result, load
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.sweeps import runner
from presswear.sweeps.parameters import texts_of
from presswear.sweeps.plan import NOT_RUN, Plan, Table
from presswear.sweeps.response_limits import ResponseLimit, parse_limits
from presswear.sweeps.response_points import means_of
from presswear.sweeps.response_readers import Response
from presswear.sweeps.responses import (
    Requested,
    User,
    digest_of,
    freedom_of,
    request,
)
from presswear.tools.arguments import checked_arguments
from presswear.tools.choices import Choice
from presswear.tools.errors import InputError, RunFailed, not_installed, printable
from presswear.tools.files import (
    check_ending,
    digest,
    inside,
    is_free,
    only_writer,
    write_bytes,
)
from presswear.tools.processes import check_jobs
from presswear.tools.serialize import read_json, typed, write_json
from presswear.tools.type_check import check_type

if TYPE_CHECKING:
    import pandas
    import xarray

FILE = "sweep.json"
PARTS = "parts"  # folder of the shards
SCHEMA = 2
Keep = Literal["responses", "results"]
SHOWN_ROWS = 20  # rows of a table in a terminal or a notebook
# Keys that Exudyn's studies add to the parameters
COMPUTATION_INDEX = "computationIndex"
FUNCTION_DATA = "functionData"


@dataclass(frozen=True)
class Sweep:
    """Sweep in its folder, with the table of its rows."""

    plan: Plan
    requested: Requested  # responses of the table
    path: Path
    keep: Keep = "responses"
    limits: tuple[str, ...] = ()
    # digest of the program that computed the rows
    program: str = field(default_factory=program_digest)

    def __post_init__(self) -> None:
        """Check the options; `InputError` names the one that does not fit."""
        Choice(get_args(Keep), "").check("keep", self.keep)
        for option in fields(self):
            check_type(option.name, getattr(self, option.name), option.type)
        _ = self.limit_of  # raises InputError for a limit that cannot be read

    @cached_property
    def limit_of(self) -> dict[str, ResponseLimit]:
        """Limits by response."""
        return parse_limits(self.limits, self.requested.columns)

    def name(self, row: int) -> str:
        """Return the name of the file of a row."""
        origin = (self.plan.identity(row), self.program, self.requested.extra)
        return digest(" ".join(origin).encode())

    def result(self, row: int) -> Result:
        """Return the complete result of a row of a sweep with ``keep="results"``."""
        return load(self.path / runner.RUNS / self.name(row))

    @cached_property
    def table(self) -> Table:
        """Table of the rows that are stored now."""
        plan = self.plan
        requested = self.requested
        keys = [column.key for column in requested.columns]
        errors = []
        numbers = np.full((3, plan.rows, len(keys)), np.nan)
        for row in range(plan.rows):
            outcome = runner.read_row(self.path, self.name(row))
            if outcome is None:
                errors.append(NOT_RUN)
                continue
            errors.append(outcome.error)
            for k, key in enumerate(keys):
                response = outcome.values.get(key)
                if response:
                    numbers[:, row, k] = np.array(response, float)  # None becomes NaN
        values, half_widths, is_censored = numbers
        return Table(
            plan.columns,
            requested.columns,
            np.repeat(plan.points, plan.replicates, axis=0),
            values,
            half_widths,
            is_censored == 1.0,
            tuple(errors),
            plan.replicates,
            tuple(freedom_of(plan.scene, key) for key in keys),
        )

    def write(self, file: Path) -> None:
        """Write everything but the rows."""
        data = {"schema": SCHEMA, "provenance": provenance(), "plan": self.plan}
        data["requested"] = replace(self.requested, functions=())
        data |= {"keep": self.keep, "limits": self.limits, "program": self.program}
        write_json(file, data)

    def report(self) -> Path:
        """Write figures, ``table.csv`` and ``report.html`` into the folder; return the page."""
        from presswear.sweeps.report import write_report  # slow to import

        return write_report(self.table, self.plan, self.path, self.limit_of)

    @property
    def summary(self) -> str:
        """Number of rows, with the first error."""
        errors = [error for error in self.table.errors if error and error != NOT_RUN]
        waiting = self.table.errors.count(NOT_RUN)
        text = f"{len(self.table.errors)} rows in {self.path}"
        if waiting:
            text += f", {waiting} not run yet"
        if errors:
            text += f"; {len(errors)} failed, the first: {errors[0]}"
        return text

    def to_pandas(self, means: bool = False) -> "pandas.DataFrame":
        """Return the rows as a data frame; see ``Table.to_pandas``.

        With ``means`` a row is a point, and the columns of each response are the mean over
        its replicates, ``KEY_half_width`` of its 95 % interval, ``KEY_replicates``, the
        number of replicates with a value, and ``KEY_is_lower_bound``.
        """
        if not means:
            return self.table.to_pandas()
        return frames.frame(*means_of(self.table))

    def to_xarray(self) -> "xarray.Dataset":
        """Return the responses over the parameters; see ``Table.to_xarray``."""
        return self.table.to_xarray()

    def __repr__(self) -> str:
        """Return parameters, responses and the number of rows in one line."""
        table = self.table
        varied = ", ".join(column.key for column in table.parameters)
        responses = ", ".join(column.key for column in table.responses)
        return printable(f"<Sweep: {responses} over {varied}, {self.summary}>")

    def _repr_html_(self) -> str:
        """Return the first rows for a notebook."""
        body = ""
        for line in self.table.texts(SHOWN_ROWS):
            cells = "".join(f"<td>{escape(cell)}</td>" for cell in line)
            body += f"<tr>{cells}</tr>"
        return f"<p><b>{escape(self.summary)}</b></p><table>{body}</table>"

    def __str__(self) -> str:
        lines = self.table.texts(SHOWN_ROWS)
        widths = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
        rows = ("  ".join(map(str.ljust, line, widths)).rstrip() for line in lines)
        return printable("\n".join([*rows, self.summary]))


@checked_arguments
def load_sweep(folder: str | Path) -> Sweep:
    """Read the folder of a sweep, complete or in part; `InputError` if it holds none."""
    folder = Path(folder)
    file = folder / FILE
    data = read_json(
        file, f"{folder} is not the folder of a sweep: it has no {FILE}", SCHEMA
    )
    try:
        plan = Plan.from_plain(data["plan"])
        requested = typed(data["requested"], Requested, f"{file}")
        limits = typed(data["limits"], tuple[str, ...], f"{file}")
        program = str(data["program"])
        return Sweep(plan, requested, folder, data["keep"], limits, program)
    except (KeyError, TypeError) as error:
        raise InputError(f"{file} cannot be read: {error}") from None


def check_folder_of(sweep: Sweep, resume: bool, is_part: bool = False) -> None:
    """Raise `InputError` if a sweep may not write into its folder.

    The folder may hold a sweep with `resume`. With `is_part` it may hold this sweep, which
    another shard of it has started.
    """
    names = {file.name for file in sweep.path.glob("*")}
    is_starting = is_part and names <= {PARTS}
    if is_starting or is_free(sweep.path):
        return
    if not (resume or is_part):
        remedy = "name a new folder, or resume its sweep (--resume)"
        raise InputError(f"folder {sweep.path}: it exists and is not empty; {remedy}")
    if load_sweep(sweep.path).plan != sweep.plan and not resume:
        raise InputError(
            f"folder {sweep.path}: it holds another sweep; --resume extends it"
        )


def export_table(table: Table, path: Path) -> None:
    """Write a table as ``.csv`` or ``.parquet``; the file must not exist."""
    kind = check_ending(path, ".csv", ".parquet")
    if path.exists():
        raise InputError(f"{path} exists; name a new file")
    if kind == ".csv":
        write_bytes(path, table.csv().encode())
        return
    try:
        data = table.to_pandas().to_parquet(index=False)
    except ImportError:
        raise not_installed(f"{path}: Parquet", "pyarrow") from None
    write_bytes(path, data)


def parse_shard(text: str) -> tuple[int, int]:
    """Return K and N of a shard ``K/N`` of the rows."""
    match = re.fullmatch(r"([0-9]{1,7})/([0-9]{1,7})", text)
    number, count = map(int, match.groups()) if match else (0, 0)
    if not 1 <= number <= count:
        raise InputError(
            f"shard = {text}: expected K/N with K from 1 to N, such as 3/10"
        )
    return number, count


def run_sweep(
    sweep: Sweep,
    on: str = "",
    jobs: int | None = None,
    shard: tuple[int, int] = (1, 1),
    on_progress: Callable[[runner.Progress], object] = lambda progress: None,
    notify: runner.Notify = print,
) -> Sweep:
    """Run the missing rows of shard (K, N) of a sweep by this program; see `sweep`.

    Rows that another program computed do not count.
    """
    sweep.plan.scene.check_trusted()
    requested = sweep.requested
    keeps = sweep.keep == "results"
    if requested.extra != digest_of(requested.optional, requested.functions):
        raise InputError(
            f"{sweep.path} has user functions as responses: resume it in their script"
        )
    for name in (runner.ROWS, runner.RUNS):
        inside(sweep.path, name)
    sweep = replace(sweep, program=program_digest())
    number, count = shard
    rows = range(number - 1, sweep.plan.rows, count)
    scenes = {sweep.name(row): partial(sweep.plan.scene_of, row) for row in rows}
    if sweep.plan.remark:
        notify(sweep.plan.remark)
    with runner.open_executor(on, jobs, notify) as (executor, slots):
        # Shards of a sweep share its folder; one process at a time runs each shard.
        folder = sweep.path
        if count > 1:
            folder = sweep.path / PARTS / f"{number}-of-{count}"
        with only_writer(folder, resume=True):
            sweep.write(folder / FILE)
            os.replace(folder / FILE, sweep.path / FILE)
            runner.run_rows(
                sweep.path, scenes, requested, executor, slots, keeps, on_progress
            )
    return sweep


@checked_arguments
def sweep(  # noqa: PLR0913 - the options of the command
    scene: Scene,
    vary: Mapping[str, Any] | None = None,
    folder: str | Path = "",
    responses: Sequence[str | User] = (),
    sample: str = "",
    ranges: Mapping[str, str] | None = None,
    replicates: int = 1,
    seed: int = 0,
    keep: Keep = "responses",
    on: str = "",
    jobs: int | None = None,
    shard: str = "1/1",
    limits: Sequence[str] = (),
    notify: runner.Notify = print,
) -> Sweep:
    """Run a scene at many points; rows that are in the folder do not run again.

    Parameters
    ----------
    scene : Scene
        Scene whose settings vary.
    vary : mapping
        Values by key: a text such as ``"0.2mm:1.0mm:9"``, or a list of numbers in SI
        units or of words. Every value is combined with every value of the other keys.
    folder : path
    responses : sequence of str or callable
        Names such as ``"A.force_max"``, or functions of a `Result` that return a
        number; none: all usual ones.
    sample : str
        Design of the parameters in `ranges`, such as ``"sobol:512"``.
    ranges : mapping of str to str
        Distributions by key, such as ``"normal(0.8mm, 0.05mm)"``.
    replicates : int
        Independent runs at each point, which differ in their seed.
    seed : int
        Seed of the design.
    keep : {"responses", "results"}
        Whether the complete result of each run is stored.
    on : str
        Executor: processes of this machine, ``dask``, ``dask://HOST:PORT`` or
        ``MODULE:FACTORY``.
    jobs : int or None
        Runs at a time on this machine; None: number of cores.
    shard : str
        ``K/N``: only every N-th row from the K-th.
    limits : sequence of str
        Limits on responses, such as ``"life>=2e6"``; the report estimates violations.
    notify : callable
        Called with a line for the user, such as the address of the Dask dashboard.

    Raises
    ------
    InputError
        Before anything runs, if an option is unknown, missing or out of range.
    RunFailed
        If the executor fails. A run that fails is a row with its error.
    """
    check_jobs(jobs)
    if f"{folder}" == "":
        raise InputError("folder: a sweep needs a folder")
    listed = tuple(f"{key}={text}" for key, text in (ranges or {}).items())
    plan = Plan(scene, texts_of(scene, vary or {}), sample, listed, replicates, seed)
    requested = request(plan.example, list(responses))
    new_sweep = Sweep(plan, requested, Path(folder), keep, tuple(limits))
    check_folder_of(new_sweep, resume=True)
    return run_sweep(new_sweep, on, jobs, parse_shard(shard), notify=notify)


@checked_arguments
def function_of(
    scene: Scene,
    responses: str | User | Sequence[str | User],
    failed: float | None = None,
) -> Callable[[Mapping[str, Any]], float | list[float]]:
    """Return a function from a dictionary of settings to responses of a run; it can be pickled.

    Exudyn's `ParameterVariation`, `GeneticOptimization` and `ComputeSensitivities`
    accept it.

    Parameters
    ----------
    responses : str, callable, or sequence of these
        As in `sweep`; a single one gives a number, a sequence gives a list.
    failed : float or None
        Value of a run that fails, such as 1e9 for an optimizer; None: `RunFailed` is
        raised.
    """
    is_scalar = isinstance(responses, str) or callable(responses)
    items: Any = [responses] if is_scalar else responses
    return partial(_evaluate, scene, request(scene, items), is_scalar, failed)


def _evaluate(
    scene: Scene,
    requested: Requested,
    is_scalar: bool,
    failed: float | None,
    parameters: Mapping[str, Any],
) -> float | list[float]:
    """Return responses of the scene with changed settings."""
    check_type("parameters", parameters, Mapping[str, Any])
    settings = {**parameters.get(FUNCTION_DATA, {}), **parameters}
    for key in (COMPUTATION_INDEX, FUNCTION_DATA):
        settings.pop(key, None)
    varied = changed(scene, settings)
    program = program_digest()
    outcome, result = runner.run_scene(varied, requested, None, program)
    if result is not None:
        outcome = runner.with_functions(outcome, requested.functions, lambda: result)
    if outcome.error and failed is None:
        raise RunFailed(outcome.error)
    default = Response(failed) if outcome.error else Response(None)
    values = []
    for column in requested.columns:
        value = outcome.values.get(column.key, default).value
        values.append(math.nan if value is None else value)
    return values[0] if is_scalar else values
