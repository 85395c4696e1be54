"""Settings of the engines: how finely each integrates.

A tolerance that is not specified follows from the purpose of the run; the values are
chosen from ``presswear benchmark``.  For a trajectory they are the coarsest that keep
the bounds of the cross-check up to the horizon (slider to 1e-6 m, touchdowns to 1e-6
s), a decade finer for the open tree and the in-house solver, at a fifth more computing
time.  The in-house solver uses order 8 there, at twice the price of order 5, because it
checks Exudyn's DOPRI5.  Forces and wear are statistics of a chaotic motion.  For forces
in-house the tolerance is the coarsest without a measurable bias in any of six scenes,
for wear one whose bias is below 2 % of the load distance (``docs/_tools/tolerances.py``, table
in ``docs/theory/integration.md``).  For the open tree it is a decade finer than the
coarsest without a detectable error.  Each run measures its step error itself
(``campaign/replicates.py``).

A scene checks the ranges; the benchmark exceeds them on purpose.  The code of an engine
is imported when it runs.
"""

from dataclasses import dataclass, fields, replace
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Self, cast

from presswear.tools.choices import Choice
from presswear.tools.errors import InputError
from presswear.tools.fields import choice, count, meaning_of, quantity
from presswear.tools.quantities import Quantity
from presswear.tools.serialize import Named, check_fields
from presswear.tools.type_check import check_type

if TYPE_CHECKING:
    from presswear.engines.base import Plan, Run, Start
    from presswear.linkage.linkage import Linkage

Integrator = Literal["auto", "dop853", "dopri5", "rk4", "rk4-paper"]
Purpose = Literal["trajectory", "forces", "wear"]  # purpose of the numbers of a run

# relative error of the wear maps for which the tolerances below are chosen
WEAR_ERROR = 0.1
LEAST_STEPS = 500  # steps of an error-controlled engine in a cycle without contact
# Fewest steps of an error-controlled engine in a free impact: 15 show its peak to 1e-5
IMPACT_STEPS: dict[Purpose, int] = {"trajectory": 15, "forces": 15, "wear": 8}
FINEST = 1e-13  # smallest tolerance of exudyn-tree
_MAY_BE_ZERO = "alpha", "beta"  # Baumgarte's coefficients
PAPER_STEP = 1e-4  # s; time step of the paper's Table 2


class _Engine(Named):
    """Longest step, tolerance and run of any engine."""

    word: ClassVar[str]
    # name of the setting of the tolerance; empty where steps are not error-controlled
    tolerance_name: ClassVar[str] = ""
    tolerances: ClassVar[dict[Purpose, float]]  # where none is specified
    # typical computing time of a step with one or two contacts, s
    step_time: ClassVar[float]
    worn_step_time: ClassVar[float]  # the same on worn surfaces, s
    # longest step between contacts, s; None: a part of the cycle
    free_step: float | None

    def __post_init__(self) -> None:
        for item in fields(cast(Any, self)):
            meaning = meaning_of(item, self)
            if isinstance(meaning, Quantity) and isinstance(
                getattr(self, item.name), str
            ):
                check_fields(self)  # converts texts with units
            value = getattr(self, item.name)
            check_type(item.name, value, item.type)
            if isinstance(meaning, Choice):
                meaning.check(item.name, value)
            if not isinstance(value, int | float) or value > 0.0:
                continue
            if isinstance(meaning, Quantity):
                meaning.check(item.name, value)
            elif not (item.name in _MAY_BE_ZERO and value == 0.0):
                raise InputError(f"{item.name} = {value:g}: must be above 0")

    def resolved(
        self, purpose: Purpose = "trajectory", wear_error: float = WEAR_ERROR
    ) -> Self:
        """Return a copy with unspecified settings set for the purpose.

        For wear the tolerance is proportional to the wanted relative error of the wear
        maps.
        """
        changes: dict[str, Any] = {}
        if self.tolerance_name and getattr(self, self.tolerance_name) is None:
            tolerance = self.tolerances[purpose]
            if purpose == "wear":
                tolerance *= min(wear_error / WEAR_ERROR, 1.0)
            finest = self.tolerances["trajectory"]
            changes[self.tolerance_name] = max(tolerance, finest)
        if getattr(self, "impact_steps", 0) is None:
            changes["impact_steps"] = IMPACT_STEPS[purpose]
        if getattr(self, "integrator", "") == "auto":
            changes["integrator"] = "dop853" if purpose == "trajectory" else "dopri5"
        return replace(cast(Any, self), **changes) if changes else self

    def longest(self, cycle: float) -> float:
        """Return the longest step, s, in a cycle of a duration, s."""
        least = getattr(self, "free_steps", LEAST_STEPS)
        return cycle / least if self.free_step is None else self.free_step

    def for_cycle(self, cycle: float) -> Self:
        """Return a copy whose longest step is that for a cycle of a duration, s."""
        return replace(cast(Any, self), free_step=self.longest(cycle))

    @property
    def tolerance(self) -> float:
        """Specified tolerance, else the one for a trajectory."""
        specified = getattr(self, self.tolerance_name)
        return self.tolerances["trajectory"] if specified is None else float(specified)

    def finer(self, factor: float) -> Self | None:
        """Return a copy with the tolerance divided by a factor; None without error control."""
        if not self.tolerance_name:
            return None
        return replace(
            cast(Any, self), **{self.tolerance_name: self.tolerance / factor}
        )

    @property
    def module(self) -> str:
        """Name of the module that runs this engine."""
        return f"presswear.engines.{self.word.replace('-', '_')}.engine"

    def simulate(self, linkage: "Linkage", start: "Start", plan: "Plan") -> "Run":
        """Run a linkage from a start.

        Raises
        ------
        InputError
            If the engine cannot run this linkage or begin at this start.
        """
        driver = import_module("presswear.engines.driver")
        engine = import_module(self.module)
        run: Run = driver.simulate(
            engine.prepare, self.resolved(), (linkage, start, plan)
        )
        return run


