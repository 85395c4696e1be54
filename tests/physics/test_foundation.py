"""The elastic foundation: quadrature, its potential, convergence over the angles."""

import itertools
import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import brentq, minimize_scalar
from two_bodies import JOINT, Pair, contacts_in, placed
from worn_depths import TURN, depths, periodic

from presswear.linkage.surface import Surface, bin_centres
from presswear.linkage.wear_law import WearLaw
from presswear.physics.contact import CONTACT
from presswear.physics.foundation import (
    greatest_overlap,
    integrate_overlap,
)
from presswear.physics.overlap import place_of
from presswear.physics.packed import pack
from presswear.tools.arrays import Array

C = 8e-4
BINS = 360


def rough(seed: int, bins: int = BINS) -> Surface:
    """A map without any smoothness from bin to bin, up to 20 um deep."""
    return Surface(2e-5 * np.random.default_rng(seed).random(bins))


def groove(width: float, depth: float, bins: int = BINS, at: float = 1.5) -> Surface:
    """A smooth groove."""
    return Surface(depth * np.exp(-(((bin_centres(bins) - at) / width) ** 2)))


class Arc(NamedTuple):
    """Greatest overlap of a pin and its integrals, along the eccentricity and across it."""

    overlap: float
    place: float
    along: float
    across: float
    pin_slope: float
    square: float


def arc_of(
    bearing: Surface,
    pin: Surface,
    eccentricity: float,
    at_bearing: float,
    at_pin: float,
    before: float = 0.0,
) -> Arc:
    """Return the integrals for directions of the eccentricity in the maps of bearing and pin.

    The overlap was greatest ``before`` at an angle of the bearing's map.
    """
    joint = replace(
        JOINT,
        bearing_surface=bearing,
        pin_surface=pin,
        contact="foundation",
        clearance=C,
    )
    if not (bearing.is_worn or pin.is_worn):
        joint = replace(joint, wear=WearLaw(1e-15, angles=bearing.depth.size))
    packed = pack(placed(joint, 0.0, 0.0).linkage, wearing=True)
    record = packed.joints[0]
    cosine = math.cos(at_bearing)
    sine = math.sin(at_bearing)
    dx = eccentricity * cosine
    dy = eccentricity * sine
    place = place_of(record, dx, dy, eccentricity, at_pin - at_bearing)
    surfaces = packed.surfaces[0]
    search, sums = integrate_overlap(surfaces, record, place, before)
    overlap, cell = greatest_overlap(surfaces, place, search)
    x = sums.x
    y = sums.y
    along = cosine * x + sine * y
    across = cosine * y - sine * x
    at = math.remainder((cell + 0.5) * place.width - at_bearing, TURN)
    return Arc(overlap, at, along, across, sums.pin_slope / place.width, sums.square)


def overlaps(
    s: Array, bearing: Surface, pin: Surface, eccentricity: float, *places: float
) -> Array:
    """Overlap at angles from the direction of the eccentricity."""
    first, second = depths(bearing, pin, *places)
    return np.asarray(eccentricity * np.cos(s) - C - first(s) - second(s))


def pin_slopes(bearing: Surface, pin: Surface, *places: float) -> CubicHermiteSpline:
    """Return the derivative of the depth of the pin by the angle of the pin."""
    nodes = depths(bearing, pin, *places)[1].x
    if not pin.depth.size:
        return CubicHermiteSpline(nodes, 0.0 * nodes, 0.0 * nodes)
    curve = periodic(pin)
    angles = (places[1] + nodes) % TURN
    return CubicHermiteSpline(nodes, curve(angles, 1), curve(angles, 2))


def directly(
    bearing: Surface, pin: Surface, eccentricity: float, *places: float
) -> Array:
    """Greatest overlap and its integrals by Gauss's rule between all roots and nodes."""
    slopes = pin_slopes(bearing, pin, *places)
    fine = np.linspace(-0.6, 0.6, 40_001)

    def overlap(s: Array) -> Array:
        return overlaps(s, bearing, pin, eccentricity, *places)

    values = overlap(fine)
    changes = np.flatnonzero(np.sign(values[1:]) != np.sign(values[:-1]))
    roots = [brentq(overlap, fine[k], fine[k + 1], xtol=1e-15) for k in changes]
    near = fine[np.argmax(values)]
    span = (near - 1e-4, near + 1e-4)
    greatest = minimize_scalar(
        lambda s: -overlap(s), bounds=span, options={"xatol": 1e-10}
    )
    ends = np.sort(np.concatenate([slopes.x[abs(slopes.x) < 0.6], roots]))
    sums = np.zeros(4)
    points, weights = np.polynomial.legendre.leggauss(8)
    for low, high in itertools.pairwise(ends):
        s = 0.5 * (low + high) + 0.5 * (high - low) * points
        p = np.maximum(overlap(s), 0.0)
        fields = np.array([np.cos(s), np.sin(s), slopes(s), p])
        sums += 0.5 * (high - low) * (fields * p) @ weights
    return np.array([-greatest.fun, *sums])


