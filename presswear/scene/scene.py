"""A scene: a mechanism with clearance joints, and everything that a person chooses for a run."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib import import_module
from typing import Any, ClassVar, cast, get_args

import numpy as np

from presswear.engines.settings import (
    Engine,
    ExudynJoints,
    ExudynTree,
    InHouse,
    Purpose,
)
from presswear.linkage import elements, loads
from presswear.linkage.elements import (
    CORNERS,
    Attachment,
    Body,
    Guide,
    Revolute,
    slide_inertia,
)
from presswear.linkage.laws import OILED_WEAR
from presswear.linkage.linkage import Linkage, linkage_from
from presswear.linkage.mechanisms import FourBar, Press, SixBar, SliderCrank, TwoPoint
from presswear.linkage.surface import Surface
from presswear.linkage.topology import branches_of
from presswear.physics.ideal import IdealMotion, bottom_of, followed, ideal_motion
from presswear.recording.statistics import STARTUP_CYCLES
from presswear.scene.bearing import Bearing
from presswear.scene.conventions import CONVENTIONS, Conventions
from presswear.scene.guide_clearance import check_guide, corners_of
from presswear.scene.initial_surfaces import initial_surfaces
from presswear.scene.options import CLEARANCES, LIVES, Life, Limit, Numerics, Recording
from presswear.tools.arrays import Array
from presswear.tools.errors import InputError, shown, unknown
from presswear.tools.quantities import (
    Choice,
    choice,
    count,
    named_set,
    one_of,
    quantity,
    written,
)
from presswear.tools.serialize import (
    Checked,
    check_type,
    converted,
    from_plain,
    make,
    plain,
)
from presswear.tools.user_function import UserFunction

Parametric = Press | SliderCrank | FourBar | SixBar | TwoPoint
OneMechanism = Parametric | Linkage
MECHANISMS: dict[str, type[Parametric]] = {
    one.kind: one for one in get_args(Parametric)
}
"""The mechanisms that are made of a few quantities, by their kinds."""


ENGINES = ("exudyn", ExudynTree.word, ExudynJoints.word, InHouse.word)
PURPOSES = ("auto", *get_args(Purpose))
# conventions: steps for wear over an arc
EXTRAPOLATIONS = ("conventions", "single", "steps")
REPLICATES = 4  # of a scene that wears: the fewest with a usable interval
LIFE_REPLICATES = 8  # Student's interval from 8 is three quarters of that from 4
# beyond it accelerations of the light body are round-off of the forces
MAX_MASS_RATIO = 1e6


@dataclass(frozen=True)
class Scene(Checked):
    """Mechanism, bearings and all other settings of a run.

    Attributes
    ----------
    mechanism : Press, SliderCrank, FourBar, SixBar, TwoPoint or Linkage
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
        cubic through the points, which conserves the worn volume.
    origins : mapping of str to str
        Origins of values by key, where they differ from those of the fields.
    """

    # for messages
    example: ClassVar[str] = "pw.scenes.ideal() or pw.scene_from('press.toml')"

    mechanism: OneMechanism = field(default_factory=Press)
    name: str = "scene"
    title: str = ""  # of reports; empty: the name
    bearings: Bearing | Any = field(default_factory=Bearing)  # a mapping is taken apart
    joint_bearings: Mapping[str, Bearing] = field(default_factory=dict, hash=False)
    conventions: Conventions = named_set(
        *("refined", CONVENTIONS),
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
        *("auto", PURPOSES),
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
        1,
        100_000,
        "chosen",
        "cycles of a replicate; default: until the wear maps converge",
    )
    tolerance: float = quantity(
        0.1,
        "",
        1e-3,
        1.0,
        "chosen",
        "allowed standard error of the wear maps over their rms",
    )
    max_cycles: int = count(
        256,
        1,
        100_000,
        "chosen",
        "most cycles of all replicates together, if cycles = none",
    )
    cycles_per_update: float | None = quantity(
        *(None, "", 1.0, 1e12, "chosen"),
        "cycles that one wear update represents; default: those that wear a tenth of the clearance",
    )
    extrapolation: str = choice(
        "conventions",
        EXTRAPOLATIONS,
        "wear update in one jump, or in steps of one cycle",
    )
    replicates: int | None = count(
        None,
        1,
        100,
        "chosen",
        "independent runs; default: 8 with a life, 4 with wear, else 1",
    )
    seed: int = count(0, 0, 100_000, "chosen", "seed of the initial conditions")
    surfaces: Mapping[str, tuple[Any, Any]] | Any = field(
        default_factory=dict, hash=False
    )
    recording: Recording = field(default_factory=Recording)
    process: loads.Process | None = one_of(
        loads.PROCESSES, "force of the work on the output point"
    )
    life: Life | None = one_of(
        LIVES,
        "service life: limits up to which the joints wear, in wear_updates stages",
    )
    origins: Mapping[str, str] = field(default_factory=dict, hash=False)

    def __post_init__(self) -> None:
        """Check each value, and fill in joints and bearings; see ``check`` for the rest."""
        if isinstance(self.mechanism, Mapping | str):
            self._set(mechanism=_mechanism_from(self.mechanism))
        check_type("mechanism", self.mechanism, OneMechanism)
        if (
            isinstance(self.bearings, Mapping)
            and not self.bearings.keys() & Bearing.__dataclass_fields__.keys()
        ):
            self._set(
                joints=self._joint_choice.combine(self.bearings),
                joint_bearings=dict(self.bearings),
                bearings=next(iter(self.bearings.values()), Bearing()),
            )
        if self.joints is None:
            if not self.mechanism.default_joints and self.bearings != Bearing():
                names = ", ".join(self.mechanism.allowed_joints)
                raise InputError(
                    f"bearings: no joint has clearance; set joints to any of {names}"
                )
            self._set(joints=self._joint_choice.combine(self.mechanism.default_joints))
        self._set(bearings=converted("bearings", self.bearings, Bearing))
        super().__post_init__()
        self._give_stiffness_to_joints()
        for name in self.joint_bearings:
            if name not in self.mechanism.allowed_joints:
                raise unknown("joint in bearings", name, self.mechanism.allowed_joints)
        self._set(  # in one spelling, so that equal scenes are equal
            joints=self._joint_choice.combine(self.bearing_joints),
            joint_bearings={
                k: b for k, b in self.joint_bearings.items() if b != self.bearings
            },
            surfaces=initial_surfaces(
                self.surfaces,
                self.clearance_joints,
                self.bearing,
                self.conventions.contact,
            ),
        )
        if self.life is None and not self.loose_pins:
            self._set(wear_updates=0)  # no joint wears
        is_worn = self.wear_updates > 0 or bool(self.surfaces)
        for name, bearing in self._bearings_of_pins.items():
            prefix = f"{name}." if name else ""
            bearing.check_contact(prefix, self.conventions.contact, is_worn)
            bearing.check_conventions(prefix, self.conventions)
        for guide in self.loose_guides:
            self._check_guide(guide)
        if self.life is not None:
            self._check_life(self.life)
        elif self.replicate_count > 1 and not self.clearance_joints:
            raise InputError(
                f"replicates = {self.replicates}: allowed is 1 without clearance"
            )

    @property
    def _bearings_of_pins(self) -> dict[str, Bearing]:
        """The common bearing, by an empty name, and those of single pins."""
        guides = {guide.name for guide in self.loose_guides}
        bearings = {"": self.bearings, **self.joint_bearings}
        if guides and guides | self.joint_bearings.keys() >= set(self.bearing_joints):
            del bearings[""]
        return {name: one for name, one in bearings.items() if name not in guides}

    def _check_guide(self, guide: Guide) -> None:
        """Raise InputError where a guide cannot have its clearance."""
        check_guide(self.bearing(guide.name), guide)
        for drive in self.mechanism.linkage().drives:
            if drive.body == guide.body:
                raise InputError(
                    f"bearings of {guide.name}: {guide.body} has a drive, which holds its angle; "
                    "allowed is a guide of a body without a drive"
                )

    def _give_stiffness_to_joints(self) -> None:
        """Move the stiffness of the common bearing to the joints that have this bearing."""
        if self.bearings.stiffness is None:
            return
        common = dict.fromkeys(self.bearing_joints, self.bearings)
        each = {**common, **self.joint_bearings}
        self._set(joint_bearings=each, bearings=replace(self.bearings, stiffness=None))

    def _set(self, **values: Any) -> None:
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def check(self) -> None:
        """Raise InputError if the scene cannot be run.

        Assembles the mechanism over a cycle, and checks the process, the torque limits
        of the drives and the engine. Called once before a run, because it takes longer
        than the checks of single values.
        """
        coefficients = [
            self.bearing(j).materials.wear_coefficient for j in self.loose_pins
        ]
        if self.wear_updates > 0 and coefficients and not any(coefficients):
            raise InputError(
                "wear_coefficient = 0: with wear_updates or a life allowed is above 0"
            )
        bodies = self.mechanism.linkage().bodies
        light, heavy = (
            least(bodies, key=lambda body: body.mass) for least in (min, max)
        )
        if heavy.mass > MAX_MASS_RATIO * light.mass:
            masses = f"{heavy.name} = {heavy.mass:g} kg, mass of {light.name} = {light.mass:g} kg"
            raise InputError(
                f"mass of {masses}: allowed is a ratio of up to {MAX_MASS_RATIO:g}"
            )
        _ = self.ideal  # raises where the linkage cannot follow its drives
        if self.base_linkage.springs:
            # Imported here, because it loads numba.
            springs = import_module("presswear.physics.interactions.spring")
            springs.check_springs(
                self.base_linkage, self.ideal.at(np.zeros(1)).position[0]
            )
        if self.process is not None:
            loads.check_reach(self.process, self.stroke, self.output)
            self._check_offset(self.process)
        loaded = self.loaded
        is_limited = any(
            drive.torque_limit is not None and drive.motor is None
            for drive in loaded.drives
        )
        if is_limited and not self.has_untrusted_loads:
            from presswear.physics.statics import check_drives  # slow import

            check_drives(loaded, self.ideal, self.linkage().bushings)
        leader = loaded.leader
        if leader is not None and self.run_up == 0.0 and not self.has_untrusted_loads:
            from presswear.physics.settled_speed import settled_rate  # slow import

            settled_rate(loaded, self.ideal, self.linkage().bushings)
        reason = branches_of(self.linkage()) if self.engine == ExudynTree.word else ""
        if isinstance(reason, str) and reason:
            engines = ", ".join(name for name in ENGINES if name != ExudynTree.word)
            fault = f"it needs a linkage without free loops, but {reason}"
            raise InputError(
                f"engine = {ExudynTree.word!r}: {fault}; allowed is one of {engines}"
            )

    def _check_offset(self, process: loads.Process) -> None:
        """Raise InputError where the force of the work is off centre and nothing can tilt."""
        body = self.base_linkage.output.body
        if process.offset == 0.0 or any(g.body == body for g in self.loose_guides):
            return
        raise InputError(
            f"process.offset = {written(process.offset, 'm')}: allowed is 0, because "
            f"{self.output} cannot tilt, so that an offset changes nothing; give its guide "
            "clearance, a length and a width"
        )

    def _check_life(self, life: Life) -> None:
        if not self.loose_pins:
            raise InputError("life: no pin has clearance, so that no joint wears")
        if self.wear_updates < 1:
            raise InputError(
                "wear_updates = 0 does not fit [life]: use 1 to 20, or switch the life off"
            )
        if self.replicates == 1:
            raise InputError("replicates = 1 does not fit [life]: use 2 to 100")
        if self.conventions.wear_distribution != "arc":
            reason = "the depth of 'bin' depends on the width of the bins"
            raise InputError(
                f"wear_distribution = 'bin' does not fit [life]: use 'arc', because {reason}"
            )
        services = life.services(self.loose_pins)
        limits = self.life_limits
        if self.is_quick:
            others = [
                one.key for one in limits if one.name not in ("depth", "wear_volume")
            ]
            faults = [
                f"until: {key}: allowed are depth and wear_volume" for key in others
            ]
            faults += [f"{one.words}: allowed is no maintenance" for one in services]
            if self.wear_updates > 1:
                faults.append(f"wear_updates = {self.wear_updates}: allowed is 1")
            ratios = [
                self.bearing(name).materials.running_in for name in self.loose_pins
            ]
            faults += [
                f"running_in = {ratio:g}: allowed is 1"
                for ratio in ratios
                if ratio != 1.0
            ]
            if faults:
                raise InputError(f"{faults[0]} with life.quick = on")
        if limits and all(one.value >= self._greatest(one) for one in limits):
            allowed = f"allowed is below {written(self._greatest(limits[0]), 'm')}"
            limit = f"until = '{limits[0].key} > {written(limits[0].value, 'm')}'"
            words = self._deepest_words(self.bearing(limits[0].joint))
            raise InputError(f"{limit}: {allowed}, {words}")

    @property
    def life_limits(self) -> tuple[Limit, ...]:
        """Limits of the service life; none without a life."""
        if self.life is None:
            return ()
        joints = self.loose_pins
        return self.life.limits({name: self.bearing(name).clearance for name in joints})

    def _greatest(self, limit: Limit) -> float:
        """Return the value on surfaces of the greatest depth allowed; infinite if unknown."""
        if limit.name not in ("depth", *CLEARANCES):
            return math.inf
        bearing = self.bearing(limit.joint)
        deepest = bearing.deepest_wear(self.conventions.contact)
        if limit.name == "depth":
            return deepest
        return CLEARANCES[limit.name] * (bearing.clearance + 2.0 * deepest)

    def _deepest_words(self, bearing: Bearing) -> str:
        """Return a description of the greatest depth of wear of a joint."""
        if bearing.has_film:
            return f"with wear of {OILED_WEAR:g} clearances; film = report allows more"
        if self.conventions.contact == "foundation":
            return elements.DEEPEST_WORDS
        return "with wear as deep as the clearance; contact = 'foundation' allows more"

    @property
    def bearing_joints(self) -> tuple[str, ...]:
        """Names of the joints with a bearing, which has clearance or only friction."""
        words = self._joint_choice.split(self.joints)
        return tuple(name for name in self.mechanism.allowed_joints if name in words)

    @property
    def clearance_joints(self) -> tuple[str, ...]:
        """Names of the joints with clearance; of a guide those of its four corners."""
        guides = (guide.name for guide in self.loose_guides)
        corners = (f"{guide} {one}" for guide in guides for one in CORNERS)
        return (*self.loose_pins, *corners)

    @property
    def loose_pins(self) -> tuple[str, ...]:
        """Names of the pin joints with clearance, which wear; walls of guides do not."""
        guides = [guide.name for guide in self.loose_guides]
        return tuple(
            name
            for name in self.bearing_joints
            if name not in guides and self.bearing(name).clearance > 0.0
        )

    @property
    def loose_guides(self) -> tuple[Guide, ...]:
        """Guides with clearance."""
        names = self.bearing_joints
        return tuple(
            guide for guide in self.mechanism.linkage().guides if guide.name in names
        )

    @property
    def _loose_joints(self) -> tuple[str, ...]:
        """Names of the pins and the guides with clearance."""
        return (*self.loose_pins, *(guide.name for guide in self.loose_guides))

    @property
    def rigid_bearings(self) -> tuple[str, ...]:
        """Names of the joints that have a bearing without clearance."""
        return tuple(
            name for name in self.bearing_joints if self.bearing(name).clearance == 0.0
        )

    @property
    def _joint_choice(self) -> Choice:
        return Choice((*self.mechanism.allowed_joints, "none"), several=True)

    def check_user_laws(self) -> None:
        """Raise InputError where a user law returns no number or creates energy; runs its text."""
        self.check_trusted()
        for joint in self._loose_joints:
            self.bearing(joint).check_user_laws(joint, self.conventions)
        for joint in self.rigid_bearings:
            self.bearing(joint).check_user_friction(joint)
        for key, law in self.user_laws.items():
            if key.startswith(("loads[", "drives[")):
                loads.check_load(key, law)
                law.check_compiles(key, loads.LOAD_PARAMETERS)

    @property
    def user_laws(self) -> dict[str, UserFunction]:
        """User laws, source code, by keys such as ``A.normal_law`` and ``loads[0].law``."""
        laws = {
            f"{joint}.{key}": getattr(self.bearing(joint), key)
            for joint in self._loose_joints
            for key in ("normal_law", "friction_law")
        }
        laws |= {
            f"{one}.friction_law": self.bearing(one).friction_law
            for one in self.rigid_bearings
        }
        applied = enumerate(self.mechanism.linkage().loads)
        laws |= {f"loads[{k}].law": getattr(load, "law", None) for k, load in applied}
        drives = enumerate(self.mechanism.linkage().drives)
        laws |= {
            f"drives[{k}].motor.law": getattr(drive.motor, "law", None)
            for k, drive in drives
        }
        return {key: law for key, law in laws.items() if isinstance(law, UserFunction)}

    @property
    def has_untrusted_loads(self) -> bool:
        """True where ideal torques would execute source code that was read from a result."""
        laws = self.user_laws.items()
        return any(key.startswith("loads[") and not law.is_trusted for key, law in laws)

    def check_trusted(self) -> None:
        """Raise UntrustedLaw if a run would execute source code that was read from a result."""
        for key, law in self.user_laws.items():
            law.check_trusted(key)

    def trust(self) -> None:
        """Allow this process to execute the source code of the user laws."""
        for law in self.user_laws.values():
            law.trusted()

    def bearing(self, joint: str) -> Bearing:
        """Return the bearing of a joint; of the corner of a slide that of its guide."""
        for guide in self.loose_guides:
            if joint.removeprefix(f"{guide.name} ") in CORNERS:
                joint = guide.name
        return self.joint_bearings.get(joint, self.bearings)

    @property
    def replicate_count(self) -> int:
        """Number of independent runs."""
        if self.replicates is not None:
            return self.replicates
        if self.life is not None:
            return LIFE_REPLICATES
        return REPLICATES if self.wear_updates > 0 and self.clearance_joints else 1

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

        By default only with the distribution over the arc: a profile whose depth
        depends on the width of its bins has no step that is small enough.
        """
        if self.is_quick:
            return False
        if self.extrapolation == "conventions":
            return self.conventions.wear_distribution == "arc"
        return self.extrapolation == "steps"

    @property
    def bin_remark(self) -> str:
        """Remark on depths and volumes that the width of the bins changes; else empty."""
        bearings = [self.bearing(name) for name in self.loose_pins]
        wears = [one for one in bearings if one.materials.wear_coefficient > 0.0]
        if self.conventions.wear_distribution != "bin" or not wears:
            return ""
        widths = dict.fromkeys(f"{360.0 / one.angles:.3g}°" for one in wears)
        return f"bins of {' and '.join(widths)}; twice as many bins halve it"

    def linkage(
        self, worn: Mapping[str, tuple[Surface, Surface]] | None = None
    ) -> Linkage:
        """Return the linkage on worn surfaces, bearing and pin by joint, or on initial ones."""
        return self._linkage_on(worn) if worn else self._initial_linkage

    @cached_property
    def _initial_linkage(self) -> Linkage:
        return self._linkage_on({})

    def _linkage_on(self, worn: Mapping[str, tuple[Surface, Surface]]) -> Linkage:
        ideal = self.loaded
        surfaces = dict.fromkeys(self.clearance_joints, (Surface(), Surface()))
        surfaces |= {**self.surfaces, **worn}
        names = self.clearance_joints
        loose = tuple(
            self.bearing(joint.name).joint(
                joint, self.conventions, surfaces[joint.name]
            )
            for joint in ideal.revolutes
            if joint.name in names
        )
        guides = {guide.name: guide for guide in self.loose_guides}
        corners = tuple(
            corner
            for joint in ideal.guides
            if joint.name in guides
            for corner in corners_of(self.bearing(joint.name), joint)
        )
        rigid = self.rigid_bearings
        joints = tuple(
            self.bearing(one.name).rigid(one)
            if isinstance(one, Revolute) and one.name in rigid
            else one
            for one in ideal.joints
            if one.name not in names and one.name not in guides
        )
        bodies = tuple(map(self._with_inertia, ideal.bodies))
        clearances = (*ideal.clearances, *loose, *corners)
        loosened = replace(ideal, bodies=bodies, joints=joints, clearances=clearances)
        return loosened.released

    def _with_inertia(self, body: Body) -> Body:
        """Return a body; a slide that begins to tilt gets the inertia of a block, by default."""
        for guide in self.loose_guides:
            if guide.body == body.name and body.inertia == 0.0:
                return replace(body, inertia=slide_inertia(body.mass, guide))
        return body

    @property
    def has_deviations(self) -> bool:
        """True if clearance or an elastic joint lets the output leave its ideal motion."""
        return bool(self.clearance_joints or self.linkage().elastic_joints)

    @property
    def stroke(self) -> float:
        """Distance between the extremes of the output coordinate in the ideal motion, m."""
        dead_centre = bottom_of(self.ideal)
        return 0.0 if dead_centre is None else dead_centre.stroke

    @property
    def bottom(self) -> float:
        """Output coordinate of bottom dead centre in the ideal motion, m."""
        dead_centre = bottom_of(self.ideal)
        if dead_centre is None:
            return float(self.ideal.at(np.zeros(1)).output(self.base_linkage)[0, 0])
        return dead_centre.height

    @property
    def lift(self) -> float:
        """Height over the work at which a stroke on it is over, m: half way up."""
        return (
            0.0 if self.process is None else 0.5 * (self.stroke - self.process.height)
        )

    @property
    def process_laws(self) -> dict[str, loads.OverPosition]:
        """Laws of the process forces over the output coordinate, by name."""
        if self.process is None:
            return {}
        return loads.laws_of(self.process, self.bottom + self.process.height, self.lift)

    @property
    def base_linkage(self) -> Linkage:
        """Linkage of the mechanism, its output direction away from the work.

        So bottom dead centre is the lowest position in every scene.
        """
        linkage = self.mechanism.linkage()
        if self.process is None or self.process.bottom == "lowest":
            return linkage
        opposite = math.remainder(linkage.output.direction + math.pi, 2.0 * math.pi)
        return replace(linkage, output=replace(linkage.output, direction=opposite))

    @property
    def loaded(self) -> Linkage:
        """Ideal linkage under the forces of the process."""
        ideal = followed(self.base_linkage)
        if self.process is None:
            return ideal
        point = self._point_of_work(ideal)
        direction = ideal.output.direction
        laws = self.process_laws.items()
        forces = (loads.Force(point, direction, law, name) for name, law in laws)
        return replace(ideal, loads=(*ideal.loads, *forces))

    def _point_of_work(self, ideal: Linkage) -> Attachment:
        """Return the point of the process force: the output point, or a point beside it."""
        point = ideal.output.attachment
        guides = [guide for guide in ideal.guides if guide.body == point.body]
        if self.process is None or self.process.offset == 0.0 or not guides:
            return point
        turn = ideal.output.direction - guides[0].angle
        right = point.x + self.process.offset * math.sin(turn)
        above = point.y - self.process.offset * math.cos(turn)
        return Attachment(point.body, right, above)

    @property
    def auto_purpose(self) -> Purpose:
        """Purpose of a run for which none is specified.

        With clearance, trajectories diverge within the first cycles: a run that is
        longer has statistics, which need no trajectory.
        """
        if self.wear_updates > 0:
            return "wear"
        is_short = self.cycles is not None and self.cycles <= STARTUP_CYCLES
        return "trajectory" if is_short or not self.clearance_joints else "forces"

    @property
    def solver(self) -> Engine:
        """Engine of a run, tolerances resolved; ``exudyn`` is the smallest model possible."""
        word = self.engine
        if word == "exudyn":
            is_tree = not isinstance(branches_of(self.linkage()), str)
            word = ExudynTree.word if is_tree else ExudynJoints.word
        purpose = cast(
            Purpose, self.auto_purpose if self.purpose == "auto" else self.purpose
        )
        numerics = self.numerics.resolved(purpose, self.tolerance)
        engines = numerics.tree, numerics.joints, numerics.dae
        return next(engine for engine in engines if engine.word == word)

    @property
    def ideal(self) -> IdealMotion:
        """Motion of the mechanism with all joints closed."""
        return ideal_motion(followed(self.base_linkage), self.mechanism.period)

    @property
    def run_up(self) -> float:
        """Time in which the mechanism runs up from rest, s; cycles are counted after it."""
        return self.mechanism.linkage().run_up_time

    @property
    def output(self) -> str:
        """Name of the body of the output point in a sentence: ``the slider``, ``link 7``."""
        body = self.mechanism.linkage().output.body
        name = "slider" if body.startswith("slider") else body
        return f"the {name}" if name[-1].islower() else name

    def ideal_slider(self, time: Array, closed: bool = True) -> Array:
        """Return displacement from the start, velocity and acceleration of the ideal output.

        Shape (n, 3) at times of shape (n,), s; m, m/s, m/s^2. See ``IdealMotion.at``
        for ``closed``.
        """
        slider = self.ideal.at(np.append(0.0, time), closed).output(self.base_linkage)
        slider[:, 0] -= slider[0, 0]
        return slider[1:]

    def stage_name(self, index: int) -> str:
        """Return the name of a stage of this scene."""
        return stage_name(index, bool(self.surfaces))

    def modelled(self) -> dict[str, Any]:
        """Return the model as plain data, without engine, accuracy and number of runs."""
        names = (
            *("mechanism", "bearings", "joint_bearings", "conventions"),
            *("extrapolation", "cycles_per_update", "surfaces", "process", "life"),
        )
        return {name: value for name, value in self.as_dict().items() if name in names}

    def as_dict(self) -> dict[str, Any]:
        """Return the scene as plain data, SI units; see ``from_dict``."""
        return plain(self)

    @staticmethod
    def from_dict(data: Mapping[str, Any]) -> "Scene":
        """Return a scene from ``as_dict``; InputError for a key that does not fit or is missing."""
        _refuse_files(data)
        if isinstance(data, Mapping) and data.get("joints") is None:
            raise InputError("scene: 'joints' is missing")
        return from_plain(Scene, data, "scene")


