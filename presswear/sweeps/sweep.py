"""A sweep in its folder: the plan, what is measured, and the table of what came out.

The folder holds ``sweep.json``, and the folders that ``store`` describes.
"""

from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

import numpy as np

from presswear.results.provenance import (
    Provenance,
    program_digest,
    provenance,
    provenance_differs,
)
from presswear.scene.catalog import title_of
from presswear.scene.scene import Scene
from presswear.sweeps.cluster import Say
from presswear.sweeps.executors import runner_of
from presswear.sweeps.measures import Asked, Own, at_last, measures_asked
from presswear.sweeps.plan import Plan
from presswear.sweeps.run import Gate, Standing, run_rows
from presswear.sweeps.spread import Required, requirements
from presswear.sweeps.store import RUNS, Records, Store, can_begin
from presswear.sweeps.table import NOT_RUN, Column, Table
from presswear.sweeps.text import counts_of, lines_of
from presswear.sweeps.values import texts_of
from presswear.sweeps.work import SceneWork
from presswear.tools.documents import plain, read_json, typed, write_shared_json
from presswear.tools.errors import InputError
from presswear.tools.files import inside

FILE = "sweep.json"
SCHEMA = 1
KEEP = ("measures", "all")
LONG = 3600.0
"""Time above which a sweep is to be asked for twice, s."""
_SHOWN = 20
"""Rows of a table in a terminal."""


@dataclass(frozen=True)
class StoredSweep:
    """The whole of ``sweep.json``; the plan is checked by ``Plan`` itself."""

    plan: dict[str, Any]
    columns: tuple[Column, ...]
    keys: tuple[str, ...]
    dear: tuple[str, ...]
    further: str
    is_own: bool
    keep: Literal["measures", "all"]
    program: str
    provenance: Provenance
    required: tuple[str, ...] = ()


@dataclass(frozen=True)
class Sweep:
    """A plan, what is measured and required, and the folder of the runs.

    Attributes
    ----------
    plan : Plan
    asked : Asked
    path : Path
    keep : str
        ``measures``, or ``all`` for whole results.
    program : str
        Digest of the program that computes, or computed, the numbers.
    required : tuple of str
        What measures are not to miss, as typed, such as ``"life>=2e6"``.
    """

    plan: Plan
    asked: Asked
    path: Path
    keep: str = KEEP[0]
    program: str = field(default_factory=program_digest)
    required: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """InputError names what cannot be required."""
        _ = self.requirements

    @cached_property
    def requirements(self) -> dict[str, Required]:
        """What measures are not to miss, by key."""
        return requirements(self.required, self.asked.columns)

    @property
    def work(self) -> SceneWork:
        """Its rows as work."""
        folder = self.path.resolve() if self.keep == "all" else None
        return SceneWork(self.plan, self.asked, self.program, folder)

    @cached_property
    def table(self) -> Table:
        """What was varied and measured, a row a run, as far as it is sealed."""
        records = Records(self.path)
        records.refresh()
        try:
            return table_of(self.plan, self.asked, self.work.shortcut, records)
        finally:
            records.close()

    def report(self) -> Path:
        """Write figures and report of what has run into its folder; gives the page."""
        # Slow to import.
        from presswear.sweeps.report import write_report

        plan = self.plan
        return write_report(
            self.table,
            self.path,
            f"Sweep: {title_of(plan.scene)}",
            sample=plan.sample.partition(":")[0],
            crossed=plan.crossed,
            distributions=plan.distributions,
            required=self.requirements,
        )

    def __str__(self) -> str:
        """The first rows of its table, and how many there are."""
        lines = lines_of(self.table, _SHOWN)
        widths = [max(map(len, cells)) for cells in zip(*lines, strict=True)]
        told = [
            "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
            for line in lines
        ]
        return "\n".join([*told, counts_of(self.table, self.path)])


