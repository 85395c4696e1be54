"""Oil film of the joints in which it acts in the run, from recorded series."""

import math

import numpy as np
from numpy.typing import NDArray

from presswear.results.film_orbit import FilmOrbit
from presswear.results.motor_load import period_in
from presswear.results.oil_film import (
    ASSUMES,
    JointFilm,
    film_text,
)
from presswear.results.stage import StageResult
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.errors import NotStored
from presswear.tools.numbers import percent

_ROUND_OFF = 1e-9  # part of a cycle by which the series may end before the cycle


def run_films(scene: Scene, stage: StageResult) -> dict[str, JointFilm]:
    """Return the films in the last recorded cycle of a stage, of joints with a film in the run.

    The loss is the mean over the sampled cycles. Empty if no cycle, or no series of the
    joints, was stored.
    """
    joints = stage.statistics.joints.items()
    names = [name for name, joint in joints if joint.has_film]
    if not names or "time" not in stage.arrays:
        return {}
    rows = _last_cycle(scene, stage.time)
    if rows.size == 0:
        return {}
    try:
        return {name: _film(scene, stage, name, rows) for name in names}
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
    scene: Scene, stage: StageResult, name: str, rows: NDArray[np.int64]
) -> JointFilm:
    """Return the film of a joint in some rows of the series."""
    joint = stage.joints[name]
    bearing = scene.bearing(name)
    # An event stores two rows at one instant, of which the first is used.
    is_later = np.diff(stage.time[rows]) > 0.0
    rows = rows[np.append(True, is_later)]
    time = stage.time[rows]
    x, y = joint.eccentricity[rows].T
    place = (x + 1j * y) / bearing.clearance
    loss = joint.statistics.means["film_loss"].mean
    return JointFilm(
        angle=360.0 * (time - time[0]) / scene.mechanism.period,
        force=joint.series("normal")[rows],
        orbit=FilmOrbit(1.0 - np.abs(place), place, is_closed=True),
        clearance=bearing.clearance,
        roughness=math.sqrt(2.0) * bearing.roughness,
        loss=loss / period_in(scene, stage),
    )


def film_sentences(scene: Scene, stage: StageResult) -> list[str]:
    """Return a paragraph for each joint whose film acts in the run."""
    phase = scene.mechanism.linkage().phase
    paragraphs = []
    for name, film in run_films(scene, stage).items():
        full, mixed, dry = film.time_shares
        verdict = (
            f"Asperities touch for {percent(mixed + dry)} of the time. "
            "The wear of this run is theirs."
        )
        if full == 1.0:
            verdict = (
                "Oil keeps pin and bearing apart in the whole cycle. Hardly any "
                "asperity touches."
            )
        text = film_text(film, scene.bearing(name), phase)
        paragraphs.append(
            f"Joint {name}: the oil film acts in the run. {text} {verdict} {ASSUMES}."
        )
    return paragraphs
