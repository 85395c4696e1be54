"""Oil between a pin and its bearing: a film without mass in series with the elastic contact.

The place e_f of the pin on a rigid film is a state. The elastic contact is stretched by
u = e - e_f, and its force F = -F_e u / |u| - D u' on the pin is that of the film and of
the asperities together. The film's part gives the rate of e_f in closed form.

Velocities are those in a frame that turns at half the sum S of the speeds of pin and
bearing. Each body bears half of the couple e x F, so that the power is that of F there.
The mean of both speeds draws no oil in there.
"""

import math
from dataclasses import dataclass
from functools import partial
from typing import ClassVar, NamedTuple, Self

from presswear.linkage.clearance_joint import ClearanceJoint
from presswear.linkage.linkage import Linkage, place_of
from presswear.physics.contact import CONTACT
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
from presswear.physics.interactions.page import Kernels, Page
from presswear.physics.mixed_lubrication import DECAY, shear_moment
from presswear.physics.oil_film import OilFilm, film_of, film_velocity
from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled

FIELDS = {name: i for i, name in enumerate(CONTACT.names or ())}

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
    pin = place_of(linkage, joint.pin, position.tolist())
    bearing = place_of(linkage, joint.bearing, position.tolist())
    largest = (1.0 - THINNEST_AT_START) * joint.clearance
    fraction = largest / max(math.dist(pin, bearing), largest)
    return fraction * (pin[axis] - bearing[axis])


