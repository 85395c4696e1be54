"""The elastic foundation: quadrature, its potential, convergence over the angles."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from two_bodies import JOINT, Pair, placed

from presswear.linkage.elements import WearLaw
from presswear.linkage.surface import Surface, bin_centres
from presswear.physics.contact import CONTACT, note_contacts
from presswear.physics.foundation import foundation_stiffness, pack_rows, press
from presswear.physics.friction_and_normal import round_foundation
from presswear.physics.packed import pack
from presswear.physics.segment import ArcIntegrals
from presswear.tools.arrays import Array

C = 8e-4
BINS = 360


def rough(seed: int, bins: int = BINS) -> Surface:
    """A map without any smoothness from bin to bin, up to 20 um deep."""
    return Surface(2e-5 * np.random.default_rng(seed).random(bins))


def groove(width: float, depth: float, bins: int = BINS, at: float = 1.5) -> Surface:
    """A smooth groove."""
    return Surface(depth * np.exp(-(((bin_centres(bins) - at) / width) ** 2)))


def bed(
    bearing: Surface, pin: Surface, eccentricity: float, at_bearing: float, at_pin: float
) -> ArcIntegrals:
    count = max(bearing.depth.size, pin.depth.size)
    surfaces = pack_rows(bearing, pin, count)
    least = sum(float(s.depth.min()) if s.is_worn else 0.0 for s in (bearing, pin))
    return press(surfaces, count, eccentricity, C, least, at_bearing, at_pin, np.zeros((2, 0)))


def overlaps(
    s: Array, bearing: Surface, pin: Surface, eccentricity: float, *places: float
) -> Array:
    """Overlap at angles from the direction of the eccentricity."""
    depth = bearing(places[0] + s) + pin(places[1] + s)
    return np.asarray(eccentricity * np.cos(s) - C - depth)


def directly(bearing: Surface, pin: Surface, eccentricity: float, *places: float) -> Array:
    """Greatest overlap and sums of a bed by the rectangle rule on a fine grid."""
    s = np.linspace(-0.6, 0.6, 400_001)
    overlap = overlaps(s, bearing, pin, eccentricity, *places)
    rise = (bearing(places[0] + s + 1e-7) - bearing(places[0] + s - 1e-7)) / 2e-7
    p = np.maximum(overlap, 0.0)
    sums = np.array([np.cos(s), np.sin(s), rise, p]) @ p * (s[1] - s[0])
    return np.array([overlap.max(), *sums])


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
def test_sums_are_the_integrals(bearing: Surface, pin: Surface, above: float) -> None:
    places = (1.52, 1.71)
    here = float(bearing(np.array(places[:1]))[0] if bearing.is_worn else 0.0)
    here += float(pin(np.array(places[1:]))[0] if pin.is_worn else 0.0)
    empty = Surface(np.zeros(BINS))
    args = (bearing, pin if pin.is_worn else empty, C + here + above, *places)
    result, (overlap, along, across, slope, square) = bed(*args), directly(*args)
    assert result.overlap == pytest.approx(overlap, abs=1e-12)
    # The grid's own error: kinks of p inside a step of 3e-6 rad.
    allowed = 2e-6 * (result.along + 1e-16)
    assert (result.along, result.across) == pytest.approx((along, across), abs=allowed)
    assert result.slope == pytest.approx(slope, abs=2e-6 * (2e-3 * result.along + 1e-18))
    assert result.square == pytest.approx(square, rel=1e-6, abs=1e-24)


@pytest.mark.parametrize("bins", [9, 63, 90, 720])
@pytest.mark.parametrize("eccentricity", [1e-9, 4e-4, C + 2e-5])
def test_the_nearest_place_of_a_worn_turn_is_found(eccentricity: float, bins: int) -> None:
    """However far round it lies: the pin is near the centre, or presses on a long arc."""
    bearing, pin = rough(4, bins), rough(5, bins)
    s = np.linspace(-math.pi, math.pi, 800_001)
    overlap = overlaps(s, bearing, pin, eccentricity, 0.4, 2.2)
    result = bed(bearing, pin, eccentricity, 0.4, 2.2)
    # The grid's own error: a bend of 2 m/rad^2 over half its step.
    assert result.overlap == pytest.approx(overlap.max(), rel=0.0, abs=2e-11)
    at = overlaps(np.array([result.place]), bearing, pin, eccentricity, 0.4, 2.2)[0]
    assert at == pytest.approx(result.overlap, rel=0.0, abs=1e-17)
    area = np.maximum(overlap, 0.0).sum() * (s[1] - s[0])
    assert result.area == pytest.approx(area, rel=1e-5, abs=1e-22)


@pytest.mark.parametrize("bins", [16, BINS])  # the patch is narrower than a bin, and wider
@pytest.mark.parametrize("penetration", [1e-7, 1e-6, 5e-6])
def test_a_round_joint_gives_back_the_normal_law(penetration: float, bins: int) -> None:
    """K delta^1.5 with an error of 0.65 delta / c: the arc's curvature."""
    flat = Surface(np.zeros(bins))
    force = foundation_stiffness(1e10, C) * bed(flat, flat, C + penetration, 0.3, 0.9).along
    ratio = force / (1e10 * penetration**1.5)
    assert ratio == pytest.approx(1.0 - 0.65 * penetration / C, abs=0.03 * penetration / C)


