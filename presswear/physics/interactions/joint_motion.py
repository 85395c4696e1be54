"""Motion of a pin relative to its bearing, written into the equations of a joint."""

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.physics.contact import CONTACT
from presswear.physics.equations.chain import Link
from presswear.physics.equations.text import ZERO, Vector, negative, product, total
from presswear.physics.interactions.page import Page
from presswear.tools.compile import Records

FIELDS = {name: i for i, name in enumerate(CONTACT.names or ())}


class JointText:
    """Writer of the equations of a clearance joint, whose variables begin with its name.

    ``record`` has the numbers of the joint, and ``number`` is its index among the
    clearance joints. The arms are vectors from the mass centres of the bodies to the
    centres of bearing and pin.
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

    def name(self, word: str) -> str:
        """Return the name of a variable of the joint."""
        return f"{self.prefix}_{word}"

    def let(self, word: str, expression: str) -> str:
        """Assign an expression to a variable of the joint."""
        return self.text.let(self.name(word), expression)

    def let_vector(self, word: str, vector: Vector) -> Vector:
        """Assign both components of a vector to variables of the joint."""
        return self.text.let_vector(self.name(word), vector)

    def parameter(self, word: str, value: float) -> str:
        """Return the name of a number of the joint."""
        return self.text.parameter(self.name(word), value)


class MotionText(JointText):
    """Writer of the motion of a pin in its bearing.

    ``fields`` has the expression, or the name of the variable, of each field of CONTACT
    that has been written.
    """

    def __init__(
        self, page: Page, joint: ClearanceJoint, record: Records, number: int
    ) -> None:
        super().__init__(page, joint, record, number)
        self.fields: dict[str, str] = {}

    @property
    def uses_kernel(self) -> bool:
        """True if a kernel for worn surfaces computes the penetration."""
        return bool(self.record["surface_bins"] > 0)

    @property
    def onset_floor(self) -> str:
        """Name of the lower limit of the closing speed in the damping law."""
        return "ONSET_SPEED_FLOOR"

    def value(self, word: str) -> str:
        """Return the expression of a field of CONTACT."""
        return self.fields.get(word, ZERO)

    def vector(self, word: str) -> Vector:
        """Return the expressions of the x and y fields of a vector in CONTACT."""
        return Vector(self.value(f"{word}_x"), self.value(f"{word}_y"))

    def write_motion(self) -> None:
        """Write position and velocity of the pin relative to the bearing."""
        pin = self.pin
        bearing = self.bearing
        bearing_centre = bearing.position.plus(self.bearing_arm)
        distance = pin.position.plus(self.pin_arm).minus(bearing_centre)
        eccentricity = self.let_vector("eccentricity", distance)
        bearing_velocity = bearing.velocity_at(self.bearing_arm)
        relative_velocity = pin.velocity_at(self.pin_arm).minus(bearing_velocity)
        velocity = self.let_vector("velocity", relative_velocity)
        length = f"math.sqrt({eccentricity.dot(eccentricity)})"
        self.fields["eccentricity"] = self.let("eccentricity", length)
        self.set_fields("eccentricity", eccentricity)
        self.set_fields("velocity", velocity)
        self._set_link("bearing", bearing, self.bearing_arm)
        self._set_link("pin", pin, self.pin_arm)

    def write_sliding(self) -> str:
        """Write the sliding speed of the pin on the bearing; return its variable."""
        normal = self.vector("normal")
        speed = total(
            normal.cross(self.vector("velocity")),
            product(self.pin.omega, self.value("pin_arm")),
            negative(product(self.bearing.omega, self.value("bearing_arm"))),
        )
        self.fields["sliding"] = self.let("sliding", speed)
        return self.fields["sliding"]

    def turning(self) -> str:
        """Write the angular velocity of the eccentricity; return its variable."""
        cross = self.vector("eccentricity").cross(self.vector("velocity"))
        size = self.value("eccentricity")
        rate = f"({cross}) / ({size} * {size}) if {size} > {ZERO} else {ZERO}"
        return self.let("turning", rate)

    def _set_link(self, end: str, link: Link, arm: Vector) -> None:
        """Set angle, angular velocity and lever of the body of an end."""
        self.fields[f"{end}_angle"] = link.angle
        self.fields[f"{end}_spin"] = link.omega
        is_frame = link.index < 0  # it has no mass centre
        self.set_fields(f"{end}_lever", Vector() if is_frame else arm)

    def set_fields(self, name: str, vector: Vector) -> None:
        """Set the x and y fields of a vector."""
        self.fields |= {f"{name}_x": vector.x, f"{name}_y": vector.y}
