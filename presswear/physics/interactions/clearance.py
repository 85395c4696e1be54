"""Contact of a pin with its bearing in a clearance joint: forces, losses and wear."""

from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.guide_corner import GuideCorner
from presswear.linkage.linkage import Linkage
from presswear.physics.contact import CONTACT, note_foundation, note_radial
from presswear.physics.equations.chain import Link
from presswear.physics.equations.text import (
    ONE,
    ZERO,
    Vector,
    difference,
    negative,
    product,
    total,
)
from presswear.physics.friction_and_normal import (
    ELASTICITIES,
    elastic_of,
    round_foundation,
)
from presswear.physics.interactions.friction import FRICTION_KERNELS, friction_of
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.packed import Packed
from presswear.physics.pressure_wear import arc_width
from presswear.physics.wear import contact_area
from presswear.tools.arrays import Array
from presswear.tools.compile import Records

FIELDS = {name: i for i, name in enumerate(CONTACT.names or ())}
# Fields that ``contact.note_radial`` and ``note_foundation`` compute on worn surfaces
_FILLED = (
    "penetration",
    "rate",
    "normal_x",
    "normal_y",
    "pin_arm",
    "bearing_arm",
    "approach",
    "closing",
    "elastic",
    "energy",
    "place",
    "couple",
)
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
    record: Records  # of JOINT
    number: int  # index among the clearance joints

    kernels: ClassVar[Kernels] = (
        arc_width,
        contact_area,
        elastic_of,
        note_foundation,
        note_radial,
        round_foundation,
        *(law for law in ELASTICITIES.values() if not isinstance(law, int)),
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
        """Return 0: the elastic energies of contacts are in the memory of the joints."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the contact, its forces on both bodies, its powers and doses of wear."""
        ContactText(page, self.joint, self.record, self.number).write()


class ContactText:
    """Writer of the equations of a contact of round or worn surfaces.

    ``fields`` has the expression, or the name of the variable, of each field of CONTACT
    that has been written.
    """

    def __init__(
        self, page: Page, joint: ClearanceJoint, record: Records, number: int
    ) -> None:
        text = page.text
        self.page = page
        self.text = text
        self.joint = joint
        self.number = number
        self.record = record
        self.prefix = text.prefix(joint.name)
        self.bearing = page.chain.of(joint.bearing.body)
        self.pin = page.chain.of(joint.pin.body)
        self.bearing_arm = self.bearing.arm(text, joint.bearing, self.prefix)
        self.pin_arm = self.pin.arm(text, joint.pin, self.prefix)
        self.fields: dict[str, str] = {}
        self.friction = friction_of(
            page, self.prefix, self.number, joint.friction, self.record["friction"]
        )

    @property
    def is_worn(self) -> bool:
        """True if a kernel for worn surfaces fills in the contact."""
        return bool(self.record["surface_bins"] > 0)

    @property
    def makes_energy(self) -> bool:
        """True if the normal force can create energy.

        A user law may have a larger force while the pin leaves than while it approaches.
        The radial force on a worn profile is not the gradient of an energy.
        """
        return self.is_worn or self.joint.round_normal.user_law is not None

    @property
    def onset_floor(self) -> str:
        """Name of the lower limit of the closing speed in the damping law."""
        return "ONSET_SPEED_FLOOR"

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

    def name(self, word: str) -> str:
        """Return the name of a variable of the joint."""
        return f"{self.prefix}_{word}"

    def let(self, word: str, expression: str) -> str:
        """Assign an expression to a variable of the joint."""
        return self.text.let(self.name(word), expression)

    def parameter(self, word: str, value: float) -> str:
        """Return the name of a number of the joint."""
        return self.text.parameter(self.name(word), value)

    def value(self, word: str) -> str:
        """Return the expression of a field of CONTACT."""
        return self.fields.get(word, ZERO)

    def vector(self, word: str) -> Vector:
        """Return the expressions of two fields of CONTACT, x and y."""
        return Vector(self.value(f"{word}_x"), self.value(f"{word}_y"))

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
        """Return the variables that are zero in an open joint; declare powers and doses."""
        powers = ["contact_loss"]
        if self.joint.friction.coefficient > 0.0:
            powers.append("friction_loss")
        if self.makes_energy:
            powers.append("created")
        for energy in powers:
            self.page.add_power(energy, self.name(energy))
        rates = []
        if self.wears:
            rates.append("wear_work")
            self.page.set_dose(self.number, "work", self.name("wear_work"))
        if self.wears_by_pressure:
            rates.append("wear_pressure")
            self.page.set_dose(self.number, "pressure", self.name("wear_pressure"))
        return [self.name(word) for word in (*_FORCES, *powers, *rates)]

    def _write_contact(self, onset: str) -> None:
        """Write the motion of the pin, the forces, and the record at the end of a step."""
        text = self.text
        self._write_motion()
        if self.is_worn:
            self._write_worn()
        else:
            self._write_round()
        normal = self.vector("normal")
        velocity = self.vector("velocity")
        sum_of_speeds = total(
            normal.cross(velocity),
            product(self.pin.omega, self.value("pin_arm")),
            negative(product(self.bearing.omega, self.value("bearing_arm"))),
        )
        sliding = self.let("sliding", sum_of_speeds)
        self.fields["sliding"] = sliding
        is_closed = f"{self.value('penetration')} > {ZERO}"
        self.friction.write_state(sliding, is_closed)
        with text.block(f"if {is_closed}:"):
            if not self.is_worn:
                self._write_elastic()
            with text.block(f"if {onset} >= {ZERO}:"):
                self._write_forces(onset, normal)
        with text.block("if level == END:"):
            self._write_record()

    def _write_motion(self) -> None:
        """Write position and velocity of the pin relative to the bearing."""
        text = self.text
        pin = self.pin
        bearing = self.bearing
        centre = bearing.position.plus(self.bearing_arm)
        eccentricity = pin.position.plus(self.pin_arm).minus(centre)
        eccentricity = text.let_vector(self.name("eccentricity"), eccentricity)
        bearing_velocity = bearing.velocity_at(self.bearing_arm)
        velocity = pin.velocity_at(self.pin_arm).minus(bearing_velocity)
        velocity = text.let_vector(self.name("velocity"), velocity)
        length = f"math.sqrt({eccentricity.dot(eccentricity)})"
        self.fields["eccentricity"] = self.let("eccentricity", length)
        self._set_fields("eccentricity", eccentricity)
        self._set_fields("velocity", velocity)
        self._set_link("bearing", bearing, self.bearing_arm)
        self._set_link("pin", pin, self.pin_arm)

    def _set_link(self, end: str, link: Link, arm: Vector) -> None:
        self.fields[f"{end}_angle"] = link.angle
        self.fields[f"{end}_spin"] = link.omega
        # The frame has no mass centre.
        self._set_fields(f"{end}_lever", arm if link.index >= 0 else Vector())

    def _set_fields(self, name: str, vector: Vector) -> None:
        self.fields |= {f"{name}_x": vector.x, f"{name}_y": vector.y}

    def _turning(self) -> str:
        """Write the angular velocity of the eccentricity."""
        cross = self.vector("eccentricity").cross(self.vector("velocity"))
        size = self.value("eccentricity")
        rate = f"({cross}) / ({size} * {size}) if {size} > {ZERO} else {ZERO}"
        return self.let("turning", rate)

    def _write_round(self) -> None:
        """Write the contact of round surfaces, in the direction of the eccentricity."""
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

    def _write_worn(self) -> None:
        """Write the call of the kernel for worn surfaces."""
        self.fields["turning"] = self._turning()
        contact = self.let("contact", f"data.contacts[{self.number}]")
        for field, value in self.fields.items():
            self.text.write(f"{contact}[{FIELDS[field]}] = {value}")
        is_radial = self.record["foundation"] == 0.0
        kernel = "note_radial" if is_radial else "note_foundation"
        records = ("joints", "surfaces", "contact_records")
        arguments = ", ".join(f"data.{name}[{self.number}]" for name in records)
        self.text.write(f"{kernel}({arguments})")
        for field in _FILLED:
            self.fields[field] = self.let(field, f"{contact}[{FIELDS[field]}]")

    def _write_elastic(self) -> None:
        """Write the elastic force of the normal law."""
        depth = self.value("penetration")
        law = self.joint.round_normal
        stiffness = self.parameter("stiffness", self.record["normal"]["stiffness"])
        is_function = not isinstance(ELASTICITIES[law.elasticity], int)
        if law.user_law is not None or is_function:
            force = self._call_normal(depth, ZERO, ONE)
        elif law.elasticity == "foundation":
            clearance = self.parameter("clearance", self.joint.clearance)
            force = f"round_foundation({depth}, {stiffness}, {clearance})[0]"
        elif law.exponent == 1.5:
            force = f"{stiffness} * {depth} * math.sqrt({depth})"
        elif law.exponent == 1.0:
            force = f"{stiffness} * {depth}"
        else:
            exponent = self.parameter("exponent", law.exponent)
            force = f"{stiffness} * {depth} ** {exponent}"
        self.text.write(f"{self.value('elastic')} = {force}")

    def _call_normal(self, depth: str, rate: str, onset: str) -> str:
        """Return the call of a normal law with all of NORMAL_PARAMETERS."""
        record = self.record["normal"]
        numbers = ("stiffness", "exponent", "damping", "clearance")
        parameters = [self.parameter(name, record[name]) for name in numbers]
        arguments = ", ".join([depth, rate, onset, *parameters])
        law = self.joint.round_normal
        if law.user_law is None:
            return f"{ELASTICITIES[law.elasticity].__name__}({arguments})"
        address = self.parameter("normal_law", record["address"])
        return f"call(int({address}), ({arguments}))"

    def _write_forces(self, onset: str, normal: Vector) -> None:
        """Write the forces and moments of a closed joint."""
        text = self.text
        normal_force = self.name("normal_force")
        friction_force = ZERO
        text.write(f"{normal_force} = {self._normal_force(onset)}")
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
                self._write_wear(normal_force)

    def _normal_force(self, onset: str) -> str:
        """Return the normal force; write the closing speed at touchdown for laws with damping."""
        law = self.joint.round_normal
        elastic = self.value("elastic")
        closing = self.value("closing")
        damping = self.parameter("damping", self.record["normal"]["damping"])
        if law.user_law is None and damping == ZERO:
            return elastic
        if law.user_law is None and law.viscosity > 0.0:
            return f"max({elastic} + {product(damping, closing)}, {ZERO})"
        speed = f"{onset} if {onset} > {ZERO} else {self.value('rate')}"
        limited = f"max({speed}, {self.onset_floor})"
        touchdown_speed = self.let("touchdown_speed", limited)
        if law.user_law is None:
            factor = f"({ONE} + {damping} * {closing} / {touchdown_speed})"
            return f"max({elastic} * {factor}, {ZERO})"
        depth = self.value("penetration")
        return f"max({self._call_normal(depth, closing, touchdown_speed)}, {ZERO})"

    def _write_moments(self, normal_force: str, normal: Vector, force: Vector) -> None:
        """Write the moments about both mass centres of a force at one common point."""
        radius = normal.times(self.value("pin_arm"))
        couple = ZERO
        if self.is_worn and self.record["foundation"] > 0.0:
            # The elastic force is zero at a penetration of some 1e-19 m, by underflow.
            elastic = self.value("elastic")
            scaled = f"{normal_force} / {elastic} * {self.value('couple')}"
            scaled = f"{scaled} if {elastic} > {ZERO} else {ZERO}"
            couple = self.let("couple_moment", scaled)
        if self.pin.index >= 0:
            point = self.pin_arm.plus(radius)
            point = self.text.let_vector(self.name("pin_point"), point)
            moment = total(point.cross(force), couple)
            self.text.write(f"{self.name('pin_moment')} = {moment}")
        if self.bearing.index >= 0:
            point = self._bearing_point(radius)
            point = self.text.let_vector(self.name("bearing_point"), point)
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
        if self.is_worn:
            # The radial force of a worn profile does work at the rate of ``approach``, its
            # elastic energy changes at the rate of ``closing``.
            power = product(normal_force, difference(self.value("approach"), closing))
            write(f"{created} -= {power}")
            write(f"{contact_loss} += {power}")

    def _write_wear(self, normal_force: str) -> None:
        """Write the rates of the load distance and, if needed, of pressure times slip."""
        depth = self.value("penetration")
        slip = f"abs({self.value('sliding')})"
        if self.record["slip_by_angle"]:
            turning = self.value("turning") if self.is_worn else self._turning()
            radius = self.parameter("pin_radius", self.joint.pin_radius)
            slip = f"({radius} + {depth}) * abs({turning})"
        work = self.name("wear_work")
        self.text.write(f"{work} = {normal_force} * {slip}")
        if self.record["wear_address"]:
            self.text.write(f"{self.name('wear_pressure')} = {slip}")
        elif self.record["over_arc"] and self.wears_by_pressure:
            radius = self.parameter("bearing_radius", self.joint.bearing_radius)
            width = self.parameter("width", self.joint.width)
            clearance = self.parameter("clearance", self.joint.clearance)
            area = f"{width} * {radius} * arc_width({depth}, {clearance})"
            pressure = f"{normal_force} / ({area})"
            self._write_pressure_dose(work, pressure, normal_force)
        elif self.wears_by_pressure:
            self._write_bin_wear(work, normal_force)

    def _write_bin_wear(self, work: str, normal_force: str) -> None:
        """Write the rate of pressure times slip, with the mean pressure over the chord."""
        depth = self.value("penetration")
        half = f"0.5 * {depth}"
        arguments = (
            depth,
            self.value("eccentricity"),
            f"{self.value('bearing_arm')} - {half}",
            f"{self.value('pin_arm')} + {half}",
            self.parameter("width", self.joint.width),
        )
        area = f"contact_area({', '.join(arguments)})"
        if self.record["pressure_exponent"] == 1.0:
            self.text.write(f"{self.name('wear_pressure')} = {work} / {area}")
        else:
            area = self.let("contact_area", area)
            dose_rate = f"{work} / {area}"
            pressure = f"{normal_force} / {area}"
            self._write_pressure_dose(dose_rate, pressure, normal_force)

    def _write_pressure_dose(
        self, dose_rate: str, pressure: str, normal_force: str
    ) -> None:
        """Write the rate of a dose times (p / p_ref)^(m - 1)."""
        wear = self.joint.wear
        assert wear is not None
        reference = self.parameter("pressure_reference", wear.pressure_reference)
        power = self.parameter("pressure_power", wear.pressure_exponent - 1.0)
        pressure = self.let("pressure", pressure)
        rate = f"{dose_rate} * ({pressure} / {reference}) ** {power}"
        rate = f"{rate} if {normal_force} > {ZERO} else {ZERO}"
        self.text.write(f"{self.name('wear_pressure')} = {rate}")

    def _write_record(self) -> None:
        """Write the contact for the recorder."""
        if not self.is_worn:
            self.fields["turning"] = self._turning()
            law = f"data.joints[{self.number}].normal"
            energy = f"elastic_of({law}, {self.value('penetration')})[1]"
            self.fields["energy"] = self.let("elastic_energy", energy)
        contact = self.name("contact")
        if not self.is_worn:
            self.text.write(f"{contact} = data.contacts[{self.number}]")
        self.fields["normal"] = self.name("normal_force")
        self.fields["tangential"] = self.name("friction_force")
        for field, value in self.fields.items():
            if self.is_worn and field in _FILLED:
                continue
            self.text.write(f"{contact}[{FIELDS[field]}] = {value}")