@pytest.mark.parametrize("bins", [BINS, 97])
@pytest.mark.parametrize("part", [1e-9, 1e-6, 1e-4, 0.01, 0.1, 0.5, 1.0, 3.0, 30.0])
def test_round_surfaces_have_the_closed_form(part: float, bins: int) -> None:
    """The sums over maps of no depth, and both formulas where they do not cancel."""
    flat, penetration = Surface(np.zeros(bins)), part * C
    eccentricity = C + penetration
    sums = bed(flat, flat, eccentricity, 0.3, 0.9)
    stiffness = foundation_stiffness(1e10, C)
    force, energy = round_foundation(penetration, 1e10, C)
    # The penetration of the sums is a difference, and has the round-off of the clearance.
    allowed = 3e-11 + 4e-16 / part
    assert stiffness * sums.along == pytest.approx(force, rel=allowed)
    assert 0.5 * stiffness * sums.square == pytest.approx(energy, rel=allowed)
    if part >= 0.5:
        half = math.acos(C / eccentricity)
        exact = eccentricity * half - C * math.sin(half)
        assert force == pytest.approx(stiffness * exact, rel=2e-14)
        exact = (eccentricity**2 + 2.0 * C**2) * half - 3.0 * eccentricity * C * math.sin(half)
        assert energy == pytest.approx(0.5 * stiffness * exact, rel=1e-13)


@given(st.floats(-6.0, 2.0), st.floats(0.0, 6.0))
def test_a_round_contact_is_that_of_maps_without_depth(power: float, direction: float) -> None:
    """Closed form and sums over the arc fill all numbers of a contact alike."""
    joint = replace(JOINT, contact="foundation", wear=WearLaw(1e-15))
    rates = np.array([0.1, -0.2, 3.0, 0.2, 0.1, -7.0])
    pair = placed(joint, C * 10.0**power, direction, rates=rates)
    whole = pack(pair.linkage, wearing=True)
    contacts = np.zeros(1, CONTACT)
    note_contacts(whole, contacts, pair.q, pair.v)
    plain = pair.contact()
    assert pair.packed.joints[0]["surface_bins"] == 0 < whole.joints[0]["surface_bins"]
    scale = {"elastic": plain.elastic, "energy": plain.energy, "couple": plain.elastic * C}
    for name in CONTACT.names or ():
        if name not in ("place", "normal", "tangential", "bristle", "bristle_rate"):
            allowed = 1e-9 * scale.get(name, 1.0)  # lengths in m, speeds in m/s, directions
            assert contacts[0][name] == pytest.approx(plain[name], abs=allowed), name


