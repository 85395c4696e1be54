"""How finely each engine integrates: what a scene can choose."""

from dataclasses import dataclass

from presswear.engines.base import DaeAccuracy, Integrator, JointsAccuracy, TreeAccuracy
from presswear.quantities import check_fields, choice, quantity


@dataclass(frozen=True)
class Numerics:
    """Steps and tolerances of all engines; each uses its own.

    Chosen from ``presswear precision``: the coarsest that keep the bounds of the cross-check up
    to the horizon (slider to 1e-6 m, touches to 1e-6 s); for the open tree and the in-house
    solver a decade finer, which costs them a fifth.  The in-house solver takes order 8, at twice
    the price of order 5, because it checks Exudyn's DOPRI5.
    """

    tree_tolerance: float = quantity(
        1e-8,
        "",
        1e-13,
        1e-3,
        "chosen",
        "of exudyn-tree: error of a step, rad or m and rad/s or m/s",
    )
    steps_per_contact: int = quantity(
        200, "", 20, 10_000, "chosen", "of exudyn-joints: steps in one impact", whole=True
    )
    steps_sustained: int = quantity(
        10,
        "",
        5,
        10_000,
        "chosen",
        "of exudyn-joints: least steps in half a period of a pin at rest on its bearing",
        whole=True,
    )
    free_steps: int = quantity(
        10_000,
        "",
        1000,
        10_000_000,
        "chosen",
        "of exudyn-joints: least steps in a cycle",
        whole=True,
    )
    integrator: Integrator = choice(
        "dop853",
        ("dop853", "dopri5", "rk4", "rk4-paper"),
        "of dae: order 8 or 5 with located touches, 4 at equal steps, the paper's 1e-4 s",
    )
    integration_tolerance: float = quantity(
        1e-9,
        "",
        1e-14,
        1e-3,
        "chosen",
        "of dae with dop853 and dopri5: error of a step, times 1 mm and 1 m/s + speed",
    )
    equal_step: float = quantity(1e-5, "s", 1e-9, 1e-2, "chosen", "of dae with rk4: its step")
    projection: str = choice(
        "off", ("off", "on"), "of dae: whether each state is moved onto the constraints"
    )

    def __post_init__(self) -> None:
        check_fields(self)

    def tree(self, period: float) -> TreeAccuracy:
        """Of the open tree in Exudyn, for a cycle of a period, s."""
        return TreeAccuracy(self.tree_tolerance, period / LEAST_TREE_STEPS)

    def joints(self, period: float) -> JointsAccuracy:
        """Of bodies and joints in Exudyn."""
        return JointsAccuracy(
            steps_per_contact=self.steps_per_contact,
            steps_sustained=self.steps_sustained,
            free_step=period / self.free_steps,
        )

    def dae(self) -> DaeAccuracy:
        """Of the in-house solver."""
        return DaeAccuracy(
            self.integrator,
            self.integration_tolerance,
            self.equal_step,
            projected=self.projection == "on",
        )


LEAST_TREE_STEPS = 500
"""Steps of the open tree in a cycle without contact."""
