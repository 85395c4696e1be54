"""The methods whose statistics are compared, and how a method is stored."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

from presswear.engines.settings import Engine, ExudynJoints, ExudynTree, InHouse
from presswear.physics.tree import Tree, tree_of
from presswear.scene.scene import Numerics, Scene
from presswear.trials.precision.points import Method

TREE_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
CONTROLLED_TOLERANCES = (1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9)
EQUAL_STEPS = (8e-5, 5e-5, 2e-5)
"""s."""
INTEGRATORS = {"dop853": "DOP853", "dopri5": "DOPRI5", "rk4": "RK4", "rk4-paper": "RK4"}
"""What people call them."""


def tree_method(accuracy: ExudynTree) -> Method:
    """The open tree at an accuracy."""
    return Method("exudyn-tree", "DOPRI5", "tolerance", accuracy.tree_tolerance, accuracy)


def dae_method(accuracy: InHouse) -> Method:
    """The in-house solver at an accuracy."""
    name = INTEGRATORS[accuracy.integrator]
    if not accuracy.has_equal_steps:
        return Method("dae", name, "tolerance", accuracy.integration_tolerance, accuracy)
    is_paper = accuracy.integrator == "rk4-paper"
    return Method("dae", name, "step (s)", accuracy.step, accuracy, is_paper=is_paper)


def ladder(scene: Scene) -> tuple[Method, ...]:
    """Methods for statistics of a scene, each family from coarse to fine, the paper's last."""
    numerics, period = scene.numerics, scene.mechanism.period
    found: list[Method] = []
    if isinstance(tree_of(scene.linkage()), Tree):
        tree = numerics.tree.over(period)
        values = sorted({*TREE_TOLERANCES, ExudynTree().tree_tolerance}, reverse=True)
        found += [tree_method(replace(tree, tree_tolerance=value)) for value in values]
    dae = numerics.dae
    values = sorted({*CONTROLLED_TOLERANCES, InHouse().integration_tolerance}, reverse=True)
    found += [
        dae_method(replace(dae, integrator=name, integration_tolerance=value))
        for name in ("dop853", "dopri5")
        for value in values
    ]
    found += [dae_method(replace(dae, integrator="rk4", equal_step=value)) for value in EQUAL_STEPS]
    found.append(dae_method(replace(dae, integrator="rk4-paper")))
    return tuple(replace(method, is_default=is_default(method, period)) for method in found)


def finest(scene: Scene) -> Method:
    """The method that the others are compared with."""
    accuracy = replace(
        scene.numerics.dae, integrator="dop853", integration_tolerance=REFERENCE_TOLERANCE
    )
    return dae_method(accuracy)


REFERENCE_TOLERANCE = CONTROLLED_TOLERANCES[-1]


def is_default(method: Method, period: float) -> bool:
    """Whether a scene with a cycle of a period, s, takes a method by itself for its engine."""
    numerics = Numerics()
    if isinstance(method.accuracy, ExudynTree):
        return method.accuracy == numerics.tree.over(period)
    if isinstance(method.accuracy, ExudynJoints):
        return method.accuracy == numerics.joints.over(period)
    return method.accuracy == numerics.dae


_KINDS: dict[str, type[Engine]] = {
    "exudyn-tree": ExudynTree,
    "exudyn-joints": ExudynJoints,
    "dae": InHouse,
}


def method_as_dict(method: Method) -> dict[str, Any]:
    """A method as plain data."""
    return asdict(method)


def method_from_dict(data: Mapping[str, Any]) -> Method:
    """A method from ``method_as_dict``."""
    plain = dict(data)
    accuracy = _KINDS[plain["engine"]](**plain.pop("accuracy"))
    return Method(accuracy=accuracy, **plain)
