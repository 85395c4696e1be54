"""Presses of ``presswear new`` compared with closed forms and d'Alembert's principle.

Expected values do not use the program. Positions are intersections of circles, as
complex numbers, m. Speeds and accelerations are their central differences over the
crank angle. Torques follow from the energy, and joint forces from the equilibrium of the
last link and the slide.
"""

import cmath
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from marks import slow

import presswear as pw
from presswear.results.rigid_joints import ideal_drives, ideal_forces, static_torques
from presswear.scene.files import example_file, scene_from
from presswear.show.key_numbers import key_numbers
from presswear.show.report import first_screen
from presswear.tools.arrays import Array
from presswear.tools.errors import NARROW

G = 9.81
STEP = 2.0 * math.pi / 2**17  # rad, of central differences
TURN = STEP * np.arange(2**17)


class Bar(NamedTuple):
    """Body of an even bar, or a plate: both ends and the inertia about its mass centre."""

    mass: float
    inertia: float
    tail: Any
    head: Any
    centre: Any


def bar(mass: float, tail: Any, head: Any) -> Bar:
    inertia = mass * np.abs(head - tail)[0] ** 2 / 12.0
    return Bar(mass, inertia, tail, head, 0.5 * (tail + head))


def meeting(p: Any, q: Any, from_p: float, from_q: float, side: float) -> Any:
    """Return the places at two distances from p and q, on the left (1) or right (-1)."""
    length = np.abs(q - p)
    along = (length**2 + from_p**2 - from_q**2) / (2.0 * length)
    return p + (along + 1j * side * np.sqrt(from_p**2 - along**2)) * (q - p) / length


def below(top: Any, length: float) -> Any:
    """Return the places on the line x = 0 that are a length below others."""
    return 1j * (top.imag - np.sqrt(length**2 - top.real**2))


def eccentric_press(tip: Any) -> dict[str, Bar]:
    a = 0.15 * tip
    return {"crank": bar(900.0, 0.0 * a, a), "last": bar(1200.0, a, below(a, 0.9))}


def knuckle_press(tip: Any) -> dict[str, Bar]:
    o = complex(-0.73, -0.7375) + 0.0 * tip
    a = o + 0.1875 * tip
    c = meeting(0.0 * tip, a, 0.83, 0.92, side=1.0)
    return {
        "crank": bar(800.0, o, a),
        "rod": bar(900.0, a, c),
        "upper": bar(800.0, 0.0 * a, c),
        "last": bar(800.0, c, below(c, 0.83)),
    }


def link_drive(tip: Any) -> dict[str, Bar]:
    a = 0.26 * tip
    p = complex(-1.175, -0.375) + 0.0 * tip
    b = meeting(a, p, 0.8, 0.9, side=-1.0)
    c = a + (b - a) * cmath.rect(1.175 / 0.8, math.radians(134.0))
    # Inertia of a triangle: m / 36 times the sum of its squared sides
    squares = np.abs(a - b) ** 2 + np.abs(b - c) ** 2 + np.abs(c - a) ** 2
    inertia = 4000.0 * squares[0] / 36.0
    return {
        "crank": bar(2000.0, 0.0 * a, a),
        "plate": Bar(4000.0, inertia, a, b, (a + b + c) / 3.0),
        "rocker": bar(1000.0, p, b),
        "last": bar(2000.0, c, below(c, 1.175)),
    }


Places = Callable[[Any], Mapping[str, Bar]]
# links, mass of the slide, strokes a minute, pins of the last link, force of the work
CASES: dict[str, tuple[Places, float, float, str, float]] = {
    "eccentric-press": (eccentric_press, 6000.0, 30.0, "AB", 6.3e6),
    "knuckle-press": (knuckle_press, 5000.0, 30.0, "CD", 6.3e6),
    "link-drive": (link_drive, 20000.0, 25.0, "CD", 25e6),
}


def energy_of(bars: Mapping[str, Bar], mass: float, speed: float) -> Any:
    """Return kinetic energy and potential energy of weight of links and slide over a turn, J."""
    slide = bars["last"].head.imag
    energy = 0.5 * mass * rate(slide, speed) ** 2 + mass * G * slide
    for link in bars.values():
        velocity = rate(link.centre, speed)
        axis = link.head - link.tail
        omega = (rate(axis, speed) / axis).imag
        energy += 0.5 * link.mass * np.abs(velocity) ** 2
        energy += 0.5 * link.inertia * omega**2
        energy += link.mass * G * link.centre.imag
    return energy


