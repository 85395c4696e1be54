"""Check of the assumption of dry contact: the oil films in joints that run dry.

The forces with all joints closed, and the speeds of the bodies, move the pin of each
joint on a film of oil, by wedge and squeeze (``physics.oil_film``), until its orbit
repeats itself. Joints whose film acts in the run are left out.
"""

import math
from contextlib import suppress
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from presswear.linkage.joints import Revolute
from presswear.linkage.oil import MAX_FILM_WIDTH, MIN_FILM_WIDTH
from presswear.linkage.points import GROUND
from presswear.physics.mixed_lubrication import shear_moment
from presswear.physics.oil_film import film_of
from presswear.results.film_orbit import (
    FilmLoad,
    FilmOrbit,
    OrbitTooStiff,
    film_power,
    periodic_orbit,
)
from presswear.results.rigid_joints import ideal_forces
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.numbers import percent, quantity_text, readable

# Clearances that bearing makers recommend with oil, per mille of the bore
OIL_CLEARANCES = 1.5, 2.5
# Per mille of the bore, with grease. In a wider bearing no film carries.
WIDEST_CLEARANCE = 2.0 * OIL_CLEARANCES[1]
FULL_FILM = 3.0  # least film without contact, over the roughness of both surfaces
ASSUMES = (
    "The film assumes a rigid bearing that is full of oil of this viscosity; with grease, or "
    "with little oil, the joint is nearer to dry contact"
)


@dataclass(frozen=True)
class JointFilm:
    """Film in a joint over a cycle of the linkage without clearance."""

    angle: Array  # angle of the cycle since its start, degrees, shape (n,)
    force: Array  # between pin and bearing, N
    orbit: FilmOrbit
    clearance: float  # m
    roughness: float  # R_q of both surfaces together, m
    # Mean power that the oil dissipates, W; in the run with that of the asperities
    loss: float = 0.0

    @property
    def thickness(self) -> Array:
        """Least thickness at each instant, m."""
        return self.clearance * self.orbit.gap

    @property
    def thinnest(self) -> int:
        """Instant of the least film in the cycle."""
        return int(self.orbit.gap.argmin())

    @property
    def time_shares(self) -> tuple[float, float, float]:
        """Shares of the time with full film, mixed lubrication and contact of asperities."""
        return self._shares(np.ones(self.angle.size))

    @property
    def load_shares(self) -> tuple[float, float, float]:
        """Shares of the integral of the force over the time in the same states."""
        return self._shares(self.force)

    @property
    def full_share(self) -> float:
        """Share of the time in which the film is full."""
        return self.time_shares[0]

    def _shares(self, weights: Array) -> tuple[float, float, float]:
        """Return the shares of the integral of a weight in the three states."""
        is_full = self.thickness > FULL_FILM * self.roughness
        is_dry = self.thickness < self.roughness
        total = float(np.trapezoid(weights, self.angle))
        if total == 0.0:
            return self.time_shares
        full = float(np.trapezoid(weights * is_full, self.angle)) / total
        dry = float(np.trapezoid(weights * is_dry, self.angle)) / total
        return full, max(1.0 - full - dry, 0.0), dry


def oil_films(scene: Scene) -> dict[str, JointFilm]:
    """Return the films over a cycle after the run-up, by joint; only films that carry.

    The result is empty if the forces need user laws that are not trusted.
    """
    return {} if scene.has_untrusted_loads else _films(scene)


# A report shows the films in sentences, in a number and in a figure.
@lru_cache(maxsize=16)
def _films(scene: Scene) -> dict[str, JointFilm]:
    films = {}
    for pin in scene.loaded.revolutes:
        if pin.name not in scene.loose_pins:
            continue
        bearing = scene.bearing(pin.name)
        if bearing.viscosity is None or bearing.has_film:
            continue
        if _relative(bearing) <= WIDEST_CLEARANCE:
            # Without a film that can be computed the contact is as good as dry.
            with suppress(OrbitTooStiff):
                films[pin.name] = _film(scene, pin, bearing)
    return films


def _film(scene: Scene, pin: Revolute, bearing: Bearing) -> JointFilm:
    """Return the film of a joint."""
    time, forces = ideal_forces(scene)
    velocity = scene.ideal.at(time).velocity
    spins = []
    for end in pin.ends:
        if end.body == GROUND:
            spins.append(np.zeros(time.size))
        else:
            spins.append(velocity[:, 3 * scene.loaded.index(end.body) + 2])
    first, second = spins
    load = FilmLoad(
        np.append(time, time[0] + scene.mechanism.period),
        # ``ideal_forces`` returns the force on the bearing. Parallel rods share it.
        _cycle(-forces[pin.name] / bearing.parallel_rods),
        _cycle(first + second),
    )
    film = film_of(
        bearing.width,
        bearing.bearing_radius,
        bearing.clearance,
        bearing.viscosity or 0.0,
    )
    orbit = periodic_orbit(load, film)
    sheared = shear_power(bearing, orbit, _cycle(second - first))
    power = sheared + bearing.clearance * film_power(load, orbit, film)
    mean = float(np.trapezoid(power, load.time)) / scene.mechanism.period
    return JointFilm(
        angle=360.0 * (load.time - load.time[0]) / scene.mechanism.period,
        force=np.abs(load.force),
        orbit=orbit,
        clearance=bearing.clearance,
        roughness=math.sqrt(2.0) * bearing.roughness,
        loss=bearing.parallel_rods * mean,
    )


