"""The whole study of costs, and the files that hold it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from presswear.engines.settings import ExudynJoints, ExudynTree
from presswear.results.provenance import Provenance, provenance
from presswear.scene.scene import Scene
from presswear.tools.files import write_bytes
from presswear.trials.costs.equal_work import EqualWork, equal_work
from presswear.trials.costs.features import (
    FeatureTable,
    clearance_rows,
    deepest,
    switched_rows,
    timed_run,
    wear_once,
)
from presswear.trials.costs.profile import Profile, profile
from presswear.trials.runs import Told, part_of, parts_of
from presswear.trials.stored import processor_name, write_document

SCHEMA = 3


@dataclass(frozen=True)
class CostsExtent:
    """Lengths of the runs of a study of costs.

    Attributes
    ----------
    repeats : int
        Repeats of every run; half as many, but two, of those with bodies and joints in the
        tables of features.
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
        """Repeats of the runs with bodies and joints in the tables of features."""
        return min(self.repeats, max(2, (self.repeats + 1) // 2))


QUICK = CostsExtent(
    repeats=2, tree_cycles=0.25, joints_cycles=0.1, profile_cycles=0.25, wear_cycles=1
)
"""Well below a minute; too short for ratios near 1."""

_SECTIONS = {"chosen": 17, "tree": 15, "joints": 30, "engines": 8, "unworn": 10, "worn": 20}
"""Parts of the study's time, per cent, roughly: what progress goes by."""


@dataclass(frozen=True)
class Costs:
    """A study of costs.

    Attributes
    ----------
    deepest : dict
        Deepest wear of each joint on the worn surfaces, bearing and pin together, m.
    profiles : dict of Profile
        Those of the open tree, ``unworn`` and ``worn``.
    """

    scene: Scene
    provenance: Provenance
    processor: str
    extent: CostsExtent
    deepest: Mapping[str, float]
    features: tuple[FeatureTable, ...]
    engines: EqualWork
    profiles: Mapping[str, Profile]


def study(scene: Scene, extent: CostsExtent, told: Told) -> Costs:
    """Measure what the features of a scene cost, how engines compare, where time goes.

    RunFailed where a run fails.
    """
    parts, source = parts_of(told, _SECTIONS), provenance()
    told("wear of the worn surfaces", 0.0)
    worn = wear_once(scene, extent.wear_cycles)
    tree, joints = (replace(scene, engine=each.word) for each in (ExudynTree, ExudynJoints))
    many, repeats = (extent.tree_cycles, extent.repeats), extent.repeats
    few = extent.joints_cycles, extent.joints_repeats
    first, second = (part_of(parts["joints"], start, 0.5) for start in (0.0, 0.5))
    features = (
        FeatureTable(
            "Clearance, in the model that Exudyn gets for each",
            clearance_rows(scene, *many, parts["chosen"]),
        ),
        FeatureTable(
            "Features, clearance at A and C, open tree",
            switched_rows(tree, worn, *many, parts["tree"]),
        ),
        FeatureTable(
            "Features, bodies and joints",
            clearance_rows(joints, *few, first) + switched_rows(joints, worn, *few, second),
        ),
    )
    engines = equal_work(scene, extent.equal_time, repeats, parts["engines"])
    profiles = {
        name: profile(timed_run(name, scene, extent.profile_cycles, surfaces), repeats, parts[name])
        for name, surfaces in (("unworn", None), ("worn", worn))
    }
    told("done", 1.0)
    return Costs(
        scene, source, processor_name(), extent, deepest(scene, worn), features, engines, profiles
    )


def store(costs: Costs, markdown: str, folder: Path) -> None:
    """Write ``costs.json`` and ``costs.md`` into a folder, which is made where needed."""
    write_document(folder, "costs.json", SCHEMA, costs)
    write_bytes(folder / "costs.md", markdown.encode())
