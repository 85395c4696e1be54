"""Rates of wear of a contact, written into the equations of a joint."""

from presswear.physics.equations.text import ZERO
from presswear.physics.interactions.joint_motion import MotionText
from presswear.physics.interactions.page import Kernels
from presswear.physics.pressure_wear import arc_width
from presswear.physics.wear import contact_area

WEAR_KERNELS: Kernels = (arc_width, contact_area)


class WearText:
    """Writer of the rates of load distance and of pressure times slip.

    ``uses_pressure`` is true if wear needs the integral of a power of the pressure
    times slip.
    """

    def __init__(self, motion: MotionText, uses_pressure: bool) -> None:
        self.motion = motion
        self.joint = motion.joint
        self.record = motion.record
        self.text = motion.text
        self.uses_pressure = uses_pressure

    def declare_rates(self) -> list[str]:
        """Declare the wear integrals of the joint; return the words of their variables."""
        motion = self.motion
        words = ["wear_work"]
        motion.page.set_wear_rate(motion.number, "work", motion.name("wear_work"))
        if self.uses_pressure:
            words.append("wear_pressure")
            name = motion.name("wear_pressure")
            motion.page.set_wear_rate(motion.number, "pressure", name)
        return words

    def write(self, normal_force: str) -> None:
        """Write the rates of the wear integrals under a normal force."""
        motion = self.motion
        slip = self._slip()
        work = motion.name("wear_work")
        self.text.write(f"{work} = {normal_force} * {slip}")
        if self.record["wear_address"]:
            self.text.write(f"{motion.name('wear_pressure')} = {slip}")
        elif self.uses_pressure and self.record["over_arc"]:
            self._write_arc_wear(work, normal_force)
        elif self.uses_pressure:
            self._write_bin_wear(work, normal_force)

    def _slip(self) -> str:
        """Return the speed of slip; see ``WearLaw.slip``."""
        motion = self.motion
        if not self.record["slip_by_angle"]:
            return f"abs({motion.value('sliding')})"
        turning = motion.value("turning") if motion.uses_kernel else motion.turning()
        radius = motion.parameter("pin_radius", self.joint.pin_radius)
        return f"({radius} + {motion.value('penetration')}) * abs({turning})"

    def _write_arc_wear(self, work: str, normal_force: str) -> None:
        """Write the rate of pressure times slip, with the mean pressure over the arc."""
        motion = self.motion
        depth = motion.value("penetration")
        radius = motion.parameter("bearing_radius", self.joint.bearing_radius)
        width = motion.parameter("width", self.joint.width)
        clearance = motion.parameter("clearance", self.joint.clearance)
        area = f"{width} * {radius} * arc_width({depth}, {clearance})"
        pressure = f"{normal_force} / ({area})"
        self._write_pressure_rate(work, pressure, normal_force)

    def _write_bin_wear(self, work: str, normal_force: str) -> None:
        """Write the rate of pressure times slip, with the mean pressure over the chord."""
        motion = self.motion
        depth = motion.value("penetration")
        half = f"0.5 * {depth}"
        arguments = (
            depth,
            motion.value("eccentricity"),
            f"{motion.value('bearing_arm')} - {half}",
            f"{motion.value('pin_arm')} + {half}",
            motion.parameter("width", self.joint.width),
        )
        area = f"contact_area({', '.join(arguments)})"
        if self.record["pressure_exponent"] == 1.0:
            self.text.write(f"{motion.name('wear_pressure')} = {work} / {area}")
        else:
            area = motion.let("contact_area", area)
            pressure = f"{normal_force} / {area}"
            self._write_pressure_rate(f"{work} / {area}", pressure, normal_force)

    def _write_pressure_rate(
        self, base_rate: str, pressure: str, normal_force: str
    ) -> None:
        """Write the rate of a wear integral with the factor (p / p_ref)^(m - 1)."""
        motion = self.motion
        law = self.joint.wear
        assert law is not None
        reference = motion.parameter("pressure_reference", law.pressure_reference)
        power = motion.parameter("pressure_power", law.pressure_exponent - 1.0)
        pressure = motion.let("pressure", pressure)
        rate = f"{base_rate} * ({pressure} / {reference}) ** {power}"
        rate = f"{rate} if {normal_force} > {ZERO} else {ZERO}"
        self.text.write(f"{motion.name('wear_pressure')} = {rate}")
