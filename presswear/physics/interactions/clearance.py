"""Contact of a pin with its bearing in a clearance joint: forces, losses and wear."""

from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.physics.contact import note_foundation, note_radial
from presswear.physics.equations.text import (
    ONE,
    ZERO,
    Vector,
    difference,
    negative,
    product,
    total,
)
from presswear.physics.interactions.friction import FRICTION_KERNELS, friction_of
from presswear.physics.interactions.joint_motion import FIELDS, MotionText
from presswear.physics.interactions.normal_force import NORMAL_KERNELS, NormalForceText
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.interactions.wear_rates import WEAR_KERNELS, WearText
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import Records

# Fields that ``contact.note_radial`` and ``note_foundation`` compute on worn surfaces in
# every evaluation, and those of the greatest overlap
_FIELDS_OF_KERNELS = (
    "normal_x",
    "normal_y",
    "pin_arm",
    "bearing_arm",
    "approach",
    "closing",
    "elastic",
    "couple",
)
_FIELDS_OF_DEEPEST = ("penetration", "rate", "energy", "place")
# Variables of the forces and moments, which are zero in an open joint
_FORCES = (
    "normal_force",
    "friction_force",
    "force_x",
    "force_y",
    "pin_moment",
    "bearing_moment",
)


@dataclass(frozen=True)
class ClearanceContact:
    """Dry contact in a clearance joint that writes itself into the equations."""

    joint: ClearanceJoint
    record: Records  # dtype JOINT
    number: int  # index among the clearance joints

    kernels: ClassVar[Kernels] = (
        note_foundation,
        note_radial,
        *NORMAL_KERNELS,
        *WEAR_KERNELS,
        *FRICTION_KERNELS,
    )

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all dry clearance joints of a linkage between a pin and its bearing."""
        pairs = zip(linkage.clearances, packed.joints, strict=True)
        return [
            cls(joint, record, k)
            for k, (joint, record) in enumerate(pairs)
            if joint.oil is None and not isinstance(joint, GuideCorner)
        ]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies of bearing and pin."""
        return self.joint.bearing.body, self.joint.pin.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return 0: ``ledger.stored_energy`` adds the elastic energies of contacts."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the contact, its forces on both bodies, its powers and rates of wear."""
        ContactText(page, self.joint, self.record, self.number).write()


