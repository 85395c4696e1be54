"""Figure of the oil films: thickness over the phase of the cycle, and the orbit of the pin."""

import math

import numpy as np
from matplotlib.ticker import MultipleLocator

from presswear.results.oil_film import FULL_FILM, JointFilm, oil_films
from presswear.results.result import Result
from presswear.results.run_film import run_films
from presswear.show.figures import style
from presswear.show.figures.motion import ROUND_GAP
from presswear.show.figures.style import Axes, Drawing, Pen, ShownStage, Stages
from presswear.show.figures.window import sampled
from presswear.tools.numbers import readable

# Relative widths of the panels: film over the cycle, film in the working zone, orbit
_CYCLE_WIDTH = 3.0
_ZONE_WIDTH = 2.0
_ORBIT_WIDTH = 2.0
_FILM = Pen("oil film", style.LINES[0][0])
_FULL = Pen("full film above", style.LINES[2][0], (0.0, (5.0, 2.0)))
_ROUGHNESS = Pen("roughness of both surfaces", style.LINES[1][0], "dotted")


def film_thickness(result: Result, stages: Stages) -> list[Drawing]:
    """Draw the oil film of each joint with a viscosity over the phase of the cycle, and its orbit.

    The orbit is that of the centre of the pin in the circle of the clearance. With work
    the working zone stands between both.
    """
    scene = result.scene
    in_run = run_films(scene, stages[-1]) if stages else {}
    films = {**oil_films(scene), **in_run}
    if not films:
        return []
    height = min(0.6 + 2.2 * len(films), style.TALLEST)
    zone = _working_zone(result, stages)
    widths = [_CYCLE_WIDTH, _ORBIT_WIDTH]
    if zone:
        widths.insert(1, _ZONE_WIDTH)
    sheet, grid = style.panels(len(films), len(widths), height, width_ratios=widths)
    phase = scene.mechanism.linkage().phase
    for panels, (name, film) in zip(grid, films.items(), strict=True):
        over_cycle, *in_zone, orbit = panels
        _draw_film(over_cycle, film, 1)
        share = f"{100.0 * film.full_share:.3g} % of the cycle"
        title = f"joint {name}: full film for\n{share}"
        over_cycle.set_title(title)
        over_cycle.set_ylabel("film (µm)")
        over_cycle.set_xlim(0.0, 360.0)
        over_cycle.xaxis.set_major_locator(MultipleLocator(90.0))
        if zone:
            over_cycle.axvspan(*zone, color=style.MUTED, alpha=0.12, linewidth=0.0)
            (axes,) = in_zone
            _draw_film(axes, film, 2)  # the zone may reach into the next cycle
            axes.set_xlim(*zone)
            axes.set_title("working zone\n(grey at the left)", fontweight="normal")
            axes.set_xlabel(f"{phase} (degrees)")
        _draw_orbit(orbit, film)
    grid[-1, 0].set_xlabel(f"{phase} since the start (degrees)")
    grid[-1, -1].set_xlabel("x over the clearance")
    pens = [_FILM, _FULL, _ROUGHNESS]
    return style.finished(
        "oil", sheet, pens, full=FULL_FILM, in_run=", ".join(in_run), zone=zone
    )


def _working_zone(result: Result, stages: Stages) -> tuple[float, float] | None:
    """Return the working zone of the last stage as degrees of the cycle; None without work."""
    if not stages or stages[-1].failed or stages[-1].time.size < 2:
        return None
    _, window = sampled(result, [ShownStage(stages[-1], _FILM)])
    if window.zone is None:
        return None
    start, end = (window.degrees(time) for time in window.zone)
    turn = 360.0 * math.floor(start / 360.0)
    return start - turn, end - turn


def _draw_film(axes: Axes, film: JointFilm, cycles: int) -> None:
    """Draw the least thickness of a film over some cycles, which are equal."""
    angle = np.add.outer(360.0 * np.arange(cycles), film.angle).ravel()
    _FILM.draw(axes, angle, np.tile(film.thickness * style.MICRONS, cycles))
    for pen, factor in ((_FULL, FULL_FILM), (_ROUGHNESS, 1.0)):
        axes.axhline(factor * film.roughness * style.MICRONS, **pen.line_style)
    axes.set_yscale("log")


def _draw_orbit(axes: Axes, film: JointFilm) -> None:
    """Draw the orbit of a pin in the circle of the clearance, with the place of the least film."""
    place = film.orbit.place
    least = film.thinnest
    turn = np.linspace(0.0, 2.0 * math.pi, 181)
    axes.plot(np.cos(turn), np.sin(turn), **ROUND_GAP.line_style)
    _FILM.draw(axes, place.real, place.imag)
    axes.plot(place.real[least], place.imag[least], "o", color=_FULL.colour, ms=4.0)
    thin = readable(style.MICRONS * float(film.thickness[least]))
    title = f"least {thin} µm at {film.angle[least]:.0f}°"
    axes.set_title(title, fontweight="normal")
    axes.set_aspect("equal")
    axes.set_ylabel("y over the clearance")