@pytest.mark.parametrize("above", [5e-6, 1e-7, -1e-6])
@pytest.mark.parametrize(
    ("bearing", "pin"),
    [
        (groove(0.3, 2e-5), groove(0.05, 1e-5, at=1.6)),
        (groove(0.3, 2e-5), Surface()),
        (rough(1), rough(2)),
        (groove(0.02, 3e-4), Surface()),  # deeper than the pin can follow
        (Surface(np.where(bin_centres(BINS) > 1.5, 3e-5, 0.0)), rough(3)),  # a step
    ],
    ids=["smooth", "bearing only", "rough", "notch", "step"],
)
def test_sums_are_the_integrals(bearing: Surface, pin: Surface, above):
    places = (1.52, 1.71)
    here = float(bearing(np.array(places[:1]))[0] if bearing.is_worn else 0.0)
    here += float(pin(np.array(places[1:]))[0] if pin.is_worn else 0.0)
    args = (bearing, pin, C + here + above, *places)
    result = arc_of(*args)
    overlap, along, across, slope, square = directly(*args)
    assert result.overlap == pytest.approx(overlap, abs=5e-17)
    allowed = 2e-10 * (abs(along) + 1e-14)
    assert (result.along, result.across) == pytest.approx((along, across), abs=allowed)
    assert result.pin_slope == pytest.approx(slope, abs=2e-3 * allowed)
    assert result.square == pytest.approx(square, rel=1e-9, abs=1e-26)


@pytest.mark.parametrize("bins", [9, 63, 90, 720])
@pytest.mark.parametrize("eccentricity", [1e-9, 4e-4, C + 2e-5])
def test_the_nearest_place_of_a_worn_turn_is_found(eccentricity, bins):
    """However far round it lies: the pin is near the centre, or presses on a long arc."""
    bearing = rough(4, bins)
    pin = rough(5, bins)
    s = np.linspace(-math.pi, math.pi, 800_001)
    overlap = overlaps(s, bearing, pin, eccentricity, 0.4, 2.2)
    result = arc_of(bearing, pin, eccentricity, 0.4, 2.2)
    # The grid's own error: a bend of 2 m/rad^2 over half its step.
    assert result.overlap == pytest.approx(overlap.max(), rel=0.0, abs=2e-11)
    at = overlaps(np.array([result.place]), bearing, pin, eccentricity, 0.4, 2.2)[0]
    assert at == pytest.approx(result.overlap, rel=0.0, abs=5e-17)
    square = (np.maximum(overlap, 0.0) ** 2).sum() * (s[1] - s[0])
    assert result.square == pytest.approx(square, rel=1e-5, abs=1e-26)


@given(st.floats(-6.0, 2.0), st.floats(0.0, 6.0))
def test_a_round_contact_is_that_of_maps_without_depth(power, direction):
    """Closed form and sums over the arc fill all numbers of a contact alike."""
    joint = replace(JOINT, contact="foundation", wear=WearLaw(1e-15))
    rates = np.array([0.1, -0.2, 3.0, 0.2, 0.1, -7.0])
    pair = placed(joint, C * 10.0**power, direction, rates=rates)
    whole = pack(pair.linkage, wearing=True)
    worn = contacts_in(pair.linkage, whole, pair.q, pair.v)[0]
    plain = pair.contact()
    assert pair.packed.joints[0]["surface_bins"] == 0 < whole.joints[0]["surface_bins"]
    scale = {
        "elastic": plain.elastic,
        "energy": plain.energy,
        "couple": plain.elastic * C,
    }
    for name in CONTACT.names or ():
        if name not in (
            "place",
            "map_x",
            "map_y",
            "normal",
            "tangential",
            "bristle",
            "bristle_rate",
        ):
            # Lengths in m, speeds in m/s and directions have the scale 1.
            allowed = 3e-8 * scale.get(name, 1.0)
            assert worn[name] == pytest.approx(plain[name], abs=allowed), name