@dataclass(frozen=True)
class OiledContact:
    """The contact of an oiled joint, as text: always closed, without events."""

    joint: ClearanceJoint
    record: Records  # of JOINT
    number: int  # among the clearance joints

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
        """Return 0: the elastic energies of contacts are in the memory of the joints."""
        return 0.0

    def write(self, page: Page) -> None:
        """Write the rate of e_f, the forces on both bodies, powers, and the dose of wear."""
        text = page.text
        joint = self.joint
        prefix = text.prefix(joint.name)
        text.comment(f"{joint.name}: oiled pin of {joint.pin.body}")
        ends = joint.bearing, joint.pin
        place, velocity = page.chain.relative_motion(text, ends, prefix)
        axes = self._declare_film(page, prefix)
        film = text.let_vector(f"{prefix}_film", Vector(*(f"y[{i}]" for i in axes)))
        elastic = self._write_elastic(page, prefix, place.minus(film))
        pin = page.chain.of(joint.pin.body)
        bearing = page.chain.of(joint.bearing.body)
        mean = product("0.5", total(pin.omega, bearing.omega))
        mean = text.let(f"{prefix}_mean_speed", mean)
        velocity = velocity.minus(place.rotated_at(mean))
        velocity = text.let_vector(f"{prefix}_velocity", velocity)
        resistance = elastic.minus(velocity.times(f"{prefix}_damping"))
        film_velocity = self._write_film_velocity(page, prefix, film, resistance)
        rate = film_velocity.plus(film.rotated_at(mean))
        rate = text.let_vector(f"{prefix}_film_rate", rate)
        for i, component in zip(axes, rate, strict=True):
            text.write(f"out[{i}] = {component}")
        stretching = velocity.minus(film_velocity)
        stretching = text.let_vector(f"{prefix}_stretching", stretching)
        force = elastic.minus(stretching.times(f"{prefix}_damping"))
        force = text.let_vector(f"{prefix}_force", force)
        moment, friction_loss = self._write_friction(page, prefix, f"{film.dot(film)}")
        self._add_forces(page, prefix, place, force, moment)
        damped = product(f"{prefix}_damping", stretching.dot(stretching))
        loss = difference(damped, force.dot(film_velocity))
        loss = text.let(f"{prefix}_loss", loss)
        page.add_power("contact_loss", loss)
        page.add_power("friction_loss", friction_loss)
        with text.block("if level == END:"):
            losses = total(loss, friction_loss)
            self._write_record(page, prefix, (film, rate, force), losses)

    def _write_film_velocity(
        self, page: Page, prefix: str, film: Vector, resistance: Vector
    ) -> Vector:
        """Write e_f' in the turning frame; ``resistance`` is the force at e_f' = 0."""
        text = page.text
        clearance = text.parameter(f"{prefix}_clearance", self.joint.clearance)
        chord = f"chord_of({prefix}_stretch, {clearance})"
        arguments = (
            f"({film.x}, {film.y})",
            f"({resistance.x}, {resistance.y})",
            f"({chord}, {prefix}_damping, {prefix}_relaxation)",
            self._bearing(page, prefix),
        )
        call = f"film_velocity_of({', '.join(arguments)})"
        velocity = Vector(f"{prefix}_film_velocity_x", f"{prefix}_film_velocity_y")
        text.write(f"{velocity.x}, {velocity.y}, {prefix}_rough = {call}")
        return velocity

    def _declare_film(self, page: Page, prefix: str) -> list[int]:
        """Declare the place on the film; return the places of its coordinates in ``y``."""
        places = []
        for i, axis in enumerate("xy"):
            state = State(
                name=f"{prefix}_film_{axis}",
                scale=SCALE * self.joint.clearance,
                at_start=partial(start_on_film, page.chain.linkage, self.joint, i),
            )
            places.append(page.add_state(state))
        return places

    def _write_elastic(self, page: Page, prefix: str, stretch: Vector) -> Vector:
        """Write damping and elastic force on the pin, against the stretch of the contact."""
        text = page.text
        oil = self.joint.oil
        assert oil is not None
        stretch = text.let_vector(f"{prefix}_stretch", stretch)
        size = text.let(f"{prefix}_stretch", f"math.sqrt({stretch.dot(stretch)})")
        law = f"elastic_of(data.joints[{self.number}].normal, {size})"
        text.write(f"{prefix}_elastic, {prefix}_energy = {law}")
        mass = float(self.record["effective_mass"])
        # Between two prescribed bodies nothing oscillates.
        mass_text = text.parameter(
            f"{prefix}_mass", mass if math.isfinite(mass) else 0.0
        )
        ratio = text.parameter(f"{prefix}_damping_ratio", oil.damping_ratio)
        sizes = f"{prefix}_elastic, {prefix}_energy, {mass_text}, {ratio}"
        call = f"contact_damping({sizes})"
        text.write(f"{prefix}_damping, {prefix}_relaxation = {call}")
        quotient = f"{prefix}_elastic / {size} if {size} > {ZERO} else {ZERO}"
        factor = text.let(f"{prefix}_factor", quotient)
        return text.let_vector(f"{prefix}_pull", stretch.times(f"-{factor}"))

    def _add_forces(
        self, page: Page, prefix: str, place: Vector, force: Vector, moment: str
    ) -> None:
        """Add force and moment to those on both bodies, the force at the middle of e."""
        text = page.text
        joint = self.joint
        pin = page.chain.of(joint.pin.body)
        bearing = page.chain.of(joint.bearing.body)
        couple = text.let(f"{prefix}_couple", place.cross(force))
        pin.add_force(pin.arm(text, joint.pin, prefix), force)
        arm = bearing.arm(text, joint.bearing, prefix)
        bearing.add_force(arm, force.times(f"-{ONE}"))
        half = product("0.5", couple)
        pin.moments.append(difference(moment, half))
        bearing.moments.append(negative(total(moment, half)))

    def _bearing(self, page: Page, prefix: str) -> str:
        """Return the parameters of the bearing."""
        joint = self.joint
        oil = self.joint.oil
        assert oil is not None
        film = film_of(
            joint.width / oil.films,
            joint.bearing_radius,
            joint.clearance,
            oil.viscosity,
        )
        text = page.text
        ratio = text.parameter(f"{prefix}_width_ratio", film.width_ratio)
        film_size = text.parameter(f"{prefix}_film_size", oil.films * film.size)
        clearance = text.parameter(f"{prefix}_clearance", joint.clearance)
        size = oil.asperity_pressure * joint.width * joint.bearing_radius
        asperity_size = text.parameter(f"{prefix}_asperity_size", size)
        roughness = text.parameter(f"{prefix}_roughness", oil.roughness)
        film_text = f"OilFilm({ratio}, {film_size})"
        return f"OiledBearing({film_text}, {clearance}, {asperity_size}, {roughness})"

    def _write_friction(self, page: Page, prefix: str, square: str) -> tuple[str, str]:
        """Write shear and friction of asperities.

        Returns the moment on the pin, and the power that both take.
        """
        text = page.text
        joint = self.joint
        oil = self.joint.oil
        assert oil is not None
        pin = page.chain.of(joint.pin.body)
        bearing = page.chain.of(joint.bearing.body)
        spin = text.let(f"{prefix}_spin", difference(pin.omega, bearing.omega))
        radius = text.parameter(f"{prefix}_radius", joint.bearing_radius)
        width = text.parameter(f"{prefix}_width", joint.width)
        viscosity = text.parameter(f"{prefix}_viscosity", oil.viscosity)
        clearance = text.parameter(f"{prefix}_clearance", joint.clearance)
        gap = f"max(1.0 - math.sqrt({square}) / {clearance}, {THINNEST})"
        sizes = f"({width}, {radius}, {clearance})"
        call = f"shear_moment({gap}, {spin}, {viscosity}, {sizes})"
        shear = text.let(f"{prefix}_shear", call)
        sliding = text.let(f"{prefix}_sliding", product(radius, spin))
        if joint.wear is not None:
            page.set_dose(self.number, "work", f"{prefix}_rough * abs({sliding})")
        if joint.friction.coefficient == 0.0:
            text.write(f"{prefix}_friction = {ZERO}")
            return f"-{shear}", product(shear, spin)
        law = FrictionWithoutState(
            page, prefix, joint.friction, self.record["friction"]
        )
        law.write_state(sliding, ONE)
        friction = text.let(f"{prefix}_friction", law.force(f"{prefix}_rough"))
        moment = text.let(f"{prefix}_moment", f"{radius} * {friction} - {shear}")
        return moment, difference(product(shear, spin), product(friction, sliding))

    def _write_record(
        self,
        page: Page,
        prefix: str,
        vectors: tuple[Vector, Vector, Vector],
        loss: str,
    ) -> None:
        """Write the contact for the recorder: the eccentricity is that on the rigid film.

        ``vectors`` are e_f, its rate and the force, and ``loss`` is the power that the joint
        takes, W. Asperities bear where the film is least, over the arc of the elastic contact.
        As in a dry joint, the length of the arc follows from the clearance and the
        penetration.
        """
        text = page.text
        joint = self.joint
        film, rate, force = vectors
        size = f"{prefix}_stretch"
        place = text.let(f"{prefix}_place", f"math.sqrt({film.dot(film)})")
        fields = {
            "penetration": size,
            "eccentricity": f"{prefix}_clearance + {size}",
            "eccentricity_x": film.x,
            "eccentricity_y": film.y,
            "velocity_x": rate.x,
            "velocity_y": rate.y,
            "sliding": f"{prefix}_sliding",
            "normal_x": f"{film.x} / {place} if {place} > {ZERO} else {ONE}",
            "normal_y": f"{film.y} / {place} if {place} > {ZERO} else {ZERO}",
            "elastic": f"{prefix}_elastic",
            "energy": f"{prefix}_energy",
            "normal": f"math.sqrt({force.dot(force)})",
            "tangential": f"{prefix}_friction",
            "film_loss": loss,
        }
        for end, link in (
            ("bearing", page.chain.of(joint.bearing.body)),
            ("pin", page.chain.of(joint.pin.body)),
        ):
            fields |= {f"{end}_angle": link.angle, f"{end}_spin": link.omega}
        contact = text.let(f"{prefix}_contact", f"data.contacts[{self.number}]")
        for word, value in fields.items():
            text.write(f"{contact}[{FIELDS[word]}] = {value}")