def scene_of(kind: str, folder: Path) -> pw.Scene:
    file = folder / f"{kind}.toml"
    file.write_text(example_file(kind))
    return scene_from(file)


def rate(values: Any, speed: float) -> Any:
    """Return the rate over time of values over a turn of the crank."""
    return speed * (np.roll(values, -1) - np.roll(values, 1)) / (2.0 * STEP)


def work_on_the_way_down(scene: pw.Scene, height: Array, force: float) -> Array:
    """Return the force of blanking: up over the rise, constant, and down over the snap."""
    work: Any = scene.process
    broken = work.rise + work.plateau * work.thickness
    depths = (0.0, work.rise, broken, broken + work.snap)
    result = np.interp(work.height - height, depths, (0.0, force, force, 0.0))
    return np.where(rate(height, 1.0) < 0.0, result, 0.0)


@pytest.mark.parametrize("kind", CASES)
def test_stroke_and_torques_of_a_new_press(kind, tmp_path):
    places, mass, strokes, pins, size = CASES[kind]
    scene = scene_of(kind, tmp_path)
    speed = strokes * math.pi / 30.0
    bars = places(np.exp(1j * TURN))
    slide = bars["last"].head.imag
    bottom = slide.min()
    assert scene.bottom == pytest.approx(bottom, abs=2e-8)
    assert scene.stroke == pytest.approx(slide.max() - bottom, abs=4e-8)
    assert 60.0 / scene.mechanism.period == pytest.approx(strokes, rel=1e-12)

    force = work_on_the_way_down(scene, slide - bottom, size)
    (static,) = static_torques(scene).values()
    assert static == pytest.approx(static_torque_of(kind, scene), rel=2e-4)
    torque = rate(energy_of(bars, mass, speed), 1.0) - force * rate(slide, 1.0)
    (drive,) = ideal_drives(scene).values()
    assert abs(drive.torque.peak) == pytest.approx(np.abs(torque).max(), rel=1e-3)

    # The inertia of all bodies matters in a fast press without work.
    fast = pw.changed(scene, {"process": "none", "speed": 20.0 * speed})
    torque = rate(energy_of(bars, mass, 20.0 * speed), 1.0)
    (drive,) = ideal_drives(fast).values()
    assert abs(drive.torque.peak) == pytest.approx(np.abs(torque).max(), rel=1e-3)

    # Force of the slide on the link, upwards
    push = force - mass * (G + rate(rate(slide, speed), speed))
    upper, lower = forces_on(bars["last"], push, speed)
    _, forces = ideal_forces(scene)
    for pin, expected in zip(pins, (upper, lower), strict=True):
        peak = float(np.abs(forces[pin]).max())
        assert peak == pytest.approx(np.abs(expected).max(), rel=1e-3)


def forces_on(link: Bar, push: Array, speed: float) -> tuple[Any, Any]:
    """Return the forces at the upper and the lower pin of the last link, N.

    ``push`` is the vertical force at the lower pin. The horizontal force there follows
    from the moments about the upper pin.
    """
    acceleration = rate(rate(link.centre, speed), speed) + 1j * G
    axis = link.head - link.tail
    alpha = rate((rate(axis, speed) / axis).imag, speed)
    to_centre = link.centre - link.tail
    moment = (to_centre.conjugate() * link.mass * acceleration).imag
    moment += link.inertia * alpha
    lower = (axis.real * push - moment) / axis.imag + 1j * push
    return link.mass * acceleration - lower, lower


def test_static_torque_of_the_eccentric_press_of_630_t(tmp_path):
    """13 mm above the bottom at 22.2824 degrees, where 6,300 kN need 413,688.18 N m."""
    scene = scene_of("eccentric-press", tmp_path)
    time = np.array([scene.mechanism.period * (360.0 - 22.2824) / 360.0])
    height = scene.ideal.at(time).output(scene.base_linkage)[0, 0]
    assert 1e3 * (height - scene.bottom) == pytest.approx(13.0, abs=1e-4)
    assert static_torques(scene)["crank"] == pytest.approx(413_688.18, abs=0.01)