class ContactText(MotionText):
    """Writer of the equations of a contact of round or worn surfaces."""

    def __init__(
        self, page: Page, joint: ClearanceJoint, record: Records, number: int
    ) -> None:
        super().__init__(page, joint, record, number)
        self.normal_law = NormalForceText(self)
        self.wear = WearText(self, self.wears_by_pressure)
        self.friction = friction_of(
            page, self.prefix, number, joint.friction, record["friction"]
        )

    @property
    def makes_energy(self) -> bool:
        """True if the normal force can create energy.

        A user law may have a larger force while the pin leaves than while it approaches.
        The radial force on a worn profile is not the gradient of an energy.
        """
        return self.uses_kernel or self.joint.round_normal.user_law is not None

    @property
    def is_on_foundation(self) -> bool:
        """True if worn surfaces press on each other over an arc."""
        return self.uses_kernel and bool(self.record["foundation"] > 0.0)

    @property
    def reads_penetration(self) -> bool:
        """True if forces, wear or a state depend on the greatest overlap of worn surfaces."""
        by_wear = self.wears_by_pressure or bool(self.record["slip_by_angle"])
        has_user_law = self.joint.round_normal.user_law is not None
        return by_wear or has_user_law or self.friction.has_state

    @property
    def title(self) -> str:
        """Comment with the name of the joint and its bodies."""
        joint = self.joint
        bodies = f"pin of {joint.pin.body} in a bearing of {joint.bearing.body}"
        return f"{joint.name}: {bodies}, with clearance"

    @property
    def wears(self) -> bool:
        """True if wear is computed."""
        return bool(self.record["wear_coefficient"] > 0.0)

    @property
    def wears_by_pressure(self) -> bool:
        """True if wear needs the integral of a power of the pressure times slip."""
        return self.wears and not (
            self.record["over_arc"]
            and self.record["pressure_exponent"] == 1.0
            and self.record["wear_address"] == 0
        )

    def write(self) -> None:
        """Write the contact, and add its forces to those on both bodies."""
        text = self.text
        text.comment(self.title)
        onset = self.let("onset_speed", f"data.onset[{self.number}]")
        for name in self._results():
            text.write(f"{name} = {ZERO}")
        if self.friction.has_state:
            # It changes in open joints, too.
            self._write_contact(onset)
        else:
            with text.block(f"if {onset} >= {ZERO} or level == END:"):
                self._write_contact(onset)
        force = Vector(self.name("force_x"), self.name("force_y"))
        self.pin.forces.append(force.times(ONE))
        self.pin.moments.append(self.name("pin_moment"))
        self.bearing.forces.append(force.times(f"-{ONE}"))
        self.bearing.moments.append(self.name("bearing_moment"))

    def _results(self) -> list[str]:
        """Return the variables that are zero in an open joint; declare powers and rates."""
        powers = ["contact_loss"]
        if self.joint.friction.coefficient > 0.0:
            powers.append("friction_loss")
        if self.makes_energy:
            powers.append("created")
        for energy in powers:
            self.page.add_power(energy, self.name(energy))
        rates = self.wear.declare_rates() if self.wears else []
        return [self.name(word) for word in (*_FORCES, *powers, *rates)]

    def _write_contact(self, onset: str) -> None:
        """Write the motion of the pin, the forces, and the record at the end of a step."""
        text = self.text
        self.write_motion()
        if self.uses_kernel:
            self._write_kernel_call()
        else:
            self._write_penetration()
        sliding = self.write_sliding()
        depth = "elastic" if self.is_on_foundation else "penetration"
        is_closed = f"{self.value(depth)} > {ZERO}"
        self.friction.write_state(sliding, is_closed)
        with text.block(f"if {is_closed}:"):
            if not self.uses_kernel:
                elastic = self.normal_law.elastic()
                text.write(f"{self.value('elastic')} = {elastic}")
            with text.block(f"if {onset} >= {ZERO}:"):
                self._write_forces(onset)
        with text.block("if level == END:"):
            self._write_record()

    def _write_penetration(self) -> None:
        """Write penetration and contact point of round surfaces, along the eccentricity."""
        joint = self.joint
        size = self.value("eccentricity")
        clearance = self.parameter("clearance", joint.clearance)
        penetration = self.let("penetration", difference(size, clearance))
        # A pin exactly in the centre is open, so that any direction is valid.
        self._write_direction("x", size, ONE)
        self._write_direction("y", size, ZERO)
        normal = self.vector("normal")
        velocity = self.vector("velocity")
        rate = self.let("rate", velocity.dot(normal))
        indentation = self.let("indentation", f"0.5 * max({penetration}, {ZERO})")
        radius = self.parameter("pin_radius", joint.pin_radius)
        self.fields["pin_arm"] = self.let("pin_arm", difference(radius, indentation))
        radius = self.parameter("bearing_radius", joint.bearing_radius)
        self.fields["bearing_arm"] = self.let("bearing_arm", total(radius, indentation))
        self.fields["penetration"] = penetration
        self.fields["elastic"] = self.name("elastic_force")
        # On round surfaces the point of contact approaches as the centre does.
        self.fields["rate"] = rate
        self.fields["approach"] = rate
        self.fields["closing"] = rate
        self.text.write(f"{self.name('elastic_force')} = {ZERO}")

    def _write_direction(self, axis: str, size: str, centred: str) -> None:
        """Write a component of the unit vector of the eccentricity, of which ``size`` is the size.

        ``centred`` is the component of a pin in the centre.
        """
        quotient = f"{self.value(f'eccentricity_{axis}')} / {size}"
        component = f"{quotient} if {size} > {ZERO} else {centred}"
        self.fields[f"normal_{axis}"] = self.let(f"normal_{axis}", component)

    def _write_kernel_call(self) -> None:
        """Write the call of the kernel for worn surfaces."""
        self.fields["turning"] = self.turning()
        turns = self.record["map_turns"] > 0.0
        self.set_fields("map", self.bearing.axis if turns else Vector(ONE, ZERO))
        contact = self.let("contact", f"data.contacts[{self.number}]")
        for field, value in self.fields.items():
            self.text.write(f"{contact}[{FIELDS[field]}] = {value}")
        records = ("joints", "surfaces", "contact_records")
        arguments = ", ".join(f"data.{name}[{self.number}]" for name in records)
        fields: tuple[str, ...] = _FIELDS_OF_KERNELS + _FIELDS_OF_DEEPEST
        if not self.is_on_foundation:
            self.text.write(f"note_radial({arguments})")
        elif self.reads_penetration:
            self.text.write(f"note_foundation({arguments}, True)")
        else:
            self.text.write(f"note_foundation({arguments}, level == END)")
            fields = _FIELDS_OF_KERNELS
        for field in fields:
            self.fields[field] = self.let(field, f"{contact}[{FIELDS[field]}]")

    def _write_forces(self, onset: str) -> None:
        """Write the forces and moments of a closed joint."""
        text = self.text
        normal = self.vector("normal")
        normal_force = self.name("normal_force")
        friction_force = ZERO
        size = self.normal_law.force(onset)
        text.write(f"{normal_force} = {size}")
        on_pin = normal.times(f"-{normal_force}")
        if self.joint.friction.coefficient > 0.0:
            friction_force = self.name("friction_force")
            text.write(f"{friction_force} = {self.friction.force(normal_force)}")
            on_pin = on_pin.plus(normal.rotated_at(friction_force))
        force = Vector(self.name("force_x"), self.name("force_y"))
        text.write(f"{force.x} = {on_pin.x}")
        text.write(f"{force.y} = {on_pin.y}")
        self._write_moments(normal_force, normal, force)
        with text.block("if level >= RATES:"):
            self._write_losses(normal_force, friction_force)
            if self.wears:
                self.wear.write(normal_force)

    def _write_moments(self, normal_force: str, normal: Vector, force: Vector) -> None:
        """Write the moments about both mass centres of a force at one common point."""
        radius = normal.times(self.value("pin_arm"))
        couple = ZERO
        if self.is_on_foundation:
            elastic = self.value("elastic")
            scaled = f"{normal_force} / {elastic} * {self.value('couple')}"
            couple = self.let("couple_moment", scaled)
        if self.pin.index >= 0:
            point = self.pin_arm.plus(radius)
            point = self.let_vector("pin_point", point)
            moment = total(point.cross(force), couple)
            self.text.write(f"{self.name('pin_moment')} = {moment}")
        if self.bearing.index >= 0:
            point = self._bearing_point(radius)
            point = self.let_vector("bearing_point", point)
            moment = negative(total(point.cross(force), couple))
            self.text.write(f"{self.name('bearing_moment')} = {moment}")

    def _bearing_point(self, radius: Vector) -> Vector:
        """Return the vector from the mass centre of the bearing's body to the contact."""
        return self.bearing_arm.plus(self.vector("eccentricity"), radius)

    def _write_losses(self, normal_force: str, friction_force: str) -> None:
        """Write the powers lost in contact and in friction, and created by the normal law."""
        write = self.text.write
        closing = self.value("closing")
        contact_loss = self.name("contact_loss")
        damping_force = difference(normal_force, self.value("elastic"))
        damping_power = product(damping_force, closing)
        write(f"{contact_loss} = {damping_power}")
        if friction_force != ZERO:
            friction_power = product(friction_force, self.value("sliding"))
            write(f"{self.name('friction_loss')} = {negative(friction_power)}")
        if not self.makes_energy:
            return
        created = self.name("created")
        write(f"{created} = -min({damping_power}, {ZERO})")
        if self.uses_kernel:
            # The radial force of a worn profile does work at the rate of ``approach``, its
            # elastic energy changes at the rate of ``closing``.
            power = product(normal_force, difference(self.value("approach"), closing))
            write(f"{created} -= {power}")
            write(f"{contact_loss} += {power}")

    def _write_record(self) -> None:
        """Write the contact for the recorder."""
        if not self.uses_kernel:
            self.fields["turning"] = self.turning()
            law = f"data.joints[{self.number}].normal"
            energy = f"elastic_of({law}, {self.value('penetration')})[1]"
            self.fields["energy"] = self.let("elastic_energy", energy)
        contact = self.name("contact")
        if not self.uses_kernel:
            self.text.write(f"{contact} = data.contacts[{self.number}]")
        self.fields["normal"] = self.name("normal_force")
        self.fields["tangential"] = self.name("friction_force")
        for field, value in self.fields.items():
            if self.uses_kernel and field in _FIELDS_OF_KERNELS + _FIELDS_OF_DEEPEST:
                continue
            self.text.write(f"{contact}[{FIELDS[field]}] = {value}")
