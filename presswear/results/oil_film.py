"""Oil film in the joints: does the assumption of dry contact hold?

No film is simulated. The force of each joint with all joints closed, and the turning of
its bodies, give the film of a finite journal bearing in steady rotation over the cycle
(Butenschoen, Das hydrodynamische, zylindrische Gleitlager endlicher Breite unter
instationaerer Belastung, 1976). Oil that is squeezed out carries as well and is left
out: the film is a lower bound.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from presswear.linkage.elements import GROUND
from presswear.results.press_analysis import ideal_forces
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.numbers import readable

OIL_CLEARANCES = 1.5, 2.5  # per mille of the bore, by bearing makers, with oil
WIDEST = 2.0 * OIL_CLEARANCES[1]  # with grease; no film carries in a wider clearance
FULL_FILM = 3.0  # film over the roughness of both surfaces from which they do not touch
USUAL_WIDTHS = 0.125, 1.0  # widths over diameters for which the closed form holds
STEADY = "Steady rotation, no squeeze: a lower bound of the film"
_LEAST_GAP = 1e-12  # of the clearance; a smaller film is none
_HALVINGS = 60


@dataclass(frozen=True)
class OilFilm:
    """Film in a joint over a cycle of the linkage without clearance."""

    time: Array  # s, shape (n,)
    force: Array  # between pin and bearing, N
    speed: Array  # effective angular speed, rad/s
    thickness: Array  # least, m
    roughness: float  # R_q of both surfaces together, m

    @property
    def full_share(self) -> float:
        """Share of the time in which the film is full."""
        weights = np.gradient(self.time)  # the instants are not evenly spaced
        return float(
            weights @ (self.thickness > FULL_FILM * self.roughness) / weights.sum()
        )


def sommerfeld(eccentricity: Array, ratio: float) -> Array:
    """Return the Sommerfeld number F psi^2 / (B d eta omega) of a finite bearing in rotation.

    Parameters
    ----------
    eccentricity : ndarray
        Over the clearance, 0 to 1.
    ratio : float
        Width over diameter. The fit lies within 7 % of tables for 1/8 to 1.
    """
    e, b = eccentricity, ratio
    a1 = 1.1642 + b * (-1.9456 + b * (7.1161 + b * (-10.1073 + b * 5.0141)))
    a2 = -1.000026 - b * (0.023634 + b * (0.4215 + b * (0.038817 + b * 0.090551)))
    rest = 1.0 - e * e
    root = np.sqrt(math.pi**2 * rest + 16.0 * e * e)
    return np.asarray(
        b * b * e / (2.0 * rest * rest) * root * a1 * (e - 1.0) / (a2 + e)
    )


def thickness(bearing: Bearing, force: Array, speed: Array) -> Array:
    """Return the least thickness of the film, m, for forces, N, and speeds, rad/s.

    ``speed`` is |w1 + w2 - 2 gamma'| with the rates of pin, bearing and direction of
    the force.
    """
    diameter, clearance = 2.0 * bearing.bearing_radius, bearing.clearance
    ratio = min(max(bearing.width / diameter, USUAL_WIDTHS[0]), USUAL_WIDTHS[1])
    psi = clearance / bearing.bearing_radius
    # So is proportional to 1 / speed, which may be zero: the products are compared.
    carried = bearing.width * diameter * (bearing.viscosity or 0.0) * speed / psi**2
    low, high = np.full(force.shape, math.log(_LEAST_GAP)), np.zeros(force.shape)
    for _ in range(_HALVINGS):
        gap = 0.5 * (low + high)
        is_carried = carried * sommerfeld(-np.expm1(gap), ratio) >= force
        low, high = np.where(is_carried, gap, low), np.where(is_carried, high, gap)
    return np.asarray(
        clearance * np.where(high <= math.log(2.0 * _LEAST_GAP), 0.0, np.exp(high))
    )


def oil_films(scene: Scene) -> dict[str, OilFilm]:
    """Return the films over a cycle after the run-up, of clearance joints in which one carries.

    None if the forces need user laws that are not trusted.
    """
    return {} if scene.has_untrusted_loads else _films(scene)


@lru_cache(
    maxsize=16
)  # a report has the films in sentences, in a number and in a figure
def _films(scene: Scene) -> dict[str, OilFilm]:
    bearings = {name: scene.bearing(name) for name in scene.clearance_joints}
    oiled = {
        name: one
        for name, one in bearings.items()
        if one.viscosity is not None and _relative(one) <= WIDEST
    }
    if not oiled:
        return {}
    linkage, (time, forces) = scene.loaded, ideal_forces(scene)
    velocity, films = scene.ideal.at(time).velocity, {}
    for pin in linkage.revolutes:
        if pin.name not in oiled:
            continue
        bearing, force = oiled[pin.name], forces[pin.name]
        first, second = (
            0.0 if end.body == GROUND else velocity[:, 3 * linkage.index(end.body) + 2]
            for end in (pin.first, pin.second)
        )
        turning = first + second - 2.0 * np.gradient(np.unwrap(np.angle(force)), time)
        size, speed = np.abs(force), np.abs(turning)
        film, roughness = (
            thickness(bearing, size, speed),
            math.sqrt(2.0) * bearing.roughness,
        )
        films[pin.name] = OilFilm(time, size, speed, film, roughness)
    return films


def _relative(bearing: Bearing) -> float:
    """Return the clearance in per mille of the bore."""
    return 1e3 * bearing.clearance / bearing.bearing_radius


def dry_contact(scene: Scene) -> list[str]:
    """Return a sentence for each clearance joint: does the model of dry contact hold there?"""
    sentences = []
    for name in scene.clearance_joints:
        bearing = scene.bearing(name)
        relative = readable(_relative(bearing))
        text = (
            f"Joint {name}: the relative clearance is {relative} per mille of the bore "
        )
        usual = "{} to {} with oil, up to twice that with grease".format(
            *OIL_CLEARANCES
        )
        text += f"(bearing makers give {usual})."
        film = oil_films(scene).get(name)
        if film is None:
            is_wide = bearing.viscosity is not None
            reason = (
                "It is too wide for a film" if is_wide else "No viscosity is specified"
            )
            sentences.append(f"{text} {reason}: the contact is dry.")
            continue
        thick, loaded = film.thickness, int(film.force.argmax())
        median, at_force, least = (
            readable(1e6 * float(value))
            for value in (np.median(thick), thick[loaded], thick.min())
        )
        full = readable(100.0 * film.full_share)
        text += (
            f" With {bearing.viscosity:g} Pa s the film is at least {median} µm thick (median of "
            f"the cycle), {at_force} µm at the greatest force and {least} µm at its thinnest, "
            f"beside a roughness of {readable(1e6 * film.roughness)} µm: a full film for at least "
            f"{full} % of the cycle. {STEADY}."
        )
        if film.full_share < 1.0:
            text += (
                " Short work squeezes the oil, which can carry where this film is thin."
            )
        text += " Impacts and wear of dry contact are upper bounds."
        sentences.append(text)
    return sentences