def shear_power(bearing: Bearing, orbit: FilmOrbit, spin: Array) -> Array:
    """Return the power of shear in the oil of a rod, W, at relative speeds ``spin``, rad/s."""
    sizes = bearing.width, bearing.bearing_radius, bearing.clearance
    viscosity = bearing.viscosity or 0.0
    moments = []
    for gap, omega in zip(orbit.gap.tolist(), spin.tolist(), strict=True):
        moments.append(shear_moment(gap, omega, viscosity, sizes))
    return np.array(moments) * spin


def _cycle(values: Array) -> Array:
    """Return values with the first one at the end."""
    return np.append(values, values[0])


def _relative(bearing: Bearing) -> float:
    """Return the clearance in per mille of the bore."""
    return 1e3 * bearing.clearance / bearing.bearing_radius


def dry_contact(scene: Scene) -> list[str]:
    """Return a paragraph on the validity of dry contact for each clearance joint."""
    paragraphs = []
    for name in scene.loose_pins:
        bearing = scene.bearing(name)
        if bearing.has_film:
            continue  # see ``run_film.film_sentences``
        relative = readable(_relative(bearing))
        text = (
            f"Joint {name}: the relative clearance is {relative} per mille of the bore "
        )
        usual = "{} to {} with oil".format(*OIL_CLEARANCES)
        text += f"(bearing makers give {usual}, up to twice that with grease)."
        film = oil_films(scene).get(name)
        if film is None:
            paragraphs.append(f"{text} {_reason(bearing)}: the contact is dry.")
            continue
        phase = scene.mechanism.linkage().phase
        text += f" {film_text(film, bearing, phase)} {_verdict(film)} {ASSUMES}."
        paragraphs.append(text)
    return paragraphs


def _reason(bearing: Bearing) -> str:
    """Return why a joint has no film."""
    if bearing.viscosity is None:
        return "No viscosity is specified"
    if _relative(bearing) > WIDEST_CLEARANCE:
        return "It is too wide for a film"
    return (
        f"With {bearing.viscosity:g} Pa s the film under these forces is too thin to be "
        "computed"
    )


def film_text(film: JointFilm, bearing: Bearing, phase: str) -> str:
    """Return sentences on the least film, its place in the cycle, and the states."""
    least = readable(1e6 * float(film.thickness.min()))
    place = film.angle[film.thinnest]
    force = quantity_text(float(film.force[film.thinnest]), "N")
    states = "full film", "mixed lubrication", "contact of asperities"
    rows = zip(states, film.time_shares, film.load_shares, strict=True)
    shares = ", ".join(
        f"{state} for {percent(time)} of the time and {percent(load)} of the load"
        for state, time, load in rows
    )
    text = (
        f"With {bearing.viscosity:g} Pa s the least film of the cycle is {least} µm, at "
        f"{place:.0f}° ({phase} since the start) under {force}; the roughness of both "
        f"surfaces is {readable(1e6 * film.roughness)} µm: {shares}. "
    )
    loss = f"{readable(film.loss)} W on average"
    if bearing.has_film:
        text += f"Oil and asperities take {loss}."
    else:
        text += f"The oil takes {loss}, without the friction of asperities."
    if not film.orbit.is_closed:
        text += (
            f" These numbers are those {film.orbit.cycles_text}, and the film still changes "
            "from cycle to cycle."
        )
    ratio = 0.5 * bearing.width / bearing.bearing_radius
    if not MIN_FILM_WIDTH <= ratio <= MAX_FILM_WIDTH:
        text += (
            f" The width over the diameter is {readable(ratio)}; the film is that of "
            f"{film_of(bearing.width, bearing.bearing_radius, 1.0, 1.0).width_ratio:g}, the "
            "nearest for which its formulas hold."
        )
    return text


def _verdict(film: JointFilm) -> str:
    """Return a sentence on what the film means for impacts and wear of dry contact."""
    full, mixed, dry = film.time_shares
    if full == 1.0:
        return (
            "Oil keeps pin and bearing apart in the whole cycle, so that impacts and wear of dry "
            "contact are far above those of this joint."
        )
    if dry == 0.0:
        return (
            f"The surfaces touch at their highest asperities for {percent(mixed)} of the time, so "
            "that impacts and wear of dry contact are upper bounds."
        )
    load = film.load_shares[2]
    if load < 0.5:
        return (
            f"The film is thinner than the roughness under {percent(load)} of the load, so that "
            "impacts and wear of dry contact are upper bounds."
        )
    return (
        f"The film is thinner than the roughness under {percent(load)} of the load: the oil "
        "separates too little, and dry contact is the nearer model."
    )