def test_height_and_force_of_the_cylinder_press(tmp_path):
    """Cycloidal rises of the piston, d'Alembert's principle, and the force of the work."""
    scene = scene_of("cylinder-press", tmp_path)
    turn = np.linspace(0.0, 2.0 * math.pi, 3601)
    extension = np.zeros_like(turn)
    acceleration = np.zeros_like(turn)  # of the slide, upwards
    speed = 20.0 * math.pi / 30.0
    for start, end, way in ((0.0, 100.0, 0.17), (100.0, 210.0, 0.03), (225, 360, -0.2)):
        length = math.radians(end - start)
        x = np.clip((turn - math.radians(start)) / length, 0.0, 1.0)
        extension += way * (x - np.sin(2.0 * math.pi * x) / (2.0 * math.pi))
        curvature = 2.0 * math.pi * np.sin(2.0 * math.pi * x)
        acceleration -= way * curvature * (speed / length) ** 2
    assert scene.mechanism.period == pytest.approx(3.0, rel=1e-12)
    motion = scene.ideal_slider(turn / speed)
    assert np.allclose(motion[:, 0], -extension, atol=1e-12, rtol=0.0)
    assert np.allclose(motion[:, 2], acceleration, atol=1e-9, rtol=0.0)
    # The pin of the piston in the slide begins 400 mm above the origin.
    assert scene.bottom == pytest.approx(0.2, abs=1e-9)
    assert scene.stroke == pytest.approx(0.2, abs=1e-9)

    assert static_torques(scene)["piston"] == pytest.approx(1.5e6, rel=1e-6)
    moved = 400.0 + 2500.0  # kg, piston and slide
    (drive,) = ideal_drives(pw.changed(scene, {"process": "none"})).values()
    force = np.abs(moved * (G + acceleration)).max()
    assert abs(drive.torque.peak) == pytest.approx(force, rel=1e-5)


def static_torque_of(kind: str, scene: pw.Scene) -> float:
    """Return the greatest force of the work times the sinking of the slide, N m."""
    places, *_, size = CASES[kind]
    slide = places(np.exp(1j * TURN))["last"].head.imag
    force = work_on_the_way_down(scene, slide - slide.min(), size)
    return float(np.abs(force * rate(slide, 1.0)).max())


@pytest.mark.parametrize(
    "kind",
    [
        "eccentric-press",
        slow("knuckle-press"),
        slow("link-drive"),
    ],
)
def test_page_one_of_a_new_press(kind, tmp_path):
    *_, strokes, _, size = CASES[kind]
    scene = scene_of(kind, tmp_path)
    shorter = {"wear_updates": 0, "cycles": 3, "replicates": 1}
    result = pw.run(pw.changed(scene, shorter))
    numbers = {number.name: number for number in key_numbers(result)}
    assert float(numbers["Strokes a minute"].value) == strokes
    stroke = {"eccentric-press": "300 mm", "knuckle-press": "182 mm"}
    assert numbers["Stroke"].value == stroke.get(kind, "1.00 m")
    work: Any = scene.process
    energy = size * (0.5 * work.rise + work.plateau * work.thickness + 0.5 * work.snap)
    tonnage: Any = result.tonnage(0)
    assert tonnage.peak_force.mean == pytest.approx(size, rel=1e-6)
    assert tonnage.work.mean == pytest.approx(energy, rel=2e-3)
    assert numbers["Working force"].value.startswith(f"{size / 1e6:.0f}")
    compared = dict(numbers["Peak drive torque"].compared)
    torque = compared["the work alone, static"].replace(NARROW, "")
    assert torque.endswith(" kN m")
    expected = static_torque_of(kind, scene)
    assert 1e3 * float(torque.split()[0]) == pytest.approx(expected, rel=5e-3)


def test_page_one_of_the_cylinder_press(tmp_path):
    """The work takes 1,500 kN (0.25 + 2.5 + 0.25) mm; the drive gives a force."""
    scene = scene_of("cylinder-press", tmp_path)
    shorter = {"wear_updates": 0, "cycles": 3, "replicates": 1}
    result = pw.run(pw.changed(scene, shorter))
    tonnage: Any = result.tonnage(0)
    assert tonnage.work.mean == pytest.approx(4500.0, rel=2e-3)
    screen = first_screen(result)
    numbers = {number.name: number for number in screen.key_numbers}
    assert numbers["Stroke"].value == "200 mm"
    compared = dict(numbers["Peak drive force"].compared)
    assert compared["the work alone, static"] == f"1{NARROW}500 kN"
    assert not any("repeats others" in line for line in screen.warnings)