def _refuse_files(data: Any) -> None:
    """Raise InputError for a law that names a file; stored laws are names or source code."""
    if isinstance(data, Mapping):
        for key, value in data.items():
            is_law = key in ("normal_law", "friction_law", "law")
            if is_law and isinstance(value, str) and ".py:" in value:
                raise InputError(f"{key} = {shown(value)}: a stored law is source code")
            _refuse_files(value)
    elif isinstance(data, list):
        for value in data:
            _refuse_files(value)


def _mechanism_from(data: Any) -> OneMechanism:
    """Return a mechanism from its kind, or from plain data with a kind."""
    data = {"kind": data} if isinstance(data, str) else data
    kind = data.get("kind")
    Choice((*MECHANISMS, Linkage.kind)).check("kind of mechanism", kind)
    if kind == Linkage.kind:
        return linkage_from(data, "mechanism")
    return cast(OneMechanism, make("mechanism", MECHANISMS[kind], data))


_ORDINALS = (
    "first",
    "second",
    "third",
    "fourth",
    "fifth",
    "sixth",
    "seventh",
    "eighth",
)


def stage_name(index: int, is_worn: bool = False) -> str:
    """Return the name of a stage: ``no wear``, or ``initial surfaces``, ``first wear``, ..."""
    if index == 0:
        return "initial surfaces" if is_worn else "no wear"
    return (
        f"{_ORDINALS[index - 1]} wear" if index <= len(_ORDINALS) else f"wear {index}"
    )
