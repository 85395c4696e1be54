"""Oil between a pin and its bearing: a film without mass in series with the elastic contact.

The eccentricity e of the pin is the sum of the eccentricity e_f on a film between rigid
surfaces, which is a state of the equations, and of the deformation u = e - e_f of the
elastic contact. The force of the contact on the pin is F = -F_e u / |u| - D u', equal to
the sum of the forces of film and asperities. The force of the film gives e_f' in closed
form.

Velocities are relative to a frame that rotates at the mean of the angular velocities of
pin and bearing: there both surfaces move oppositely, and their motion alone draws no oil
into the gap. Each body takes half of the couple e x F. The power of all forces is then
that of F on the velocities in this frame.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, NamedTuple, Self

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.linkage import Linkage
from presswear.linkage.oil import Oil
from presswear.linkage.point_position import point_position
from presswear.physics.equations.layout import State
from presswear.physics.equations.text import (
    ONE,
    ZERO,
    Vector,
    difference,
    negative,
    product,
    total,
)
from presswear.physics.friction_and_normal import elastic_of
from presswear.physics.interactions.friction import FrictionWithoutState
from presswear.physics.interactions.joint_motion import FIELDS, JointText
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.mixed_lubrication import DECAY, shear_moment
from presswear.physics.oil_film import OilFilm, film_of, film_velocity
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled

# Least gap over the clearance in the formulas of the film, far below any roughness
THINNEST = 1e-6
# Gap over the clearance, at least, of a pin that starts pressed into its bearing
THINNEST_AT_START = 1e-3
# Smallest change of the place on the film that matters, over the clearance
SCALE = 1e-3


class OiledBearing(NamedTuple):
    """Parameters of an oiled bearing."""

    film: OilFilm
    clearance: float  # m
    asperity_size: float  # p_0 B R, N
    roughness: float  # sigma of both surfaces together, m


@compiled
def asperity_force(
    eccentricity: float, half_chord: float, bearing: OiledBearing
) -> float:
    """Return the force of asperities, N, at a place of the pin on the rigid film, m.

    F = p_0 B R [sqrt(2 pi kappa sigma / c) + 2 sin s] exp((|e_f| - c) / (kappa sigma)),
    with the half angle s of the elastic arc; ``half_chord`` is sin s.
    """
    reach = DECAY * bearing.roughness
    share = math.sqrt(2.0 * math.pi * reach / bearing.clearance) + 2.0 * half_chord
    closeness = math.exp((eccentricity - bearing.clearance) / reach)
    return bearing.asperity_size * share * closeness


@compiled
def contact_damping(
    elastic: float, energy: float, mass: float, damping_ratio: float
) -> tuple[float, float]:
    """Return the damping D of the elastic contact, N s/m, and its relaxation time, s.

    With D = 2 zeta F_e sqrt(m / 2 U) the mass m leaves the contact as a linear oscillator
    does: with the same restitution at any speed, for any elastic law F_e with the energy U
    (Antypov and Elliott, 2011, for spheres; Feng, 2026, for powers). The relaxation time is
    D over the stiffness F_e^2 / 2 U.
    """
    if not energy > 0.0:
        return 0.0, 0.0
    damping = 2.0 * damping_ratio * elastic * math.sqrt(0.5 * mass / energy)
    return damping, damping * 2.0 * energy / (elastic * elastic)


@compiled
def film_velocity_of(
    place: tuple[float, float],
    force: tuple[float, float],
    contact: tuple[float, float, float],
    bearing: OiledBearing,
) -> tuple[float, float, float]:
    """Return e_f' in the turning frame, m/s, and the force of the asperities, N.

    The material of the asperities has the relaxation time of the contact. Without it, an
    opening film, which resists little, would follow them at rates above 1e6 1/s.

    Parameters
    ----------
    place : tuple of float
        Place of the pin on the film, e_f, m.
    force : tuple of float
        Of film and asperities on the pin, N, for e_f' = 0; with e_f' it grows by D e_f'.
    contact : tuple of float
        Sine of the half angle of the elastic arc, damping D, N s/m, and relaxation time, s.
    bearing : OiledBearing
        Parameters.
    """
    x, y = place
    half_chord, damping, relaxation = contact
    eccentricity = math.sqrt(x * x + y * y)
    size = math.sqrt(force[0] * force[0] + force[1] * force[1])
    # A centred pin moves along the force; without a force any direction serves.
    nx = 1.0
    ny = 0.0
    if eccentricity > 0.0:
        nx = x / eccentricity
        ny = y / eccentricity
    elif size > 0.0:
        nx = -force[0] / size
        ny = -force[1] / size
    rough = asperity_force(eccentricity, half_chord, bearing)
    stiffness = rough / (DECAY * bearing.roughness)
    clearance = bearing.clearance
    dampings = (
        clearance * (damping + relaxation * stiffness),
        clearance * damping,
    )
    gap = max(1.0 - eccentricity / clearance, THINNEST)
    along = force[0] * nx + force[1] * ny + rough
    across = force[1] * nx - force[0] * ny
    closing, wedge = film_velocity(gap, along, across, bearing.film, dampings)
    outwards = clearance * closing
    sideways = -clearance * wedge
    return outwards * nx - sideways * ny, outwards * ny + sideways * nx, rough


@compiled
def chord_of(stretch: float, clearance: float) -> float:
    """Return sin s of the elastic arc, cos s = c / (c + |u|), at a stretch |u|, m."""
    reach = clearance + stretch
    return math.sqrt(stretch * (clearance + reach)) / reach


def start_on_film(
    linkage: Linkage, joint: ClearanceJoint, axis: int, position: Array
) -> float:
    """Return a coordinate of the place on the film, m, where the elastic contact starts free."""
    pin = point_position(linkage, joint.pin, position.tolist())
    bearing = point_position(linkage, joint.bearing, position.tolist())
    largest = (1.0 - THINNEST_AT_START) * joint.clearance
    fraction = largest / max(math.dist(pin, bearing), largest)
    return fraction * (pin[axis] - bearing[axis])


@dataclass(frozen=True)
class OiledContact:
    """Contact of an oiled joint for the equations: always closed, without events."""

    joint: ClearanceJoint
    record: Records  # dtype JOINT
    number: int  # index among the clearance joints

    kernels: ClassVar[Kernels] = (
        OilFilm,
        OiledBearing,
        chord_of,
        contact_damping,
        film_velocity_of,
        elastic_of,
        shear_moment,
        *FrictionWithoutState.kernels,
    )

    @classmethod
    def all_of(cls, linkage: Linkage, packed: Packed) -> list[Self]:
        """Return all oiled joints of a linkage."""
        pairs = zip(linkage.clearances, packed.joints, strict=True)
        return [
            cls(joint, record, k)
            for k, (joint, record) in enumerate(pairs)
            if joint.oil is not None
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
        """Write the rate of e_f, the forces on both bodies, powers, and the rate of wear."""
        _OilText(page, self.joint, self.record, self.number).write()


class _OilText(JointText):
    """Writer of the equations of an oiled joint."""

    def write(self) -> None:
        """Write the rate of e_f, the forces on both bodies, powers, and the rate of wear."""
        text = self.text
        page = self.page
        text.comment(f"{self.joint.name}: oiled pin of {self.joint.pin.body}")
        ends = self.joint.bearing, self.joint.pin
        eccentricity, velocity = page.chain.relative_motion(text, ends, self.prefix)
        indices = self._declare_film()
        film = self.let_vector("film", Vector(*(f"y[{i}]" for i in indices)))
        elastic = self._write_elastic(eccentricity.minus(film))
        mean = product("0.5", total(self.pin.omega, self.bearing.omega))
        mean = self.let("mean_speed", mean)
        velocity = velocity.minus(eccentricity.rotated_at(mean))
        velocity = self.let_vector("velocity", velocity)
        film_velocity = self._write_film_velocity(film, velocity, elastic)
        rate = film_velocity.plus(film.rotated_at(mean))
        rate = self.let_vector("film_rate", rate)
        for i, component in zip(indices, rate, strict=True):
            text.write(f"out[{i}] = {component}")
        stretching = velocity.minus(film_velocity)
        stretching = self.let_vector("stretching", stretching)
        force = elastic.minus(stretching.times(self.name("damping")))
        force = self.let_vector("force", force)
        moment, friction_loss = self._write_friction(film)
        self._add_forces(eccentricity, force, moment)
        damped = product(self.name("damping"), stretching.dot(stretching))
        loss = difference(damped, force.dot(film_velocity))
        loss = self.let("loss", loss)
        page.add_power("contact_loss", loss)
        page.add_power("friction_loss", friction_loss)
        with text.block("if level == END:"):
            self._write_record(film, rate, force, total(loss, friction_loss))

    def _write_film_velocity(
        self, film: Vector, velocity: Vector, elastic: Vector
    ) -> Vector:
        """Write e_f' in the rotating frame."""
        clearance = self.parameter("clearance", self.joint.clearance)
        damping = self.name("damping")
        # Force on the pin for e_f' = 0
        force = elastic.minus(velocity.times(damping))
        chord = f"chord_of({self.name('stretch')}, {clearance})"
        arguments = (
            f"({film.x}, {film.y})",
            f"({force.x}, {force.y})",
            f"({chord}, {damping}, {self.name('relaxation')})",
            self._parameters(),
        )
        call = f"film_velocity_of({', '.join(arguments)})"
        result = Vector(self.name("film_velocity_x"), self.name("film_velocity_y"))
        self.text.write(f"{result.x}, {result.y}, {self.name('rough')} = {call}")
        return result

    def _declare_film(self) -> list[int]:
        """Declare both coordinates of e_f as states; return their indices in ``y``."""
        indices = []
        for i, axis in enumerate("xy"):
            state = State(
                name=self.name(f"film_{axis}"),
                scale=SCALE * self.joint.clearance,
                at_start=partial(start_on_film, self.page.chain.linkage, self.joint, i),
            )
            indices.append(self.page.add_state(state))
        return indices

    def _write_elastic(self, deformation: Vector) -> Vector:
        """Write the damping of the contact; return the elastic force on the pin."""
        text = self.text
        deformation = self.let_vector("stretch", deformation)
        size = self.let("stretch", f"math.sqrt({deformation.dot(deformation)})")
        elastic = self.name("elastic")
        energy = self.name("energy")
        law = f"elastic_of(data.joints[{self.number}].normal, {size})"
        text.write(f"{elastic}, {energy} = {law}")
        effective_mass = float(self.record["effective_mass"])
        if not math.isfinite(effective_mass):
            effective_mass = 0.0  # Between two prescribed bodies nothing oscillates.
        mass = self.parameter("mass", effective_mass)
        ratio = self.parameter("damping_ratio", self._oil.damping_ratio)
        call = f"contact_damping({elastic}, {energy}, {mass}, {ratio})"
        text.write(f"{self.name('damping')}, {self.name('relaxation')} = {call}")
        factor = f"{elastic} / {size} if {size} > {ZERO} else {ZERO}"
        factor = self.let("factor", factor)
        return self.let_vector("pull", deformation.times(f"-{factor}"))

    def _add_forces(self, eccentricity: Vector, force: Vector, moment: str) -> None:
        """Add force and moment to those on both bodies, the force in the middle of e."""
        couple = self.let("couple", eccentricity.cross(force))
        half = product("0.5", couple)
        self.pin.add_force(self.pin_arm, force)
        self.bearing.add_force(self.bearing_arm, force.times(f"-{ONE}"))
        self.pin.moments.append(difference(moment, half))
        self.bearing.moments.append(negative(total(moment, half)))

    def _parameters(self) -> str:
        """Return the expression of the parameters of the bearing."""
        joint = self.joint
        oil = self._oil
        film = film_of(
            joint.width / oil.films,
            joint.bearing_radius,
            joint.clearance,
            oil.viscosity,
        )
        asperity_size = oil.asperity_pressure * joint.width * joint.bearing_radius
        ratio = self.parameter("width_ratio", film.width_ratio)
        film_size = self.parameter("film_size", oil.films * film.size)
        arguments = (
            f"OilFilm({ratio}, {film_size})",
            self.parameter("clearance", joint.clearance),
            self.parameter("asperity_size", asperity_size),
            self.parameter("roughness", oil.roughness),
        )
        return f"OiledBearing({', '.join(arguments)})"

    @property
    def _oil(self) -> Oil:
        """Oil of the joint."""
        assert self.joint.oil is not None
        return self.joint.oil

    def _write_shear(self, film: Vector, spin: str) -> str:
        """Write the moment of the sheared oil against the rotation of the pin."""
        radius = self.parameter("radius", self.joint.bearing_radius)
        width = self.parameter("width", self.joint.width)
        viscosity = self.parameter("viscosity", self._oil.viscosity)
        clearance = self.parameter("clearance", self.joint.clearance)
        gap = f"max(1.0 - math.sqrt({film.dot(film)}) / {clearance}, {THINNEST})"
        sizes = f"({width}, {radius}, {clearance})"
        call = f"shear_moment({gap}, {spin}, {viscosity}, {sizes})"
        return self.let("shear", call)

    def _write_friction(self, film: Vector) -> tuple[str, str]:
        """Write the shear of the oil and the friction of asperities.

        Returns the moment on the pin, and the power of both losses.
        """
        joint = self.joint
        spin = self.let("spin", difference(self.pin.omega, self.bearing.omega))
        shear = self._write_shear(film, spin)
        radius = self.parameter("radius", joint.bearing_radius)
        sliding = self.let("sliding", product(radius, spin))
        rough = self.name("rough")
        if joint.wear is not None:
            self.page.set_wear_rate(self.number, "work", f"{rough} * abs({sliding})")
        if joint.friction.coefficient == 0.0:
            self.text.write(f"{self.name('friction')} = {ZERO}")
            return f"-{shear}", product(shear, spin)
        law = FrictionWithoutState(
            self.page, self.prefix, joint.friction, self.record["friction"]
        )
        law.write_state(sliding, ONE)
        friction = self.let("friction", law.force(rough))
        moment = self.let("moment", f"{radius} * {friction} - {shear}")
        return moment, difference(product(shear, spin), product(friction, sliding))

    def _write_record(
        self, film: Vector, rate: Vector, force: Vector, loss: str
    ) -> None:
        """Write the contact for the recorder: the eccentricity is that on the rigid film.

        ``rate`` is the rate of e_f, and ``loss`` the power that the joint takes, W.
        Asperities bear where the film is least, over the arc of the elastic contact. As in
        a dry joint, the length of the arc follows from the clearance and the penetration.
        """
        text = self.text
        penetration = self.name("stretch")
        size = self.let("place", f"math.sqrt({film.dot(film)})")
        fields = {
            "penetration": penetration,
            "eccentricity": f"{self.name('clearance')} + {penetration}",
            "eccentricity_x": film.x,
            "eccentricity_y": film.y,
            "velocity_x": rate.x,
            "velocity_y": rate.y,
            "sliding": self.name("sliding"),
            "normal_x": f"{film.x} / {size} if {size} > {ZERO} else {ONE}",
            "normal_y": f"{film.y} / {size} if {size} > {ZERO} else {ZERO}",
            "elastic": self.name("elastic"),
            "energy": self.name("energy"),
            "normal": f"math.sqrt({force.dot(force)})",
            "tangential": self.name("friction"),
            "film_loss": loss,
            "bearing_angle": self.bearing.angle,
            "bearing_spin": self.bearing.omega,
            "pin_angle": self.pin.angle,
            "pin_spin": self.pin.omega,
        }
        contact = self.let("contact", f"data.contacts[{self.number}]")
        for field, value in fields.items():
            text.write(f"{contact}[{FIELDS[field]}] = {value}")
