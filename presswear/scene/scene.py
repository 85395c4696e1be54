"""Scene: a mechanism with its bearings, and all other settings of a run."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, ClassVar, cast, get_args

from presswear.engines.settings import (
    Engine,
    ExudynJoints,
    ExudynTree,
    InHouse,
    Purpose,
)
from presswear.linkage.guide_corner import largest_tilt
from presswear.linkage.joints import Guide, closing_guides
from presswear.linkage.press import Press
from presswear.linkage.process import PROCESSES, Process, check_reach
from presswear.linkage.topology import branches_of
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import CONVENTIONS, Conventions
from presswear.scene.guide_clearance import check_guide, deepest_wall
from presswear.scene.initial_surfaces import initial_surfaces
from presswear.scene.life_checks import check_life
from presswear.scene.mechanism_kinds import AnyMechanism, mechanism_from
from presswear.scene.options import LIVES, Life, Limit, Numerics, Recording
from presswear.scene.pin_joints import check_contact, check_conventions
from presswear.scene.run_checks import (
    check_masses,
    check_open_tree,
    check_settled_speed,
    check_springs,
    check_torque_limits,
)
from presswear.scene.stage_names import stage_name
from presswear.scene.user_laws import LinkageWithUserLaws, refuse_files
from presswear.tools.errors import InputError, unknown
from presswear.tools.fields import choice, count, named_set, one_of, quantity
from presswear.tools.quantities import written
from presswear.tools.serialize import Checked, converted, from_plain, plain
from presswear.tools.type_check import check_type

ENGINES = ("exudyn", ExudynTree.word, ExudynJoints.word, InHouse.word)
PURPOSES = ("auto", *get_args(Purpose))
# conventions: steps for wear over an arc
EXTRAPOLATIONS = ("conventions", "single", "steps")
REPLICATES = 4  # replicates of a scene that wears: the fewest with a usable interval
LIFE_REPLICATES = 8  # Student's interval from 8 is three quarters of that from 4


@dataclass(frozen=True)
class Scene(LinkageWithUserLaws, Checked):
    """Mechanism, bearings and all other settings of a run.

    Attributes
    ----------
    mechanism : Press, SliderCrank, FourBar, SixBar, TwoPoint, LinkDrive or Linkage
    bearings : Bearing, or mapping of str to Bearing
        Bearing of every joint with clearance that is not in ``joint_bearings``. A
        mapping gives its joints clearance, each with its bearing.
    joint_bearings : mapping of str to Bearing
        Bearings of single joints that differ from ``bearings``.
    surfaces : mapping of str to pair
        Initial surfaces of bearing and pin in every replicate, by joint; the rest is
        round. A side is a ``Surface``, None, depths of equal bins of a turn, shape
        (m,), m, or rows of angle, rad, and depth, m, shape (n, 2). Where its angles are
        not those of the bins of the joint, each bin takes the mean of the monotone
        cubic through the points, which conserves the worn volume. Of a guide they are
        the left and the right wall, each on the bins of its map.
    origins : mapping of str to str
        Origins of values by key, where they differ from those of the fields.
    """

    # for messages
    example: ClassVar[str] = "pw.scenes.ideal() or pw.scene_from('press.toml')"

    mechanism: AnyMechanism = field(default_factory=Press)
    name: str = "scene"
    title: str = ""  # title of reports; empty: the name
    # a mapping gives ``joints``, ``joint_bearings`` and the common bearing
    bearings: Bearing | Any = field(default_factory=Bearing)
    joint_bearings: Mapping[str, Bearing] = field(default_factory=dict, hash=False)
    conventions: Conventions = named_set(
        "refined",
        CONVENTIONS,
        "model choices: refined (advised), paper (as printed)",
    )
    numerics: Numerics = field(default_factory=Numerics)
    joints: str | Any = choice(
        None,
        lambda scene: (*scene.mechanism.allowed_joints, "none"),
        "joints with clearance, or rigid with friction; default: those of the mechanism",
        several=True,
    )
    engine: str = choice(
        InHouse.word,
        ENGINES,
        "dae: in-house, fastest; exudyn: exudyn-tree, else exudyn-joints",
    )
    purpose: str = choice(
        "auto",
        PURPOSES,
        "purpose, sets the tolerances; auto: wear if joints wear, forces in more than two cycles "
        "with clearance, else trajectory",
    )
    drive_torque: str = choice(
        "auto",
        ("auto", "off", "on"),
        "storage of drive torques; auto: if there is a process",
    )
    wear_updates: int = count(1, 0, 20, "chosen", "number of wear updates")
    cycles: int | None = count(
        None,
        low=1,
        high=100_000,
        origin="chosen",
        text="cycles of a replicate; default: until the wear maps converge",
    )
    tolerance: float = quantity(
        0.1,
        unit="",
        low=1e-3,
        high=1.0,
        origin="chosen",
        text="allowed standard error of the wear maps over their rms",
    )
    max_cycles: int = count(
        256,
        low=1,
        high=100_000,
        origin="chosen",
        text="most cycles of all replicates together, if cycles = none",
    )
    cycles_per_update: float | None = quantity(
        None,
        unit="",
        low=1.0,
        high=1e12,
        origin="chosen",
        text="cycles that one wear update represents; default: those that wear a tenth of the "
        "clearance",
    )
    extrapolation: str = choice(
        "conventions",
        EXTRAPOLATIONS,
        "wear update in one jump, or in steps of one cycle",
    )
    replicates: int | None = count(
        None,
        low=1,
        high=100,
        origin="chosen",
        text="independent runs; default: 8 with a life, 4 with wear, else 1",
    )
    seed: int = count(0, 0, 100_000, "chosen", "seed of the initial conditions")
    surfaces: Mapping[str, tuple[Any, Any]] | Any = field(
        default_factory=dict, hash=False
    )
    recording: Recording = field(default_factory=Recording)
    process: Process | None = one_of(PROCESSES, "force of the work on the output point")
    life: Life | None = one_of(
        LIVES,
        "service life: limits up to which the joints wear, in wear_updates stages",
    )
    origins: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        """Check each value, and fill in joints and bearings; see ``check`` for the rest."""
        if isinstance(self.mechanism, Mapping | str):
            self._set(mechanism=mechanism_from(self.mechanism))
        check_type("mechanism", self.mechanism, AnyMechanism)
        self._open_joints()
        self._set(bearings=converted("bearings", self.bearings, Bearing))
        super().__post_init__()
        self._give_stiffness_to_joints()
        self._normalise()
        if self.life is None and not self.wearing_joints:
            self._set(wear_updates=0)  # no joint wears
        self._check_bearings()
        if self.life is not None:
            self._check_life(self.life)
        elif self.replicate_count > 1 and not self.clearance_joints:
            raise InputError(
                f"replicates = {self.replicates}: allowed is 1 without clearance"
            )

    def _normalise(self) -> None:
        """Write joints, bearings and surfaces in one form, so that equal scenes are equal."""
        joint_bearings = {}
        for name, bearing in self.joint_bearings.items():
            if name not in self.mechanism.allowed_joints:
                raise unknown("joint in bearings", name, self.mechanism.allowed_joints)
            if bearing != self.bearings:
                joint_bearings[name] = bearing
        self._set(
            joints=self.joint_choice.combine(self.bearing_joints),
            joint_bearings=joint_bearings,
        )
        surfaces = initial_surfaces(
            self.surfaces,
            self.wearing_joints,
            self.worn_guides,
            self.bearing,
            self.conventions.contact,
        )
        self._set(surfaces=surfaces)

    def _open_joints(self) -> None:
        """Give clearance to the joints in ``bearings``, or to the default of the mechanism."""
        bearings: Any = self.bearings
        is_mapping = isinstance(bearings, Mapping)
        # Else the mapping has the fields of one bearing.
        if is_mapping and not bearings.keys() & Bearing.__dataclass_fields__.keys():
            self._set(
                joints=self.joint_choice.combine(bearings),
                joint_bearings=dict(bearings),
                bearings=next(iter(bearings.values()), Bearing()),
            )
        if self.joints is None:
            if not self.mechanism.default_joints and self.bearings != Bearing():
                names = ", ".join(self.mechanism.allowed_joints)
                raise InputError(
                    f"bearings: no joint has clearance; set joints to any of {names}"
                )
            self._set(joints=self.joint_choice.combine(self.mechanism.default_joints))

    def _check_bearings(self) -> None:
        """Raise InputError if a bearing does not fit the contact, the conventions or a guide."""
        is_worn = self.wear_updates > 0 or bool(self.surfaces)
        for name, bearing in self.bearings_of_pins.items():
            prefix = f"{name}." if name else ""
            check_contact(bearing, prefix, self.conventions.contact, is_worn)
            check_conventions(bearing, prefix, self.conventions)
        for guide in self.loose_guides:
            self._check_guide(guide)

    def _check_life(self, life: Life) -> None:
        """Raise InputError if the service life cannot be computed."""
        deepest_walls = {}
        for guide in self.worn_guides:
            deepest_walls[guide.name] = deepest_wall(self.bearing(guide.name), guide)
        check_life(
            life,
            self.life_limits,
            {name: self.bearing(name) for name in self.loose_pins},
            deepest_walls,
            self.conventions,
            self.wear_updates,
            self.replicates,
        )

    def _check_guide(self, guide: Guide) -> None:
        """Raise InputError if a guide cannot have its clearance."""
        check_guide(self.bearing(guide.name), guide)
        linkage = self.mechanism.linkage()
        without_guide = [joint for joint in linkage.joints if joint.name != guide.name]
        if len(closing_guides(without_guide)) < len(closing_guides(linkage.joints)):
            raise InputError(
                f"bearings of {guide.name}: guides alone close a loop with it; allowed is a guide "
                "outside of such a loop"
            )
        for drive in linkage.drives:
            if drive.body == guide.body:
                raise InputError(
                    f"bearings of {guide.name}: {guide.body} has a drive, which holds its angle; "
                    "allowed is a guide of a body without a drive"
                )

    def _give_stiffness_to_joints(self) -> None:
        """Move the stiffness of the common bearing to the joints that have this bearing."""
        if self.bearings.stiffness is None:
            return
        bearings = dict.fromkeys(self.bearing_joints, self.bearings)
        self._set(
            joint_bearings={**bearings, **self.joint_bearings},
            bearings=replace(self.bearings, stiffness=None),
        )

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def check(self) -> None:
        """Raise InputError if the scene cannot be run.

        Assembles the mechanism over a cycle, and checks the process, the torque limits
        of the drives and the engine. Called once before a run, because it takes longer
        than the checks of single values.
        """
        bearings = [self.bearing(joint) for joint in self.all_loose_joints]
        can_wear = any(item.materials.wear_coefficient for item in bearings)
        if self.wear_updates > 0 and bearings and not can_wear:
            raise InputError(
                "wear_coefficient = 0: with wear_updates or a life allowed is above 0"
            )
        check_masses(self.mechanism.linkage().bodies)
        ideal = self.ideal  # raises if the linkage cannot follow its drives
        check_springs(self.base_linkage, ideal)
        if self.process is not None:
            check_reach(self.process, self.stroke, self.output)
            self._check_offset(self.process)
        if not self.has_untrusted_loads:
            bushings = self.linkage().bushings
            check_torque_limits(self.loaded, ideal, bushings)
            if self.run_up == 0.0:
                check_settled_speed(self.loaded, ideal, bushings)
        if self.engine == ExudynTree.word:
            check_open_tree(self.linkage(), ENGINES)

    def _check_offset(self, process: Process) -> None:
        """Raise InputError if the force of the work has an offset and the output cannot tilt."""
        body = self.base_linkage.output.body
        guides = [guide for guide in self.loose_guides if guide.body == body]
        if process.offset == 0.0 or (guides and not guides[0].is_moving):
            return
        if guides:
            raise InputError(
                f"process.offset = {written(process.offset, 'm')}: allowed is 0, because the guide "
                f"of {self.output} is on {guides[0].on}; use a load on a point of {self.output}"
            )
        raise InputError(
            f"process.offset = {written(process.offset, 'm')}: allowed is 0, because "
            f"{self.output} cannot tilt, so that an offset changes nothing; give its guide "
            "clearance, a length and a width"
        )

    @property
    def life_limits(self) -> tuple[Limit, ...]:
        """Limits of the service life; none without a life."""
        if self.life is None:
            return ()
        clearances = {name: self.bearing(name).clearance for name in self.loose_pins}
        tilts = {}
        for guide in self.worn_guides:
            clearance = self.bearing(guide.name).clearance
            tilts[guide.name] = largest_tilt(guide, clearance)
        return self.life.limits(clearances, tilts)

    @property
    def replicate_count(self) -> int:
        """Number of independent runs."""
        if self.replicates is not None:
            return self.replicates
        if self.life is not None:
            return LIFE_REPLICATES
        is_wearing = self.wear_updates > 0 and self.clearance_joints
        return REPLICATES if is_wearing else 1

    @property
    def is_quick(self) -> bool:
        """True if the life is one of two wear rates."""
        return self.life is not None and self.life.quick == "on"

    @property
    def stores_torques(self) -> bool:
        """True if the torques of the drives are stored."""
        if self.drive_torque == "auto":
            return self.process is not None
        return self.drive_torque == "on"

    @property
    def wears_in_steps(self) -> bool:
        """True if a wear update is applied in steps.

        By default this is so with the distribution over the arc only. With the other
        distribution the depth depends on the width of the bins, and no step is small
        enough.
        """
        if self.is_quick:
            return False
        if self.extrapolation == "conventions":
            return self.conventions.wear_distribution == "arc"
        return self.extrapolation == "steps"

    @property
    def bin_remark(self) -> str:
        """Remark on wear depths that depend on the width of the bins; else empty."""
        if self.conventions.wear_distribution != "bin":
            return ""
        widths = []  # one text for each width
        for name in self.loose_pins:
            bearing = self.bearing(name)
            width = f"{360.0 / bearing.angles:.3g}°"
            if bearing.materials.wear_coefficient > 0.0 and width not in widths:
                widths.append(width)
        if not widths:
            return ""
        return f"bins of {' and '.join(widths)}; twice as many bins halve it"

    @property
    def auto_purpose(self) -> Purpose:
        """Purpose of a run for which no purpose is specified.

        With clearance, trajectories diverge within the first cycles. Longer runs are
        evaluated by statistics, which need no exact trajectory.
        """
        if self.wear_updates > 0:
            return "wear"
        is_short = self.cycles is not None and self.cycles <= STARTUP_CYCLES
        if is_short or not self.clearance_joints:
            return "trajectory"
        return "forces"

    @cached_property
    def solver(self) -> Engine:
        """Engine of a run with its tolerances; ``exudyn`` selects exudyn-tree if it is possible."""
        word = self.engine
        if word == "exudyn":
            is_tree = not isinstance(branches_of(self.linkage()), str)
            word = ExudynTree.word if is_tree else ExudynJoints.word
        purpose = cast(
            Purpose, self.auto_purpose if self.purpose == "auto" else self.purpose
        )
        engines: tuple[Engine, ...] = tuple(vars(self.numerics).values())
        engine = next(engine for engine in engines if engine.word == word)
        return engine.resolved(purpose, self.tolerance)

    def stage_name(self, index: int) -> str:
        """Return the name of a stage of this scene."""
        return stage_name(index, bool(self.surfaces))

    def modelled(self) -> dict[str, Any]:
        """Return the model as plain data, without engine, accuracy and number of runs."""
        names = (
            "mechanism",
            "bearings",
            "joint_bearings",
            "conventions",
            "extrapolation",
            "cycles_per_update",
            "surfaces",
            "process",
            "life",
        )
        return {name: value for name, value in self.as_dict().items() if name in names}

    def as_dict(self) -> dict[str, Any]:
        """Return the scene as plain data, SI units; see ``from_dict``."""
        return plain(self)

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Scene":
        """Return a scene from ``as_dict``; InputError for a key that does not fit or is missing."""
        refuse_files(data)
        if isinstance(data, Mapping) and data.get("joints") is None:
            raise InputError("scene: 'joints' is missing")
        return from_plain(Scene, data, "scene")
