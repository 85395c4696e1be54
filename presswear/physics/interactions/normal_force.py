"""Normal force of a contact, written into the equations of a joint."""

from presswear.physics.equations.text import ONE, ZERO, product
from presswear.physics.friction_and_normal import (
    ELASTICITIES,
    elastic_of,
    round_foundation,
)
from presswear.physics.interactions.joint_motion import MotionText
from presswear.physics.interactions.page import Kernels

NORMAL_KERNELS: Kernels = (
    elastic_of,
    round_foundation,
    *(law for law in ELASTICITIES.values() if not isinstance(law, int)),
)


class NormalForceText:
    """Writer of the elastic force and of the normal force with damping."""

    def __init__(self, motion: MotionText) -> None:
        self.motion = motion
        self.law = motion.joint.round_normal
        self.record = motion.record["normal"]

    def elastic(self) -> str:
        """Return the elastic force of round surfaces."""
        motion = self.motion
        law = self.law
        depth = motion.value("penetration")
        stiffness = motion.parameter("stiffness", self.record["stiffness"])
        is_function = not isinstance(ELASTICITIES[law.elasticity], int)
        if law.user_law is not None or is_function:
            return self._call(depth, ZERO, ONE)
        if law.elasticity == "foundation":
            clearance = motion.parameter("clearance", motion.joint.clearance)
            return f"round_foundation({depth}, {stiffness}, {clearance})[0]"
        if law.exponent == 1.5:
            return f"{stiffness} * {depth} * math.sqrt({depth})"
        if law.exponent == 1.0:
            return f"{stiffness} * {depth}"
        exponent = motion.parameter("exponent", law.exponent)
        return f"{stiffness} * {depth} ** {exponent}"

    def force(self, onset: str) -> str:
        """Return the normal force; write the closing speed at touchdown for laws with damping.

        ``onset`` is this speed, or zero in a contact that has just begun.
        """
        motion = self.motion
        law = self.law
        elastic = motion.value("elastic")
        closing = motion.value("closing")
        damping = motion.parameter("damping", self.record["damping"])
        if law.user_law is None and damping == ZERO:
            return elastic
        if law.user_law is None and law.viscosity > 0.0:
            return f"max({elastic} + {product(damping, closing)}, {ZERO})"
        speed = f"{onset} if {onset} > {ZERO} else {closing}"
        limited = f"max({speed}, {motion.onset_floor})"
        touchdown_speed = motion.let("touchdown_speed", limited)
        if law.user_law is None:
            factor = f"({ONE} + {damping} * {closing} / {touchdown_speed})"
            return f"max({elastic} * {factor}, {ZERO})"
        depth = motion.value("penetration")
        return f"max({self._call(depth, closing, touchdown_speed)}, {ZERO})"

    def _call(self, depth: str, rate: str, onset: str) -> str:
        """Return the call of a normal law with all of NORMAL_PARAMETERS."""
        motion = self.motion
        numbers = ("stiffness", "exponent", "damping", "clearance")
        parameters = [motion.parameter(name, self.record[name]) for name in numbers]
        arguments = ", ".join([depth, rate, onset, *parameters])
        if self.law.user_law is None:
            return f"{ELASTICITIES[self.law.elasticity].__name__}({arguments})"
        address = motion.parameter("normal_law", self.record["address"])
        return f"call(int({address}), ({arguments}))"
