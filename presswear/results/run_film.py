"""Oil film of the joints in which it acts in the run, from recorded series."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import GROUND, Revolute
from presswear.physics.oil_film import OilFilm, film_force, film_of
from presswear.results.film_orbit import FilmOrbit
from presswear.results.oil_film import (
    ASSUMES,
    JointFilm,
    film_text,
    shear_power,
)
from presswear.results.stage import StageResult
from presswear.scene.bearing import Bearing
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import NotStored
from presswear.tools.numbers import percent

_ROUND_OFF = 1e-9  # of a cycle, by which the series ends earlier than the cycle


def run_films(scene: Scene, stage: StageResult) -> dict[str, JointFilm]:
    """Return the films in the last recorded cycle of a stage, of joints with a film in the run.

    Empty if no cycle, or no series of the joints, was stored.
    """
    names = [name for name in scene.clearance_joints if scene.bearing(name).has_film]
    if not names or "time" not in stage.arrays:
        return {}
    rows = _last_cycle(scene, stage.time)
    if rows.size == 0:
        return {}
    pins = [pin for pin in scene.loaded.revolutes if pin.name in names]
    try:
        return {pin.name: _film(scene, stage, pin, rows) for pin in pins}
    except NotStored:
        return {}


def _last_cycle(scene: Scene, time: Array) -> NDArray[np.int64]:
    """Return the rows of the last whole cycle in a series, shape (n,)."""
    cycles = (time - scene.run_up) / scene.mechanism.period
    last = math.floor(cycles[-1] + _ROUND_OFF)
    if last < 1:
        return np.empty(0, np.int64)
    is_within = (cycles > last - 1 - _ROUND_OFF) & (cycles < last + _ROUND_OFF)
    return np.flatnonzero(is_within)


def _film(
    scene: Scene, stage: StageResult, pin: Revolute, rows: NDArray[np.int64]
) -> JointFilm:
    """Return the film of a joint; an event stores two rows at one instant."""
    joint, bearing = stage.joints[pin.name], scene.bearing(pin.name)
    rows = rows[np.append(True, np.diff(stage.time[rows]) > 0.0)]
    time, clock = stage.time[rows], stage.clock[rows]
    place = joint.eccentricity[rows] @ np.array([1.0, 1.0j]) / bearing.clearance
    orbit = FilmOrbit(1.0 - np.abs(place), place, is_closed=True)
    speeds = stage.nominal_rate[rows] * _speed_sum(scene, pin, time)
    power = _power(bearing, orbit, clock, speeds)
    power += shear_power(bearing, orbit, joint.sliding[rows] / bearing.bearing_radius)
    mean = float(np.trapezoid(power, clock) / (clock[-1] - clock[0]))
    return JointFilm(
        360.0 * (time - time[0]) / scene.mechanism.period,
        joint.series("normal")[rows],
        orbit,
        bearing.clearance,
        math.sqrt(2.0) * bearing.roughness,
        bearing.parallel_rods * mean,
    )


def _speed_sum(scene: Scene, pin: Revolute, time: Array) -> Array:
    """Return the speeds of pin and bearing in the linkage without clearance, rad/s, shape (n,)."""
    linkage, velocity = scene.loaded, scene.ideal.at(time).velocity
    speeds = [
        velocity[:, 3 * linkage.index(end.body) + 2]
        for end in pin.ends
        if end.body != GROUND
    ]
    return np.sum(speeds, axis=0)


def _power(bearing: Bearing, orbit: FilmOrbit, time: Array, speeds: Array) -> Array:
    """Return the power that wedge and squeeze take in one of parallel rods, W.

    ``speeds`` are those of pin and bearing together, rad/s.
    """
    size, rate = np.abs(orbit.place), np.gradient(orbit.place, time)
    direction = np.divide(
        orbit.place, size, out=np.ones_like(orbit.place), where=size > 0.0
    )
    on_film = rate * direction.conj()
    turning = np.divide(on_film.imag, size, out=np.zeros(time.size), where=size > 0.0)
    film = _film_of(bearing)
    power = np.zeros(time.size)
    rows = zip(orbit.gap, on_film.real, speeds - 2.0 * turning, strict=True)
    for i, (gap, closing, speed) in enumerate(rows):
        along, across = film_force(float(gap), float(closing), float(speed), film)
        power[i] = 0.5 * across * (1.0 - gap) * speed - along * closing
    return bearing.clearance * power


def _film_of(bearing: Bearing) -> OilFilm:
    return film_of(
        bearing.width,
        bearing.bearing_radius,
        bearing.clearance,
        bearing.viscosity or 0.0,
    )


def film_sentences(scene: Scene, stage: StageResult) -> list[str]:
    """Return a paragraph for each joint whose film acts in the run."""
    phase = scene.mechanism.linkage().phase
    return [
        f"Joint {name}: the oil film acts in the run. "
        f"{film_text(film, scene.bearing(name), phase)} {_verdict(film)} {ASSUMES}."
        for name, film in run_films(scene, stage).items()
    ]


def _verdict(film: JointFilm) -> str:
    """Return a sentence on the wear of asperities."""
    full, mixed, dry = film.time_shares
    if full == 1.0:
        return (
            "Oil keeps pin and bearing apart in the whole cycle. Hardly any asperity "
            "touches."
        )
    touching = percent(mixed + dry)
    return (
        f"Asperities touch for {touching} of the time. The wear of this run is theirs."
    )