@dataclass(frozen=True)
class ExudynTree(_Engine):
    """Exudyn with an open tree in minimal coordinates, explicit and error-controlled.

    The tolerance is that of the root mean square over the coordinates and their rates.
    """

    word: ClassVar[str] = "exudyn-tree"
    tolerance_name: ClassVar[str] = "tree_tolerance"
    tolerances: ClassVar = {"trajectory": 1e-8, "forces": 1e-6, "wear": 1e-5}
    step_time: ClassVar[float] = 3.5e-5
    worn_step_time: ClassVar[float] = 5e-5

    tree_tolerance: float | None = quantity(
        None,
        unit="",
        low=FINEST,
        high=1e-3,
        origin="chosen",
        text="of exudyn-tree: error of a step, rad or m and rad/s or m/s; default: by the purpose",
    )
    free_step: float | None = None
    impact_steps: int | None = None  # fewest in a free impact; None: by the purpose


@dataclass(frozen=True)
class ExudynJoints(_Engine):
    """Exudyn with bodies and joints, implicit: any linkage.

    The steps of a pin at rest grow from ``steps_per_contact`` to ``steps_sustained`` as
    their error allows.  ``newton`` is the relative and absolute tolerance of Newton's
    method: above 1e-9 its noise in the accelerations shortens these steps.
    ``least_step`` is the shortest step, s.
    """

    word: ClassVar[str] = "exudyn-joints"
    step_time: ClassVar[float] = 2e-4
    worn_step_time: ClassVar[float] = 3e-4

    steps_per_contact: int = count(
        200, 20, 10_000, "chosen", "of exudyn-joints: steps in one impact"
    )
    steps_sustained: int = count(
        10,
        low=5,
        high=10_000,
        origin="chosen",
        text="of exudyn-joints: fewest steps in half a period of a pin at rest on its bearing",
    )
    free_steps: int = count(
        10_000, 1000, 10_000_000, "chosen", "of exudyn-joints: fewest steps in a cycle"
    )
    free_step: float | None = None
    newton: float = 1e-9
    least_step: float = 1e-9


@dataclass(frozen=True)
class InHouse(_Engine):
    """In-house solver with located touchdowns, for an open tree or with Lagrange multipliers.

    The tolerance is per step, times 1 mm or mrad in positions and times ``1 m/s + |v|``
    in velocities.  Minimal coordinates are used if clearance cuts every loop with a
    degree of freedom, otherwise all coordinates with multipliers.  ``alpha`` and
    ``beta`` are Baumgarte's coefficients, 1/s (equation 19).
    """

    word: ClassVar[str] = "dae"
    tolerance_name: ClassVar[str] = "integration_tolerance"
    tolerances: ClassVar = {"trajectory": 1e-9, "forces": 1e-7, "wear": 1e-6}
    step_time: ClassVar[float] = 2.5e-6
    worn_step_time: ClassVar[float] = 1e-5

    integrator: Integrator = choice(
        "auto",
        ("auto", "dop853", "dopri5", "rk4", "rk4-paper"),
        "of dae: order 8 or 5 with located touchdowns, 4 with equal steps, the paper's steps of "
        "1e-4 s; auto: 8 for a trajectory, else 5",
    )
    integration_tolerance: float | None = quantity(
        None,
        unit="",
        low=1e-14,
        high=1e-3,
        origin="chosen",
        text="of dae with dop853 and dopri5: error of a step, times 1 mm and 1 m/s + speed; "
        "default: by the purpose",
    )
    equal_step: float = quantity(
        1e-5, "s", 1e-9, 1e-2, "chosen", "of dae with rk4: step"
    )
    coordinates: str = choice(
        "auto",
        ("auto", "fewest", "all"),
        "of dae: fewest are those of the open tree, where there is one; all, with Lagrange "
        "multipliers; auto: all for rk4-paper and with projection, else fewest",
    )
    projection: str = choice(
        "off", ("off", "on"), "of dae: projection of each state onto the constraints"
    )
    alpha: float = 20.0
    beta: float = 20.0
    free_step: float | None = None
    impact_steps: int | None = None  # fewest in a free impact; None: by the purpose

    def finer(self, factor: float) -> "InHouse | None":
        """Return a copy with the tolerance divided by a factor; None if steps are equal."""
        return None if self.has_equal_steps else super().finer(factor)

    @property
    def takes_all_coordinates(self) -> bool:
        """Return whether constraints are held by multipliers for any linkage."""
        if self.coordinates == "auto":
            return self.integrator == "rk4-paper" or self.projection == "on"
        return self.coordinates == "all"

    @property
    def has_equal_steps(self) -> bool:
        """Return whether steps are equal, without error control."""
        return self.integrator.startswith("rk4")

    @property
    def step(self) -> float:
        """Equal step, s."""
        return PAPER_STEP if self.integrator == "rk4-paper" else self.equal_step


Engine = ExudynTree | ExudynJoints | InHouse
