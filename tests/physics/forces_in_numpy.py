"""Forces on all bodies of a linkage in vectors of numpy, with which written ones are compared."""

import math
from typing import Any, NamedTuple

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import Force
from presswear.linkage.points import GROUND, Attachment
from presswear.physics.contact import CONTACT, note_foundation, note_radial
from presswear.physics.equations.layout import WEAR_INTEGRAL_COUNT
from presswear.physics.friction_and_normal import (
    ONSET_SPEED_FLOOR,
    elastic_of,
    friction_force,
    normal_force,
)
from presswear.physics.interactions.lugre import (
    bristle_force,
    bristle_rate,
    bristles_of,
)
from presswear.physics.loads import load_size
from presswear.physics.packed import Packed
from presswear.physics.wear import contact_area
from presswear.tools.arrays import Array
from presswear.tools.compile import Records


def across(vector: Array) -> Array:
    """Turn a vector by a right angle."""
    return np.array([-vector[1], vector[0]])


def moment_of(arm: Array, force: Array) -> float:
    return float(arm[0] * force[1] - arm[1] * force[0])


class End(NamedTuple):
    """A point of a body; the body's first coordinate, -1 for the frame."""

    body: int
    place: Array
    velocity: Array
    arm: Array
    angle: float
    spin: float