def worn(bearing: Surface, pin: Surface) -> Pair:
    """Two free bodies, both turning, with the pin where it overlaps by some micrometres."""
    joint = replace(JOINT, bearing_surface=bearing, pin_surface=pin, contact="foundation")
    rates = np.array([0.3, -0.2, 4.0, 0.1, 0.25, -7.0])
    low, high = -5e-4, 5e-4
    for _ in range(60):
        middle = 0.5 * (low + high)
        pair = placed(joint, middle, 1.1, angles=(0.2, -0.4), rates=rates)
        low, high = (middle, high) if pair.contact().penetration < 4e-6 else (low, middle)
    return pair


@given(seed=st.integers(0, 10_000), bins=st.sampled_from([16, 90, 360, 720]))
def test_forces_are_the_gradient_of_the_energy(seed: int, bins: int) -> None:
    """At rest, without friction and damping, nothing but the elastic force is left."""
    pair = worn(Surface(1e-5 * np.random.default_rng(seed).random(bins)), groove(0.5, 8e-6, bins))
    elastic = replace(JOINT.normal, damping=0.0)
    smooth = replace(JOINT.friction, coefficient=0.0)
    calm = Pair(replace(pair.joint, normal=elastic, friction=smooth), pair.q, np.zeros(6))
    load = calm.load(1.0)
    force = np.array([-load.x, -load.y, load.bearing_moment, load.x, load.y, load.pin_moment])
    for i, (size, arm) in enumerate(2 * [(1e-10, 1.0), (1e-10, 1.0), (3e-9, 0.02)]):
        step = size * np.eye(6)[i]
        ahead, behind = (replace(calm, q=calm.q + d).contact().energy for d in (step, -step))
        allowed = 3e-6 * abs(load.normal) * arm
        assert force[i] == pytest.approx((behind - ahead) / (2.0 * size), abs=allowed)


def test_rates_of_overlap_and_energy_are_derivatives() -> None:
    pair = worn(groove(0.3, 2e-5), groove(0.2, 1e-5))
    acceleration = np.array([3.0, -20.0, 400.0, 50.0, 10.0, -300.0])
    contact = pair.contact()

    def overlap(time: float) -> float:
        return float(pair.after(time, acceleration).contact().penetration)

    h = 1e-7
    assert contact.rate == pytest.approx((overlap(h) - overlap(-h)) / (2.0 * h), rel=1e-6)
    h = 5e-7
    second = (overlap(h) - 2.0 * overlap(0.0) + overlap(-h)) / h**2
    assert pair.penetration_acceleration(acceleration) == pytest.approx(second, rel=1e-3)
    h = 1e-8
    ahead, behind = (pair.after(d).contact().energy for d in (h, -h))
    assert contact.elastic * contact.closing == pytest.approx((ahead - behind) / (2 * h), rel=1e-6)


@given(seed=st.integers(0, 10_000), above=st.floats(0.0, 2e-5))
@example(seed=626, above=3e-6)
@example(seed=1790, above=3e-6)
def test_no_patch_hides_between_two_nodes(seed: int, above: float) -> None:
    """On coarse rough maps the overlap can rise and fall twice inside one segment."""
    random = np.random.default_rng(seed)
    bearing, pin = (Surface(3e-5 * random.random(24)) for _ in range(2))
    places = random.uniform(0.0, 6.0, 2).tolist()
    before = bed(bearing, pin, C, *places)
    # So far that the place that comes nearest meets by the micrometre.
    eccentricity = C + (1e-6 + above - before.overlap) / math.cos(before.place)
    result = bed(bearing, pin, eccentricity, *places)
    assert result.along > 0.0
    s = np.linspace(-1.5, 1.5, 300_001)
    overlap = overlaps(s, bearing, pin, eccentricity, *places)
    assert result.overlap == pytest.approx(overlap.max(), abs=1e-12)
    along = (np.maximum(overlap, 0.0) * np.cos(s)).sum() * (s[1] - s[0])
    assert result.along == pytest.approx(along, rel=2e-4, abs=1e-12)