def worn(bearing: Surface, pin: Surface) -> Pair:
    """Two free bodies, both turning, with the pin where it overlaps by some micrometres."""
    joint = replace(
        JOINT, bearing_surface=bearing, pin_surface=pin, contact="foundation"
    )
    rates = np.array([0.3, -0.2, 4.0, 0.1, 0.25, -7.0])
    low = -5e-4
    high = 5e-4
    for _ in range(60):
        middle = 0.5 * (low + high)
        pair = placed(joint, middle, 1.1, angles=(0.2, -0.4), rates=rates)
        low, high = (
            (middle, high) if pair.contact().penetration < 4e-6 else (low, middle)
        )
    return pair


@settings(max_examples=6)
@given(seed=st.integers(0, 10_000), bins=st.sampled_from([16, 90, 360, 720]))
def test_forces_are_the_gradient_of_the_energy(seed, bins):
    """At rest, without friction and damping, nothing but the elastic force is left."""
    pair = worn(
        Surface(1e-5 * np.random.default_rng(seed).random(bins)),
        groove(0.5, 8e-6, bins),
    )
    elastic = replace(JOINT.normal, damping=0.0)
    smooth = replace(JOINT.friction, coefficient=0.0)
    calm = Pair(
        replace(pair.joint, normal=elastic, friction=smooth), pair.q, np.zeros(6)
    )
    load = calm.load(1.0)
    force = np.array(
        [-load.x, -load.y, load.bearing_moment, load.x, load.y, load.pin_moment]
    )
    for i, (size, arm) in enumerate(2 * [(1e-10, 1.0), (1e-10, 1.0), (3e-9, 0.02)]):
        step = size * np.eye(6)[i]
        ahead, behind = (
            replace(calm, q=calm.q + d).contact().energy for d in (step, -step)
        )
        allowed = 3e-6 * abs(load.normal) * arm
        assert force[i] == pytest.approx((behind - ahead) / (2.0 * size), abs=allowed)


def test_rates_of_overlap_and_energy_are_derivatives():
    pair = worn(groove(0.3, 2e-5), groove(0.2, 1e-5))
    acceleration = np.array([3.0, -20.0, 400.0, 50.0, 10.0, -300.0])
    contact = pair.contact()

    def overlap(time: float) -> float:
        return float(pair.after(time, acceleration).contact().penetration)

    h = 1e-7
    assert contact.rate == pytest.approx(
        (overlap(h) - overlap(-h)) / (2.0 * h), rel=1e-6
    )
    h = 5e-7
    second = (overlap(h) - 2.0 * overlap(0.0) + overlap(-h)) / h**2
    assert pair.penetration_acceleration(acceleration) == pytest.approx(
        second, rel=1e-3
    )
    h = 1e-8
    ahead, behind = (pair.after(d).contact().energy for d in (h, -h))
    assert contact.elastic * contact.closing == pytest.approx(
        (ahead - behind) / (2 * h), rel=1e-6
    )


@settings(max_examples=20)
@given(seed=st.integers(0, 10_000), above=st.floats(0.0, 2e-5))
@example(seed=626, above=3e-6)
@example(seed=1790, above=3e-6)
def test_no_patch_hides_between_two_nodes(seed, above):
    """On coarse rough maps the overlap can rise and fall twice inside one segment."""
    random = np.random.default_rng(seed)
    bearing, pin = (Surface(3e-5 * random.random(24)) for _ in range(2))
    places = random.uniform(0.0, 6.0, 2).tolist()
    before = arc_of(bearing, pin, C, *places)
    # So far that the place that comes nearest meets by the micrometre.
    eccentricity = C + (1e-6 + above - before.overlap) / math.cos(before.place)
    result = arc_of(bearing, pin, eccentricity, *places)
    assert result.along > 0.0
    s = np.linspace(-1.5, 1.5, 300_001)
    overlap = overlaps(s, bearing, pin, eccentricity, *places)
    assert result.overlap == pytest.approx(overlap.max(), abs=1e-12)
    along = (np.maximum(overlap, 0.0) * np.cos(s)).sum() * (s[1] - s[0])
    assert result.along == pytest.approx(along, rel=2e-4, abs=1e-12)
