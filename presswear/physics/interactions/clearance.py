"""Contact of a pin with its bearing in a clearance joint: forces, losses and wear."""

from dataclasses import dataclass
from typing import ClassVar, Self

from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.physics.contact import CONTACT, note_foundation, note_radial
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
# What surfaces that are not round fill in; see ``contact.note_radial`` and
# ``note_foundation``.
_FILLED = (
    *("penetration", "rate", "normal_x", "normal_y", "pin_arm", "bearing_arm"),
    *("approach", "closing", "elastic", "energy", "place", "couple"),
)


@dataclass(frozen=True)
class ClearanceContact:
    """The contact in a clearance joint, as text."""

    joint: ClearanceJoint
    record: Records  # of JOINT
    number: int  # among the clearance joints

    kernels: ClassVar[Kernels] = (
        *(
            arc_width,
            contact_area,
            elastic_of,
            note_foundation,
            note_radial,
            round_foundation,
        ),
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
            if not record["is_flat"] and not record["oiled"]
        ]

    @property
    def bodies(self) -> tuple[str, ...]:
        """Bodies of bearing and pin."""
        return self.joint.bearing.body, self.joint.pin.body

    @classmethod
    def stored_energy(cls, linkage: Linkage, position: Array) -> float:
        """Return nothing: the memory of each joint holds its elastic energy."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the contact, its forces on both bodies, its powers and doses of wear."""
        ContactText(page, self.joint, self.record, self.number).write()


