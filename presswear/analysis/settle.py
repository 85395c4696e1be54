"""Runs from spread starts until they settle; a folder stores them and they can be resumed."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.analysis.bifurcation import ENGINE, InitialState, Parameter
from presswear.analysis.final_motions import (
    FAILED,
    IRREGULAR,
    FinalMotions,
    FinalMotionsAt,
    Watch,
    evaluate,
)
from presswear.analysis.kicks import (
    STATES,
    Kick,
    least_kicks,
    states_of,
)
from presswear.analysis.pins import SpreadStarts, crossing_speeds, spread_starts
from presswear.engines.base import Plan, Start
from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.recording.observer import Observer
from presswear.recording.recorder import Recorder
from presswear.recording.settling import (
    PERIODS,
    REPEATED,
    settled_motion,
    signatures_of,
)
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.scene.scene import Scene
from presswear.scene.settings import changed
from presswear.tools.arrays import State, read_arrays, write_arrays
from presswear.tools.errors import InputError
from presswear.tools.files import only_writer
from presswear.tools.processes import Report, Workers, cores
from presswear.tools.serialize import plain, read_json, typed, write_json

FILE = "settling.json"
RUNS = "runs.npz"
KICKS = "kicks.json"
SCHEMA = 1
# Number of repeated cycles after which a run ends, over the number that a settled motion
# needs
WATCHED_TWICE = 2
KICKED = 4  # largest number of final motions for which kicks are tried
STARTS_SHARE = 0.9  # share of the starts in the progress; the kicks take the rest


class _UntilSettled(Observer):
    """Observer that ends a run after it has repeated for twice the required number of cycles."""

    def __init__(self, joints: Sequence[ClearanceJoint]) -> None:
        self._joints = joints

    def on_cycle(self, recorder: Recorder, state: Callable[[], State]) -> bool:
        count = len(recorder.cycles)
        if count < WATCHED_TWICE * REPEATED:
            return False
        motion = settled_motion(signatures_of(self._joints, recorder.cycles))
        if motion is None:
            return False
        return count - motion.start >= WATCHED_TWICE * max(REPEATED, 3 * motion.period)


def run_start(
    scene: Scene,
    starts: SpreadStarts,
    index: int,
    cycles: int,
    ideal: Start,
    report: Report,
) -> NDArray[Any]:
    """Return the row of one start, a record with the fields of ``_row``."""
    joints = scene.linkage().clearances
    plan = Plan(
        scene.mechanism.period,
        cycles,
        1,
        torques=False,
        observers=(_UntilSettled(joints),),
        report=lambda share, recorder: report(share),
    )
    linkage = scene.linkage()
    run = ENGINE.simulate(linkage, starts.start(index, linkage, ideal), plan)
    row = _row(len(joints), len(ideal.position))
    row["eccentricity"] = starts.eccentricity[index]
    row["velocity"] = starts.velocity[index]
    row["index"] = index
    row["cycles"] = len(run.recorder.cycles)
    if run.status == "failed":
        row["settled"] = FAILED
        return row
    signatures = signatures_of(joints, run.recorder.cycles)
    motion = settled_motion(signatures)
    row["end"] = run.end.position, run.end.velocity
    numbers = range(len(joints))
    force = np.array([run.recorder.each_cycle("force_max", k) for k in numbers])
    contacts = np.array([run.recorder.each_cycle("contacts", k) for k in numbers])
    first = STARTUP_CYCLES + (motion.start if motion else 0)
    row["peak_force"] = force[:, first:].mean(axis=1)
    row["contacts"] = contacts[:, first:].mean(axis=1)
    if motion is not None:
        row["settled"] = motion.start
        row["period"] = motion.period
        row["signature"] = motion.signature
        row["last"] = signatures[-PERIODS[-1] :]
    before = force[:, STARTUP_CYCLES : None if motion is None else motion.start]
    row["irregular_cycles"] = before.shape[1]
    if before.size:
        row["irregular_force"] = before.mean(axis=1)
    return row


def _row(joints: int, coordinates: int) -> NDArray[Any]:
    """Return an empty row of an irregular run."""
    fields: list[Any] = [
        ("index", int),  # number of the start
        # eccentricity of each pin at the start, m
        ("eccentricity", float, (joints, 2)),
        # velocity of each pin relative to its bearing, m/s
        ("velocity", float, (joints, 2)),
        ("cycles", int),  # number of cycles of the run
        ("settled", int),  # cycles before it settled, or IRREGULAR or FAILED
        ("period", int),  # period of the final motion, cycles; 0: irregular
        ("signature", float, 3 * joints),  # signature of the final motion
        ("last", float, (PERIODS[-1], 3 * joints)),  # signatures of the last cycles
        ("peak_force", float, joints),  # mean of the final motion after its start-up, N
        ("contacts", float, joints),  # mean of these cycles
        ("irregular_cycles", int),  # after the start-up and before the final motion
        ("irregular_force", float, joints),  # mean peak force in them, N
        ("end", float, (2, coordinates)),  # positions and velocities at the end
    ]
    row = np.zeros(1, fields)
    row["settled"] = IRREGULAR
    row["irregular_force"] = math.nan
    return row


def run_kicks(
    scene: Scene, runs: NDArray[Any], ideal: Start, report: Report
) -> list[Kick]:
    """Return the smallest kicks of the final motion of some runs, rows of ``run_start``."""
    linkage = scene.linkage()
    orbit = np.concatenate([run["last"][-int(run["period"]) :] for run in runs])
    states = states_of(linkage, [Start(*run["end"]) for run in runs], ideal)
    return least_kicks(linkage, states, orbit, crossing_speeds(scene), report)


class _Folder:
    """Finished runs and kicks in a folder, which is written after each of them."""

    def __init__(self, folder: Path, starts: int) -> None:
        self._folder = folder
        self._starts = starts
        self.rows: dict[tuple[int, int], NDArray[Any]] = {}  # by value and start
        self.kicks: dict[tuple[int, int], tuple[Kick, ...]] = {}  # by value and start
        if (folder / RUNS).exists():
            stored = read_arrays(folder / RUNS)
            keys = map(tuple, stored["keys"].tolist())
            self.rows = dict(zip(keys, stored["rows"], strict=True))
        if (folder / KICKS).exists():
            document = read_json(folder / KICKS, f"{folder} has no {KICKS}", SCHEMA)
            motions = typed(document["motions"], list[_Kicked], f"{folder / KICKS}")
            for motion in motions:
                self.kicks[motion.value, motion.start] = motion.kicks

    def add_row(self, value: int, row: NDArray[Any]) -> None:
        """Store a finished run."""
        self.rows[value, int(row["index"][0])] = row[0]
        keys = sorted(self.rows)
        rows = np.array([self.rows[key] for key in keys])
        arrays = {"keys": np.array(keys), "rows": rows}
        write_arrays(self._folder / RUNS, arrays, np.savez)

    def add_kicks(self, value: int, start: int, kicks: Sequence[Kick]) -> None:
        """Store the kicks of the final motion of a start."""
        self.kicks[value, start] = tuple(kicks)
        motions = [_Kicked(*key, stored) for key, stored in self.kicks.items()]
        write_json(self._folder / KICKS, {"schema": SCHEMA, "motions": motions})

    def settled(
        self, value: int, joints: tuple[str, ...], number: float | None
    ) -> FinalMotionsAt | None:
        """Return the final motions of the finished runs of a value; None without any."""
        keys = ((value, start) for start in range(self._starts))
        rows = [self.rows[key] for key in keys if key in self.rows]
        if not rows:
            return None
        runs = np.array(rows).view(np.recarray)
        kicks = {
            k: self.kicks[value, i]
            for k, i in enumerate(runs.index)
            if (value, i) in self.kicks
        }
        return evaluate(runs, joints, kicks, number)


@dataclass(frozen=True)
class _Kicked:
    value: int  # index
    start: int  # index
    kicks: tuple[Kick, ...]


def check(scene: Scene) -> None:
    """Raise InputError for a scene that has no final motions."""
    if not scene.clearance_joints:
        raise InputError("final motions need a joint with clearance: no motion is free")
    if scene.run_up > 0.0:
        raise InputError("final motions start at full speed: use --set run_up=0")
    for guide in scene.loose_guides:
        raise InputError(
            f"final motions: allowed is no clearance of {guide.name}: starts are spread over the "
            "clearances of pins"
        )
    scene.check_trusted()
    scene.check()


def compute(
    scene: Scene,
    watch: Watch,
    folder: Path,
    initial_state: InitialState,
    parameter: Parameter | None = None,
    jobs: int | None = None,
    on_progress: Callable[[str, float], None] = lambda step, share: None,
) -> FinalMotions:
    """Compute final motions in a folder, or resume those that the folder holds.

    Parameters
    ----------
    initial_state : callable
        Returns the start of a scene, such as
        ``presswear.campaign.replicates.start_of``.
    jobs : int, optional
        Number of processes; default: all cores.
    on_progress : callable
        Called with the present step and the completed share.

    Raises
    ------
    InputError
        If no joint has clearance, the mechanism runs up from rest, or the folder holds
        others.
    """
    check(scene)
    scenes = [scene]
    if parameter is not None:
        scenes = [changed(scene, {parameter.key: value}) for value in parameter.values]
    with only_writer(folder, resume=True):
        _store_inputs(folder, scene, watch, parameter)
        stored = _Folder(folder, watch.starts)
        ideals = [initial_state(variant) for variant in scenes]
        count = min(jobs or cores(), watch.starts * len(scenes))
        with Workers(count, (__name__,)) as workers:
            computation = _Computation(workers, stored, scenes, ideals, on_progress)
            computation.run_starts(watch)
            computation.run_kicks()
    return load(folder)


@dataclass(frozen=True)
class _Computation:
    """Runs and kicks that a folder lacks."""

    workers: Workers
    stored: _Folder
    scenes: Sequence[Scene]  # by value of the parameter
    ideals: Sequence[Start]  # initial states of these scenes without clearance
    on_progress: Callable[[str, float], None]

    def run_starts(self, watch: Watch) -> None:
        """Run from all starts that are not stored."""
        work: dict[int, Any] = {}
        for value, scene in enumerate(self.scenes):
            starts = spread_starts(scene, watch.starts)
            for index in range(watch.starts):
                if (value, index) not in self.stored.rows:
                    arguments = scene, starts, index, watch.cycles, self.ideals[value]
                    work[value * watch.starts + index] = partial(run_start, *arguments)
        total = watch.starts * len(self.scenes)
        remaining = len(work)

        def progress(*_: Any) -> None:
            done = total - remaining
            text = f"start {min(done + 1, total)} of {total}"
            self.on_progress(text, STARTS_SHARE * done / total)

        def finish(key: int, row: Any) -> Mapping[int, Any]:
            nonlocal remaining
            remaining -= 1
            self.stored.add_row(key // watch.starts, row)
            progress()
            return {}

        self.workers.run(work, finish, progress)

    def run_kicks(self) -> None:
        """Try the kicks of the final motions that are not stored."""
        work: dict[int, Any] = {}
        keys: list[tuple[int, int]] = []  # value and first start of each motion
        for value, scene in enumerate(self.scenes):
            settled = self.stored.settled(value, scene.clearance_joints, None)
            if settled is None:
                continue
            regular = [
                motion for motion in settled.motions if motion.period is not None
            ]
            for motion in regular[:KICKED]:
                runs = np.array(settled.runs[list(motion.runs[:STATES])])
                key = value, int(runs["index"][0])
                if key not in self.stored.kicks:
                    work[len(keys)] = partial(
                        run_kicks, scene, runs, self.ideals[value]
                    )
                    keys.append(key)
        shares = dict.fromkeys(work, 0.0)

        def progress(number: int, share: float, *_: Any) -> None:
            shares[number] = 0.0 if math.isnan(share) else share
            done = sum(shares.values()) / len(shares)
            self.on_progress("kicks", STARTS_SHARE + (1.0 - STARTS_SHARE) * done)

        def finish(number: int, kicks: Any) -> Mapping[int, Any]:
            self.stored.add_kicks(*keys[number], kicks)
            progress(number, 1.0)
            return {}

        self.workers.run(work, finish, progress)


def _store_inputs(
    folder: Path, scene: Scene, watch: Watch, parameter: Parameter | None
) -> None:
    """Write the inputs into a folder; raise InputError if it has other inputs.

    Only the number of starts may differ, because a larger number contains the starts of
    a smaller one.
    """
    inputs = {"scene": scene.as_dict(), "watch": watch, "parameter": parameter}
    if (folder / FILE).exists():
        document = _document(folder)
        document["watch"]["starts"] = watch.starts
        for name, value in plain(inputs).items():
            if document[name] != value:
                raise InputError(f"{folder} holds final motions with another {name}")
    write_json(folder / FILE, {"schema": SCHEMA, **inputs})


def load(folder: Path) -> FinalMotions:
    """Return stored final motions.

    Raises
    ------
    InputError
        If the folder has none, or a file was changed.
    """
    document = _document(folder)
    scene = Scene.from_dict(document["scene"])
    watch = typed(document["watch"], Watch, f"{folder / FILE}: watch")
    parameter = document["parameter"]
    if parameter is not None:
        parameter = typed(parameter, Parameter, f"{folder / FILE}: parameter")
    stored = _Folder(folder, watch.starts)
    numbers = [None] if parameter is None else parameter.values
    settled = []
    for k, value in enumerate(numbers):
        motions = stored.settled(k, scene.clearance_joints, value)
        if motions is not None:
            settled.append(motions)
    return FinalMotions(scene, watch, parameter, tuple(settled))


def _document(folder: Path) -> dict[str, Any]:
    return read_json(
        folder / FILE, f"{folder} holds no final motions: it has no {FILE}", SCHEMA
    )
