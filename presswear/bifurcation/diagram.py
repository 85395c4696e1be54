"""A bifurcation diagram: two branches over a quantity, kept in a folder and gone on with."""

from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.bifurcation.branch import PHASES, Branch, Points, read_points
from presswear.bifurcation.over import Extent, Over
from presswear.dynamics.period import TOLERANCE, Periodicity, periodicity
from presswear.scene.scene import Scene
from presswear.tools.documents import plain, read_sealed, sealed_json, typed
from presswear.tools.errors import InputError
from presswear.tools.files import write_bytes
from presswear.tools.folders import FolderLock
from presswear.tools.workers import Job, cores, workers_for

Array = NDArray[np.float64]

FILE = "diagram.json"
SCHEMA = 2
WAYS = ("up", "down")
"""The branches: with rising and with falling values."""


@dataclass(frozen=True)
class Diagram:
    """A diagram, as far as it has been computed.

    Attributes
    ----------
    scene : Scene
    over : Over
    extent : Extent
    branches : dict
        Points by ``WAYS``; none of one that has not begun.
    """

    scene: Scene
    over: Over
    extent: Extent
    branches: dict[str, Points]

    def periods(self, way: str) -> list[Periodicity | None]:
        """Periods of the places of the pins at the values of a branch; None where a run failed."""
        points = self.branches[way]
        names = self.scene.clearance_joints
        found: list[Periodicity | None] = []
        for k, value in enumerate(points.value):
            places = [points.eccentricity(j)[k] for j in range(len(names))]
            scales = [np.full(2 * len(PHASES), self._clearance(name, value)) for name in names]
            states = np.concatenate([place.reshape(len(place), -1) for place in places], axis=1)
            is_known = not np.isnan(states).any()
            found.append(periodicity(states, np.concatenate(scales)) if is_known else None)
        return found

    def _clearance(self, joint: str, value: float) -> float:
        """Clearance of a joint at a value, m."""
        is_varied = self.over.key in ("clearance", f"{joint}.clearance")
        return value if is_varied else self.scene.bearing(joint).clearance

    @property
    def words(self) -> list[str]:
        """What was found, in sentences whose numbers are those of the branches."""
        told = []
        for way, points in self.branches.items():
            periods = self.periods(way)
            known = [own for own in periods if own is not None]
            regular = [own for own in known if own.period is not None]
            chaotic = int(np.sum(points.exponent[:, 0] - points.exponent[:, 1] > 0.0))
            counts = {k: sum(own.period == k for own in regular) for k in _periods_of(regular)}
            listed = ", ".join(f"period {k} at {n}" for k, n in counts.items())
            sentence = (
                f"{way}: of {len(periods)} values the motion repeats itself within "
                f"{100.0 * TOLERANCE:g} % of the clearance, in {self.extent.kept} cycles, at "
                f"{len(regular)}"
            )
            sentence += f" ({listed})" if listed else ""
            if self.extent.exponent_cycles:
                sentence += f"; the exponent is above 0, with its interval, at {chaotic}"
            failed = len(periods) - len(known)
            sentence += f"; {failed} runs failed" if failed else ""
            told.append(f"{sentence}.")
        return told


def _periods_of(known: list[Periodicity]) -> Iterator[int]:
    yield from sorted({own.period for own in known if own.period is not None})


def compute(
    scene: Scene,
    over: Over,
    extent: Extent,
    folder: Path,
    jobs: int | None,
    told: Callable[[str, float], None],
) -> Diagram:
    """Compute a diagram in a folder, or go on with what stands there.

    Each branch is one chain of runs, so that two processes do all of it.

    Parameters
    ----------
    jobs : int or None
        Processes; None: as many as there are cores.
    told : callable
        Hears of the way and the part of it that is done.

    Raises
    ------
    InputError
        Where another diagram stands in the folder, or a scene is none at some value.
    """
    if not scene.clearance_joints:
        raise InputError("a diagram needs a joint with clearance")
    scene.check_trusted()
    document = _document(scene, over, extent)
    lock = FolderLock(folder)
    try:
        if (folder / FILE).exists():
            stored = _stored(folder)
            for name, own in plain(document).items():
                if stored[name] != own:
                    raise InputError(f"{folder} holds a diagram with another {name}")
        else:
            write_bytes(folder / FILE, sealed_json(document))
        ways = dict(zip(WAYS, (over.values, over.values[::-1]), strict=True))
        work: dict[int, Job] = {
            k: Branch(scene, over, own, extent, folder / f"{way}.npz")
            for k, (way, own) in enumerate(ways.items())
        }
        with workers_for(min(jobs or cores(), len(work)), (__name__,)) as workers:
            workers.run(
                work,
                lambda key, outcome: {},
                lambda key, done, word, rows: told(WAYS[key], done),
            )
    finally:
        lock.release()
    return load(folder)


def load(folder: Path) -> Diagram:
    """Read a diagram from its folder; InputError where there is none, or it was altered."""
    stored = _stored(folder)
    files = {way: folder / f"{way}.npz" for way in WAYS}
    return Diagram(
        Scene.from_dict(stored["scene"]),
        typed(stored["over"], Over, f"{folder / FILE}: over"),
        typed(stored["extent"], Extent, f"{folder / FILE}: extent"),
        {way: read_points(file) for way, file in files.items() if file.exists()},
    )


def _document(scene: Scene, over: Over, extent: Extent) -> dict[str, Any]:
    return {
        "schema": SCHEMA,
        "scene": scene.as_dict(),
        "over": asdict(over),
        "extent": asdict(extent),
    }


def _stored(folder: Path) -> dict[str, Any]:
    missing = f"{folder} holds no diagram: it has no {FILE}"
    return read_sealed(folder / FILE, missing, SCHEMA)