class Forces:
    """Forces, contacts and rates of the integrals of a linkage in a state."""

    def __init__(
        self, linkage: Linkage, packed: Packed, t: float, q: Array, v: Array
    ) -> None:
        self.linkage = linkage
        self.packed = packed
        self.t = t
        self.q = q
        self.v = v
        self.force = packed.weight.copy()
        self.supplied = self.contact_loss = self.friction_loss = self.made = 0.0
        self.contacts = np.zeros(len(packed.joints), CONTACT)
        self.wear_rates = np.zeros((len(packed.joints), WEAR_INTEGRAL_COUNT))
        self.states = list[float]()
        self.state_rates = list[float]()

    def all(self, onset: Array, states: Array) -> "Forces":
        """Add up springs, loads and contacts."""
        self.states = list(states)
        self._springs()
        self._loads()
        for k, joint in enumerate(self.linkage.clearances):
            contact = self.contacts.view(np.recarray)[k]
            ends = self._end(joint.bearing), self._end(joint.pin)
            self._contact(k, contact, *ends)
            self._contact_forces(k, contact, float(onset[k]), *ends)
        return self

    @property
    def energies(self) -> Array:
        """Powers of loads, contacts and friction, W, in the order of ENERGIES."""
        return np.array(
            [self.supplied, self.contact_loss, self.friction_loss, self.made]
        )

    def _end(self, point: Attachment) -> End:
        local = np.array([point.x, point.y])
        if point.body == GROUND:
            return End(-1, local, np.zeros(2), np.zeros(2), 0.0, 0.0)
        i = 3 * self.linkage.index(point.body)
        c = math.cos(self.q[i + 2])
        s = math.sin(self.q[i + 2])
        arm = np.array([[c, -s], [s, c]]) @ local
        velocity = self.v[i : i + 2] + self.v[i + 2] * across(arm)
        return End(
            i, self.q[i : i + 2] + arm, velocity, arm, self.q[i + 2], self.v[i + 2]
        )

    def _push(
        self, end: End, force: Array, arm: Array | None = None, couple: float = 0.0
    ) -> None:
        if end.body >= 0:
            moment = moment_of(end.arm if arm is None else arm, force) + couple
            self.force[end.body : end.body + 3] += *force, moment

    def _springs(self) -> None:
        for spring in self.linkage.springs:
            first, second = (self._end(point) for point in spring.ends)
            way = second.place - first.place
            unit = way / np.hypot(*way)
            rate = unit @ (second.velocity - first.velocity)
            stretch = float(np.hypot(*way)) - spring.length
            pull = spring.stiffness * stretch + spring.damping * rate
            self.supplied -= spring.damping * rate**2
            self._push(first, pull * unit)
            self._push(second, -pull * unit)

    def _loads(self) -> None:
        loads = self.packed.loads
        for k, load in enumerate(self.linkage.loads_with_law):
            record = loads.records[k]
            along = np.array([record["cosine"], record["sine"]])
            if isinstance(load, Force):
                end = self._end(load.attachment)
                place = float(along @ end.place)
                speed = float(along @ end.velocity)
            else:
                end = self._end(Attachment(load.body, 0.0, 0.0))
                place = along[0] * end.angle
                speed = along[0] * end.spin
            place -= float(record["zero"])
            size = load_size(record, loads.nodes, loads.modes[k], self.t, place, speed)
            self.supplied += size * speed
            if isinstance(load, Force):
                self._push(end, size * along)
            else:
                self._push(end, np.zeros(2), couple=size * along[0])

    def _contact(self, k: int, contact: Any, bearing: End, pin: End) -> None:
        """Fill the contact of joint ``k`` but for its forces."""
        joint = self.packed.joints[k]
        surfaces = self.packed.surfaces[k]
        e = pin.place - bearing.place
        rate_of_e = pin.velocity - bearing.velocity
        size = math.hypot(*e)
        contact.eccentricity = size
        contact.eccentricity_x, contact.eccentricity_y = e
        contact.velocity_x, contact.velocity_y = rate_of_e
        contact.turning = moment_of(e, rate_of_e) / size**2 if size > 0.0 else 0.0
        for name, end in (("bearing", bearing), ("pin", pin)):
            contact[f"{name}_angle"] = end.angle
            contact[f"{name}_spin"] = end.spin
            contact[f"{name}_lever_x"], contact[f"{name}_lever_y"] = end.arm
        if joint["surface_bins"] > 0:
            zero = joint["map_turns"] * bearing.angle
            contact.map_x, contact.map_y = math.cos(zero), math.sin(zero)
            if joint["foundation"] > 0.0:
                note_foundation(joint, surfaces, contact, True)
            else:
                note_radial(joint, surfaces, contact)
        else:
            self._round(joint, contact, e, rate_of_e)
        normal = np.array([contact.normal_x, contact.normal_y])
        slip = across(normal) @ rate_of_e
        contact.sliding = (
            slip + pin.spin * contact.pin_arm - bearing.spin * contact.bearing_arm
        )

    def _round(self, joint: Records, contact: Any, e: Array, rate_of_e: Array) -> None:
        size = contact.eccentricity
        normal = e / size if size > 0.0 else np.array([1.0, 0.0])
        contact.normal_x, contact.normal_y = normal
        contact.penetration = size - joint["clearance"]
        contact.rate = contact.approach = contact.closing = normal @ rate_of_e
        indentation = 0.5 * max(contact.penetration, 0.0)
        contact.pin_arm = joint["pin_radius"] - indentation
        contact.bearing_arm = joint["bearing_radius"] + indentation
        contact.elastic, contact.energy = elastic_of(
            joint["normal"], contact.penetration
        )

    def _contact_forces(
        self, k: int, contact: Any, onset: float, bearing: End, pin: End
    ) -> None:
        joint = self.packed.joints[k]
        is_closed = contact.penetration > 0.0
        law = self.linkage.clearances[k].friction
        has_bristles = law.name == "lugre"
        if has_bristles:
            bristles = bristles_of(law)
            bristle = self.states[len(self.state_rates)]
            rate = bristle_rate(contact.sliding, bristle, is_closed, bristles)
            self.state_rates.append(rate)
        if not is_closed or onset < 0.0:
            return
        onset = max(onset if onset > 0.0 else contact.closing, ONSET_SPEED_FLOOR)
        depth = contact.penetration
        closing = contact.closing
        contact.normal = normal_force(
            joint["normal"], contact.elastic, depth, closing, onset
        )
        if has_bristles:
            motion = contact.sliding, bristle, rate
            contact.tangential = bristle_force(contact.normal, *motion, bristles)
        elif law.coefficient > 0.0:
            record = joint["friction"]
            contact.tangential = friction_force(contact.sliding, contact.normal, record)
        normal = np.array([contact.normal_x, contact.normal_y])
        force = contact.tangential * across(normal) - contact.normal * normal
        point = pin.place + contact.pin_arm * normal
        couple = 0.0
        if contact.elastic > 0.0:
            couple = contact.normal / contact.elastic * contact.couple
        # The arms from the mass centres to the point at which both forces act
        on_pin = point - pin.place + pin.arm
        self._push(pin, force, on_pin, couple)
        self._push(bearing, -force, point - bearing.place + bearing.arm, -couple)
        self._losses(k, contact)

    def _losses(self, k: int, contact: Any) -> None:
        joint = self.packed.joints[k]
        normal = contact.normal
        stored = contact.elastic * contact.closing
        damped = normal * contact.closing - stored
        self.made += normal * (contact.closing - contact.approach) - min(damped, 0.0)
        self.contact_loss += normal * contact.approach - stored
        self.friction_loss -= contact.tangential * contact.sliding
        if joint["wear_coefficient"] == 0.0:
            return
        slip = abs(contact.sliding)
        if joint["slip_by_angle"]:
            slip = (joint["pin_radius"] + contact.penetration) * abs(contact.turning)
        half = 0.5 * contact.penetration
        width = joint["width"]
        radii = contact.bearing_arm - half, contact.pin_arm + half
        area = contact_area(contact.penetration, contact.eccentricity, *radii, width)
        self.wear_rates[k, 0] = normal * slip
        if not joint["over_arc"]:
            self.wear_rates[k, 1] = normal * slip / area
