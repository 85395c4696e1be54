"""The whole study of costs, and what is stored of it."""

import json
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, BinaryIO

from presswear.results.provenance import provenance
from presswear.results.result import plain
from presswear.scene.scene import Scene
from presswear.tools.files import write_whole
from presswear.trials.costs.equal_work import EngineRow, EqualWork, equal_work
from presswear.trials.costs.features import FeatureTable, deepest, feature_table, wear_once
from presswear.trials.costs.profile import Profile, profile
from presswear.trials.costs.timing import Progress, Timing, case_of

SCHEMA = 1


@dataclass(frozen=True)
class Extent:
    """How long a study of costs runs.

    Attributes
    ----------
    repeats : int
        Of every run; half as many, but two, of those with bodies and joints in the tables of
        features.
    tree_cycles, joints_cycles, profile_cycles : float
        Simulated time of the runs, cycles; whole, or below 1.
    wear_cycles : int
        Cycles whose wear makes the worn surfaces.
    equal_time : float
        Simulated time of the engines at equal work, s.
    """

    repeats: int = 5
    tree_cycles: float = 2.0
    joints_cycles: float = 1.0
    profile_cycles: float = 2.0
    wear_cycles: int = 5
    equal_time: float = 0.05

    @property
    def joints_repeats(self) -> int:
        """Of the runs with bodies and joints in the tables of features."""
        return min(self.repeats, max(2, (self.repeats + 1) // 2))


QUICK = Extent(repeats=2, tree_cycles=0.25, joints_cycles=0.1, profile_cycles=0.25, wear_cycles=1)
"""Well below a minute; too short for ratios near 1."""

_PARTS = {"chosen": 0.17, "tree": 0.15, "joints": 0.3, "engines": 0.08, "unworn": 0.1, "worn": 0.2}
"""Parts of the study's time, roughly: what progress goes by."""


@dataclass(frozen=True)
class Costs:
    """A study of costs.

    Attributes
    ----------
    scene : Scene
    extent : Extent
    processor : str
    deepest : dict
        Deepest wear of each joint on the worn surfaces, bearing and pin together, m.
    tables : tuple of FeatureTable
    engines : EqualWork
    profiles : dict of Profile
        Of the open tree, ``unworn`` and ``worn``.
    """

    scene: Scene
    extent: Extent
    processor: str
    deepest: Mapping[str, float]
    tables: tuple[FeatureTable, ...]
    engines: EqualWork
    profiles: Mapping[str, Profile]


def processor_name() -> str:
    """What the operating system calls the processor."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or "unknown"


def study(scene: Scene, extent: Extent, progress: Progress) -> Costs:
    """Measure what the features of a scene cost, how engines compare, where time goes.

    Raises
    ------
    RunFailed
        Where a run fails.
    """

    def part_of(section: str) -> Progress:
        names = list(_PARTS)
        before = sum(_PARTS[name] for name in names[: names.index(section)])

        def told(name: str, part: float) -> None:
            progress(f"{section}: {name}", before + _PARTS[section] * part)

        return told

    progress("wear of the worn surfaces", 0.0)
    worn = wear_once(scene, extent.wear_cycles)
    tree, joints = extent.tree_cycles, extent.joints_cycles
    tables = (
        feature_table(scene, "chosen", worn, tree, extent.repeats, part_of("chosen")),
        feature_table(scene, "tree", worn, tree, extent.repeats, part_of("tree")),
        feature_table(scene, "joints", worn, joints, extent.joints_repeats, part_of("joints")),
    )
    engines = equal_work(scene, extent.equal_time, extent.repeats, part_of("engines"))
    profiles = {
        name: profile(
            case_of(name, scene, extent.profile_cycles, surfaces), extent.repeats, part_of(name)
        )
        for name, surfaces in (("unworn", None), ("worn", worn))
    }
    progress("done", 1.0)
    return Costs(scene, extent, processor_name(), deepest(worn), tables, engines, profiles)


def _timing(timing: Timing) -> dict[str, Any]:
    return {
        **asdict(timing),
        "wall_per_simulated_second": timing.per_second,
        "wall_per_step_s": timing.per_step,
    }


def _engine(row: EngineRow) -> dict[str, Any]:
    return {
        **_timing(row.timing),
        "slider_error_m": row.slider_error,
        "touch_error_s": row.touch_error,
        "times_faster": row.faster,
    }


def document_of(costs: Costs) -> dict[str, Any]:
    """The study as plain data: every wall time, and what follows from them."""
    engines = costs.engines
    return {
        "schema": SCHEMA,
        "scene": costs.scene.as_dict(),
        "provenance": provenance(),
        "processor": costs.processor,
        "extent": asdict(costs.extent),
        "deepest_wear_m": dict(costs.deepest),
        "features": [
            {
                "title": table.title,
                "rows": [
                    {
                        "feature": row.feature,
                        "state": row.state,
                        **_timing(row.timing),
                        "step_ratio": row.step_ratio,
                        "wall_ratio": row.wall_ratio,
                    }
                    for row in table.rows
                ],
            }
            for table in costs.tables
        ],
        "engines": {
            "simulated_s": engines.duration,
            "touches": engines.touches,
            "passed": engines.passed,
            "rows": [_engine(row) for row in engines.rows],
        },
        "profiles": {
            name: {
                **_timing(found.timing),
                "evaluations": found.evaluations,
                "python_share": found.share_of("Python"),
                "python_and_kernels_share": found.share_of("Python", "kernel"),
                "stages": [
                    {**asdict(stage), "share": found.share(stage.seconds)} for stage in found.stages
                ],
            }
            for name, found in costs.profiles.items()
        },
    }


def store(costs: Costs, markdown: str, folder: Path) -> None:
    """Write ``costs.json`` and ``costs.md`` into a folder, which is made where needed."""
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps(plain(document_of(costs)), indent=1, allow_nan=False)
    for name, content in (("costs.json", text), ("costs.md", markdown)):
        whole = content.encode()

        def write(file: BinaryIO, whole: bytes = whole) -> None:
            file.write(whole)

        write_whole(folder / name, write)