def table_of(plan: Plan, asked: Asked, shortcut: Callable[[int], str], records: Records) -> Table:
    """The table of a plan from the records that there are.

    Parameters
    ----------
    shortcut : callable
        Gives the digest under which a row is found.
    """
    rows, measures = plan.rows, len(asked.keys)
    points = np.empty((rows, len(plan.columns)))
    values, halves = (np.full((rows, measures), np.nan) for _ in range(2))
    is_beyond = np.zeros((rows, measures), dtype=bool)
    reasons = []
    for row in range(rows):
        points[row] = plan.point(row)
        record = records.get(shortcut(row))
        reasons.append(NOT_RUN if record is None else record.reason)
        if record is not None and not record.reason:
            for k, key in enumerate(asked.keys):
                found = record.values.get(at_last(key, record.stages))
                if found is not None:
                    value, half, is_beyond[row, k] = found
                    values[row, k] = np.nan if value is None else value
                    halves[row, k] = np.nan if half is None else half
    draws = np.arange(rows) % plan.draws
    return Table(
        plan.columns, asked.columns, points, values, halves, is_beyond, draws, tuple(reasons)
    )


def is_sweep(folder: Path) -> bool:
    """True where a folder is that of a sweep."""
    return (folder / FILE).exists()


def load_sweep(folder: Path) -> Sweep:
    """The sweep of a folder; InputError says what is wrong with it."""
    stored = _stored(folder)
    asked = Asked(stored.columns, stored.keys, stored.dear, (), stored.further)
    try:
        plan = Plan.from_dict(stored.plan)
    except (KeyError, TypeError) as error:
        raise InputError(f"{folder / FILE}: this is no plan: {error}") from None
    return Sweep(plan, asked, folder, stored.keep, stored.program, stored.required)


def _stored(folder: Path) -> StoredSweep:
    file = folder / FILE
    data = read_json(file, f"{folder} is no folder of a sweep: it has no {FILE}", SCHEMA)
    return typed(data, StoredSweep, f"{file}")


def begun(sweep: Sweep, resume: bool, is_shared: bool = False) -> Sweep:
    """A sweep whose folder may be written into, as it runs there.

    Parameters
    ----------
    resume : bool
        True: the folder may hold a sweep; another one is widened to this.
    is_shared : bool
        True: it may hold this very sweep, which others have begun.

    Raises
    ------
    InputError
        Where the folder holds something and nothing is to be resumed, or anything but a sweep, or
        measures of one's own that are not given again.
    """
    if can_begin(sweep.path):
        return sweep
    if not resume and not is_shared:
        raise InputError(
            f"--out {sweep.path}: it exists and is not empty; name a new one or --resume"
        )
    stored = _stored(sweep.path)
    if not resume and stored.plan != plain(sweep.plan.as_dict()):
        raise InputError(f"--out {sweep.path}: it holds another sweep; --resume widens it to this")
    if stored.is_own and not sweep.asked.own and sweep.asked.further == stored.further:
        raise InputError(
            f"{sweep.path} has measures of one's own: the script that gave them goes on with it"
        )
    return replace(sweep, program=program_digest())


def run_sweep(
    sweep: Sweep,
    on: str = "",
    jobs: int | None = None,
    shard: tuple[int, int] = (1, 1),
    told: Callable[[Standing], None] = lambda standing: None,
    gate: Gate | None = None,
    say: Say = lambda line: None,
) -> Standing:
    """Run what is not sealed of a sweep.

    Parameters
    ----------
    on : str
        What does the rows; see ``executors``.
    shard : tuple of int
        Which part of how many, from 1: every so many-th row.
    told, gate : callable
        See ``run_rows``.
    say : callable
        Told lines for the person who waits.
    """
    sweep.plan.scene.check_trusted()
    inside(sweep.path, RUNS)
    runner = runner_of(on, jobs, say)
    if is_sweep(sweep.path):
        other = provenance_differs(_stored(sweep.path).provenance, provenance())
        if other:
            say(f"{sweep.path} was begun by another program ({other}): its runs run anew")
    with Store(sweep.path) as store:
        if store.warning:
            say(store.warning)
        if store.damaged:
            say(f"{store.damaged} records are cut off or altered: these rows run again")
        rows = range(shard[0] - 1, sweep.plan.rows, shard[1])
        return run_rows(sweep.work, store, runner, rows, told, gate, lambda: _write(sweep))


