"""The whole study of costs, and the files that hold it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from presswear.engines.settings import ExudynJoints, ExudynTree
from presswear.results.provenance import Provenance, provenance
from presswear.scene.scene import Scene
from presswear.tools.files import write_bytes
from presswear.validation.costs.features import (
    FeatureTable,
    clearance_rows,
    deepest,
    switched_rows,
    wear_once,
)
from presswear.validation.costs.side_by_side import SideBySide, side_by_side
from presswear.validation.runs import Told, part_of, parts_of
from presswear.validation.stored import processor_name, write_document

SCHEMA = 4


@dataclass(frozen=True)
class CostsExtent:
    """Lengths of the runs of a study of costs.

    Attributes
    ----------
    repeats : int
        Repeats of every run; half as many, but two, of those with bodies and joints in the
        tables of features.
    tree_cycles, joints_cycles : float
        Simulated time of the runs of features, cycles; whole, or below 1.
    wear_cycles : int
        Cycles whose wear makes the worn surfaces.
    short : float
        Simulated time up to which trajectories are compared side by side, s.
    long : float
        Cycles of the other task there.
    """

    repeats: int = 5
    tree_cycles: float = 2.0
    joints_cycles: float = 1.0
    wear_cycles: int = 5
    short: float = 0.05
    long: float = 2.0

    @property
    def joints_repeats(self) -> int:
        """Repeats of the runs with bodies and joints in the tables of features."""
        return min(self.repeats, max(2, (self.repeats + 1) // 2))


QUICK = CostsExtent(repeats=2, tree_cycles=0.25, joints_cycles=0.1, wear_cycles=1, long=1.0)
"""About two minutes; too short for ratios near 1."""

_SECTIONS = {"side by side": 55, "chosen": 14, "tree": 11, "joints": 20}
"""Parts of the study's time, per cent, roughly: what progress goes by."""


@dataclass(frozen=True)
class Costs:
    """A study of costs.

    Attributes
    ----------
    deepest : dict
        Deepest wear of each joint on the worn surfaces, bearing and pin together, m.
    """

    scene: Scene
    provenance: Provenance
    processor: str
    extent: CostsExtent
    deepest: Mapping[str, float]
    side_by_side: SideBySide
    features: tuple[FeatureTable, ...]


def study(scene: Scene, extent: CostsExtent, told: Told) -> Costs:
    """Measure engines and peers at the same work, and what the features of a scene cost.

    RunFailed where a run fails.
    """
    parts, source = parts_of(told, _SECTIONS), provenance()
    beside = side_by_side(scene, extent.short, extent.long, extent.repeats, parts["side by side"])
    parts["chosen"]("wear of the worn surfaces", 0.0)
    worn = wear_once(scene, extent.wear_cycles)
    tree, joints = (replace(scene, engine=each.word) for each in (ExudynTree, ExudynJoints))
    many = extent.tree_cycles, extent.repeats
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
    told("done", 1.0)
    depths = deepest(scene, worn)
    return Costs(scene, source, processor_name(), extent, depths, beside, features)


def store(costs: Costs, markdown: str, folder: Path) -> None:
    """Write ``costs.json`` and ``costs.md`` into a folder, which is made where needed."""
    write_document(folder, "costs.json", SCHEMA, costs)
    write_bytes(folder / "costs.md", markdown.encode())