class ContactText:
    """Text of a contact of round or worn surfaces, with expressions of the fields of CONTACT."""

    def __init__(
        self, page: Page, joint: ClearanceJoint, record: Records, number: int
    ) -> None:
        text, chain = page.text, page.chain
        self.page, self.text, self.joint = page, text, joint
        self.number, self.record = number, record
        self.prefix = text.prefix(joint.name)
        self.bearing, self.pin = chain.of(joint.bearing.body), chain.of(joint.pin.body)
        self.bearing_arm = self.bearing.arm(text, joint.bearing, self.prefix)
        self.pin_arm = self.pin.arm(text, joint.pin, self.prefix)
        self.is_worn = bool(record["surface_bins"] > 0)
        self.fields: dict[str, str] = {}
        self.friction = friction_of(
            page, self.prefix, self.number, joint.friction, self.record["friction"]
        )

    @property
    def makes_energy(self) -> bool:
        """True if the normal force may do more work than its elastic energy and damping allow.

        A user law may push harder where it opens, and a worn profile may drive the pin.
        """
        return self.is_worn or self.joint.round_normal.user_law is not None

    @property
    def onset_floor(self) -> str:
        """Least speed at touchdown that the damping is divided by."""
        return "ONSET_SPEED_FLOOR"

    @property
    def words(self) -> str:
        """Name and bodies in a comment."""
        joint = self.joint
        bodies = f"pin of {joint.pin.body} in a bearing of {joint.bearing.body}"
        return f"{joint.name}: {bodies}, with clearance"

    @property
    def wears(self) -> bool:
        """True if an account of wear is kept."""
        return bool(self.record["wear_coefficient"] > 0.0)

    @property
    def wears_by_pressure(self) -> bool:
        """True if the account is also of pressure times slip."""
        return self.wears and not (
            self.record["over_arc"] and self.record["pressure_exponent"] == 1.0
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
        """Return a field of the contact, as it is called in CONTACT."""
        return self.fields.get(word, ZERO)

    def vector(self, word: str) -> Vector:
        """Return two fields of the contact."""
        return Vector(self.value(f"{word}_x"), self.value(f"{word}_y"))

    def write(self) -> None:
        """Write the contact, and add its forces to those on both bodies."""
        text = self.text
        text.comment(self.words)
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
        for link, sign, end in (
            (self.pin, ONE, "pin"),
            (self.bearing, f"-{ONE}", "bearing"),
        ):
            link.forces.append(force.times(sign))
            link.moments.append(self.name(f"{end}_moment"))

    def _results(self) -> list[str]:
        """Return the names of what is zero while the joint is open; declare powers and doses."""
        words = ["normal_force", "friction_force"]
        words += ["force_x", "force_y", "pin_moment", "bearing_moment"]
        powers = ["contact_loss"]
        if self.joint.friction.coefficient > 0.0:
            powers.append("friction_loss")
        if self.makes_energy:
            powers.append("made")
        for energy in powers:
            self.page.add_power(energy, self.name(energy))
        doses = ["work"] * self.wears + ["pressure"] * self.wears_by_pressure
        for dose in doses:
            self.page.set_dose(self.number, dose, self.name(f"wear_{dose}"))
        words += [*powers, *(f"wear_{dose}" for dose in doses)]
        return [self.name(word) for word in words]

    def _write_contact(self, onset: str) -> None:
        """Write the motion of the pin, its forces, and at the end of a step the record."""
        text = self.text
        self._write_motion()
        if self.is_worn:
            self._write_worn()
        else:
            self._write_round()
        normal = self.vector("normal")
        velocity = self.vector("velocity")
        sliding = total(
            normal.cross(velocity),
            product(self.pin.omega, self.value("pin_arm")),
            negative(product(self.bearing.omega, self.value("bearing_arm"))),
        )
        sliding = self.fields["sliding"] = self.let("sliding", sliding)
        self.friction.write_state(sliding, f"{self.value('penetration')} > {ZERO}")
        with text.block(f"if {self.value('penetration')} > {ZERO}:"):
            if not self.is_worn:
                self._write_elastic()
            with text.block(f"if {onset} >= {ZERO}:"):
                self._write_forces(onset, normal)
        with text.block("if level == END:"):
            self._write_record()

    def _write_motion(self) -> None:
        """Write place and motion of the pin in the bearing."""
        text, pin, bearing = self.text, self.pin, self.bearing
        at_pin, at_bearing = self.pin_arm, self.bearing_arm
        place = pin.position.plus(at_pin).minus(bearing.position.plus(at_bearing))
        place = text.let_vector(self.name("eccentricity"), place)
        velocity = pin.velocity_at(at_pin).minus(bearing.velocity_at(at_bearing))
        velocity = text.let_vector(self.name("velocity"), velocity)
        size = self.let("eccentricity", f"math.sqrt({place.dot(place)})")
        self.fields |= {"eccentricity": size}
        self._set_fields("eccentricity", place)
        self._set_fields("velocity", velocity)
        for end, link, lever in (
            ("bearing", bearing, at_bearing),
            ("pin", pin, at_pin),
        ):
            self.fields |= {f"{end}_angle": link.angle, f"{end}_spin": link.omega}
            self._set_fields(f"{end}_lever", lever if link.place >= 0 else Vector())

    def _set_fields(self, name: str, vector: Vector) -> None:
        self.fields |= {f"{name}_x": vector.x, f"{name}_y": vector.y}

    def _turning(self) -> str:
        """Write the rate of the direction of the eccentricity."""
        place = self.vector("eccentricity")
        velocity = self.vector("velocity")
        size = self.value("eccentricity")
        turning = f"({place.cross(velocity)}) / ({size} * {size}) if {size} > {ZERO} else {ZERO}"
        return self.let("turning", turning)

    def _write_round(self) -> None:
        """Write the contact of round surfaces, which meet where the eccentricity points."""
        joint, size = self.joint, self.value("eccentricity")
        clearance = self.parameter("clearance", joint.clearance)
        penetration = self.let("penetration", difference(size, clearance))
        # A pin exactly in the centre touches nothing: any direction serves.
        for axis, centred in (("x", ONE), ("y", ZERO)):
            quotient = f"{self.value(f'eccentricity_{axis}')} / {size}"
            cosine = self.let(
                f"normal_{axis}", f"{quotient} if {size} > {ZERO} else {centred}"
            )
            self.fields[f"normal_{axis}"] = cosine
        normal = self.vector("normal")
        velocity = self.vector("velocity")
        rate = self.let("rate", velocity.dot(normal))
        indentation = self.let("indentation", f"0.5 * max({penetration}, {ZERO})")
        radius = self.parameter("pin_radius", joint.pin_radius)
        self.fields["pin_arm"] = self.let("pin_arm", difference(radius, indentation))
        radius = self.parameter("bearing_radius", joint.bearing_radius)
        self.fields["bearing_arm"] = self.let("bearing_arm", total(radius, indentation))
        self.fields |= {
            "penetration": penetration,
            "elastic": self.name("elastic_force"),
        }
        self.fields |= dict.fromkeys(("rate", "approach", "closing"), rate)
        self.text.write(f"{self.name('elastic_force')} = {ZERO}")

    def _write_worn(self) -> None:
        """Write the call of the kernel for surfaces that are not round."""
        self.fields["turning"] = self._turning()
        place = self.let("contact", f"data.contacts[{self.number}]")
        for word, value in self.fields.items():
            self.text.write(f"{place}[{FIELDS[word]}] = {value}")
        kernel = (
            "note_radial" if self.record["foundation"] == 0.0 else "note_foundation"
        )
        records = ("joints", "surfaces", "contact_records")
        arguments = ", ".join(f"data.{name}[{self.number}]" for name in records)
        self.text.write(f"{kernel}({arguments})")
        for word in _FILLED:
            self.fields[word] = self.let(word, f"{place}[{FIELDS[word]}]")

    def _write_elastic(self) -> None:
        """Write the elastic force of the normal law."""
        depth, law = self.value("penetration"), self.joint.round_normal
        numbers = self.record["normal"]
        stiffness = self.parameter("stiffness", numbers["stiffness"])
        if law.user_law is not None or not isinstance(
            ELASTICITIES[law.elasticity], int
        ):
            force = self._call_normal(depth, ZERO, ONE)
        elif law.elasticity == "foundation":
            clearance = self.parameter("clearance", self.joint.clearance)
            force = f"round_foundation({depth}, {stiffness}, {clearance})[0]"
        elif law.exponent == 1.5:
            force = f"{stiffness} * {depth} * math.sqrt({depth})"
        elif law.exponent == 1.0:
            force = f"{stiffness} * {depth}"
        else:
            force = (
                f"{stiffness} * {depth} ** {self.parameter('exponent', law.exponent)}"
            )
        self.text.write(f"{self.value('elastic')} = {force}")

    def _call_normal(self, depth: str, rate: str, onset: str) -> str:
        """Return the call of a normal law with all of NORMAL_PARAMETERS."""
        numbers = self.record["normal"]
        words = ("stiffness", "exponent", "damping", "clearance")
        rest = (self.parameter(word, numbers[word]) for word in words)
        arguments = ", ".join((depth, rate, onset, *rest))
        law = self.joint.round_normal
        if law.user_law is None:
            return f"{ELASTICITIES[law.elasticity].__name__}({arguments})"
        return f"call(int({self.parameter('normal_law', numbers['address'])}), ({arguments}))"

    def _write_forces(self, onset: str, normal: Vector) -> None:
        """Write the forces and moments of a closed joint."""
        text = self.text
        size, across = self.name("normal_force"), ZERO
        text.write(f"{size} = {self._normal_force(onset)}")
        along = normal.times(f"-{size}")
        if self.joint.friction.coefficient > 0.0:
            across = self.name("friction_force")
            text.write(f"{across} = {self.friction.force(size)}")
            along = along.plus(normal.swept(across))
        force = Vector(self.name("force_x"), self.name("force_y"))
        text.write(f"{force.x} = {along.x}")
        text.write(f"{force.y} = {along.y}")
        self._write_moments(size, normal, force)
        with text.block("if level >= RATES:"):
            self._write_losses(size, across)
            if self.wears:
                self._write_wear(size)

    def _normal_force(self, onset: str) -> str:
        """Return the normal force, and write the closing speed at touchdown that it needs."""
        numbers, law = self.record["normal"], self.joint.round_normal
        elastic, closing = self.value("elastic"), self.value("closing")
        damping = self.parameter("damping", numbers["damping"])
        if law.user_law is None and damping == ZERO:
            return elastic
        if law.user_law is None and law.viscosity > 0.0:
            return f"max({elastic} + {product(damping, closing)}, {ZERO})"
        speed = f"{onset} if {onset} > {ZERO} else {self.value('rate')}"
        started = self.let("touchdown_speed", f"max({speed}, {self.onset_floor})")
        if law.user_law is None:
            return (
                f"max({elastic} * ({ONE} + {damping} * {closing} / {started}), {ZERO})"
            )
        return f"max({self._call_normal(self.value('penetration'), closing, started)}, {ZERO})"

    def _write_moments(self, size: str, normal: Vector, force: Vector) -> None:
        """Write the moments about both mass centres of a force at one common point."""
        reach = normal.times(self.value("pin_arm"))
        place = self.vector("eccentricity")
        couple = ZERO
        if self.is_worn and self.record["foundation"] > 0.0:
            # A penetration of 1e-19 m is closed, and its force rounds to zero.
            elastic = self.value("elastic")
            couple = f"{size} / {elastic} * {self.value('couple')}"
            couple = self.let(
                "couple_moment", f"{couple} if {elastic} > {ZERO} else {ZERO}"
            )
        if self.pin.place >= 0:
            point = self.text.let_vector(
                self.name("pin_point"), self.pin_arm.plus(reach)
            )
            self.text.write(
                f"{self.name('pin_moment')} = {total(point.cross(force), couple)}"
            )
        if self.bearing.place >= 0:
            point = self.bearing_arm.plus(place, reach)
            point = self.text.let_vector(self.name("bearing_point"), point)
            moment = negative(total(point.cross(force), couple))
            self.text.write(f"{self.name('bearing_moment')} = {moment}")

    def _write_losses(self, normal: str, across: str) -> None:
        """Write the powers lost in contact and in friction, and made by the normal law."""
        write = self.text.write
        closing = self.value("closing")
        contact_loss = self.name("contact_loss")
        loss = product(difference(normal, self.value("elastic")), closing)
        write(f"{contact_loss} = {loss}")
        if across != ZERO:
            friction_power = product(across, self.value("sliding"))
            write(f"{self.name('friction_loss')} = {negative(friction_power)}")
        if not self.makes_energy:
            return
        created = self.name("made")
        write(f"{created} = -min({loss}, {ZERO})")
        if self.is_worn:
            work = product(normal, difference(self.value("approach"), closing))
            write(f"{created} -= {work}")
            write(f"{contact_loss} += {work}")

    def _write_wear(self, normal: str) -> None:
        """Write the rates of wear: of the load distance, or also of pressure times slip."""
        write, depth = self.text.write, self.value("penetration")
        slip = f"abs({self.value('sliding')})"
        if self.record["slip_by_angle"]:
            turning = self.value("turning") if self.is_worn else self._turning()
            radius = self.parameter("pin_radius", self.joint.pin_radius)
            slip = f"({radius} + {depth}) * abs({turning})"
        work = self.name("wear_work")
        write(f"{work} = {normal} * {slip}")
        if self.record["over_arc"] and self.wears_by_pressure:
            radius = self.parameter("bearing_radius", self.joint.bearing_radius)
            across = self.parameter("width", self.joint.width)
            clearance = self.parameter("clearance", self.joint.clearance)
            area = f"{across} * {radius} * arc_width({depth}, {clearance})"
            self._write_pressure_dose(work, f"{normal} / ({area})", normal)
        elif self.wears_by_pressure:
            self._write_bin_wear(work, normal)

    def _write_bin_wear(self, work: str, normal: str) -> None:
        """Write the rate of pressure times slip, with the mean pressure over the chord."""
        depth = self.value("penetration")
        half = f"0.5 * {depth}"
        sizes = (
            self.value("eccentricity"),
            f"{self.value('bearing_arm')} - {half}",
            f"{self.value('pin_arm')} + {half}",
            self.parameter("width", self.joint.width),
        )
        area = f"contact_area({depth}, {', '.join(sizes)})"
        if self.record["pressure_exponent"] == 1.0:
            self.text.write(f"{self.name('wear_pressure')} = {work} / {area}")
        else:
            area = self.let("contact_area", area)
            dose = f"{work} / {area}"
            self._write_pressure_dose(dose, f"{normal} / {area}", normal)

    def _write_pressure_dose(self, dose: str, pressure: str, normal: str) -> None:
        """Write the rate of a dose times (p / p_ref)^(m - 1)."""
        wear = self.joint.wear
        assert wear is not None
        reference = self.parameter("pressure_reference", wear.pressure_reference)
        power = self.parameter("pressure_power", wear.pressure_exponent - 1.0)
        pressure = self.let("pressure", pressure)
        rate = f"{dose} * ({pressure} / {reference}) ** {power}"
        rate = f"{rate} if {normal} > {ZERO} else {ZERO}"
        self.text.write(f"{self.name('wear_pressure')} = {rate}")

    def _write_record(self) -> None:
        """Write the contact for the recorder."""
        if not self.is_worn:
            self.fields["turning"] = self._turning()
            energy = f"elastic_of(data.joints[{self.number}].normal, {self.value('penetration')})"
            self.fields["energy"] = self.let("elastic_energy", f"{energy}[1]")
        place = self.name("contact")
        if not self.is_worn:
            self.text.write(f"{place} = data.contacts[{self.number}]")
        forces = {"normal": "normal_force", "tangential": "friction_force"}
        self.fields |= {field: self.name(word) for field, word in forces.items()}
        for word, value in self.fields.items():
            if not (self.is_worn and word in _FILLED):
                self.text.write(f"{place}[{FIELDS[word]}] = {value}")