def _write(sweep: Sweep) -> None:
    """Write ``sweep.json``; several processes may at once."""
    asked = sweep.asked
    document = {
        "schema": SCHEMA,
        "plan": sweep.plan.as_dict(),
        "columns": [asdict(own) for own in asked.columns],
        "keys": asked.keys,
        "dear": asked.dear,
        "further": asked.further,
        "is_own": bool(asked.own),
        "required": list(sweep.required),
        "keep": sweep.keep,
        "program": sweep.program,
        "provenance": provenance(),
    }
    write_shared_json(sweep.path / FILE, document)


def shard_given(text: str) -> tuple[int, int]:
    """Read a part ``K/N``; InputError where it is none."""
    part, slash, of = text.partition("/")
    are_counts = all(own.isascii() and own.isdigit() and len(own) < 8 for own in (part, of))
    if not (slash and are_counts and 1 <= int(part) <= int(of)):
        raise InputError(f"--shard {text}: K/N is expected, K from 1 to N, such as 3/10")
    return int(part), int(of)


def sweep(
    scene: Scene,
    vary: Any = None,
    folder: str | Path = "",
    measures: Sequence[str | Own] = (),
    sample: str = "",
    ranges: Any = None,
    draws: int = 1,
    seed: int = 0,
    keep: str = KEEP[0],
    on: str = "",
    jobs: int | None = None,
    shard: str = "1/1",
    required: Sequence[str] = (),
    say: Say = print,
) -> Sweep:
    """Run a scene at many points, or go on with that; what stands in its folder is not run again.

    Parameters
    ----------
    scene : Scene
        What is not varied.
    vary : mapping
        Values by key: as typed, ``"0.2mm:1.0mm:9"``, or a list of numbers, SI, or words.
    folder : path
        Where its runs are kept; runs of other plans may stand in it.
    measures : sequence of str or callable
        Such as ``"A.force_max"``, or functions of a ``Result`` that give a number; none: all
        usual ones.
    sample : str
        A design, such as ``"sobol:512"``, of what ``ranges`` says.
    ranges : mapping of str to str
        Distributions by key, such as ``"normal(0.8mm, 0.05mm)"``.
    draws : int
        Independent runs at each point.
    seed : int
        Of the design.
    keep : {"measures", "all"}
        What is kept of each run: its numbers, or its whole result.
    on : str
        What does the runs: processes of this machine, ``dask``, ``dask://HOST:PORT`` or
        ``MODULE:FACTORY``.
    jobs : int or None
        Runs at a time here; None: as many as there are cores.
    shard : str
        ``K/N``: every N-th row, from the K-th.
    required : sequence of str
        What measures are not to miss, such as ``"life>=2e6"``: the report tells how probable that
        is.
    say : callable
        Told lines for the person who waits: where the dashboard of Dask is, what was lost.

    Returns
    -------
    Sweep
        With its ``table``, and a ``report`` that it writes.

    Raises
    ------
    InputError
        Before anything runs, for what is unknown, empty or out of range.
    RunFailed
        Where what does the runs is lost again and again.  A run that fails is a row.
    """
    if f"{folder}" == "":
        raise InputError("folder: a sweep needs a folder for its runs")
    if keep not in KEEP:
        raise InputError(f"keep = {keep!r}: allowed is one of {', '.join(KEEP)}")
    plan = Plan(
        scene,
        texts_of(scene, vary or {}),
        sample,
        tuple(f"{key}={text}" for key, text in (ranges or {}).items()),
        draws,
        seed,
    )
    asked = measures_asked(plan.example, list(measures))
    own = Sweep(plan, asked, Path(folder), keep, required=tuple(required))
    found = begun(own, resume=True)
    run_sweep(found, on, jobs, shard_given(shard), say=say)
    return found
