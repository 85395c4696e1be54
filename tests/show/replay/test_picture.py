"""The picture shows what was stored: positions, joints and forces in the renderer's own data."""

import re
from collections.abc import Iterator
from dataclasses import replace

import exudyn as exu
import numpy as np
import pytest
from made_up_reel import FRAMES, made_up_reel
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.linkage.loads import Spring
from presswear.show.replay.bodies import attachments
from presswear.show.replay.joints import FORCE, EnlargedJoint
from presswear.show.replay.picture import Picture
from presswear.show.replay.reel import Instant, alike, points_of
from presswear.show.replay.shapes import colour

Array = NDArray[np.float64]

REEL = made_up_reel()
LINKAGE = REEL.linkage


@pytest.fixture(scope="module")
def picture() -> Iterator[Picture]:
    made = Picture([REEL], (480, 320))
    yield made
    made.close()


def drawn(picture: Picture, item: int) -> tuple[Array, Array]:
    """Corners of all triangles that one object of the renderer drew, and their colours."""
    data = picture.container.renderer.GetGraphicsData()["triangles"]
    own = (data["items"][:, 1] == exu.ItemType.Object.value) & (data["items"][:, 2] == item)
    return data["points"][own].reshape(-1, 3).astype(float), data["colors"][own].reshape(-1, 4)


def shifted(frame: int, by: Array) -> Instant:
    """A frame with everything moved, so that a point of it lies at the origin."""
    instant = REEL.instant(frame, frame - 1)
    past = instant.past.copy()
    past[:, 0::3] -= by[0]
    past[:, 1::3] -= by[1]
    return replace(instant, past=past)


def enlarged(radius: float, joint: ClearanceJoint = LINKAGE.clearances[0]) -> EnlargedJoint:
    """A joint as it is drawn about the origin."""
    room = REEL.deepest[joint.name], REEL.largest[joint.name]
    return EnlargedJoint(joint, *room, np.zeros(2), radius, FORCE)


@pytest.mark.parametrize("frame", [0, 17, 50, FRAMES - 1])
def test_bodies_are_drawn_where_they_were_stored(picture: Picture, frame: int) -> None:
    """Mass centres to 1e-9 m, joints to the rounding of the renderer's single numbers.

    Single numbers are fine enough near the origin only, so each mass centre is moved there.
    """
    offset = picture.layout.panels[0].offset
    stored = REEL.film.position[[frame]]
    for number, body in enumerate(LINKAGE.bodies):
        centre = stored[0, 3 * number : 3 * number + 2]
        picture.set([shifted(frame, centre + offset)], 0.0, "")
        points = drawn(picture, 1 + number)[0][:, :2]  # the frame is object 0
        assert np.hypot(*points.T).min() < 1e-9
        for _, end in attachments(LINKAGE, body.name):
            joint = points_of(LINKAGE, stored, end)[0, :2] - centre
            assert np.hypot(*(points - joint).T).min() < 3e-8


def test_what_the_renderer_is_given_is_what_was_stored(picture: Picture) -> None:
    for frame in range(0, FRAMES, 10):
        picture.set([REEL.instant(frame, frame)], 0.0, "")
        data = picture.system.systemData
        given = data.GetODE2Coordinates(exu.ConfigurationType.Visualization)
        count = REEL.film.position.shape[1]
        assert np.array_equal(given[:count], REEL.film.position[frame])
        assert data.GetTime(exu.ConfigurationType.Visualization) == REEL.film.time[frame]


def test_an_enlarged_pin_is_off_its_bearing_by_the_stated_factor(picture: Picture) -> None:
    bodies = len(LINKAGE.bodies)
    for frame in (3, 40):
        picture.set([REEL.instant(frame, frame)], 0.0, "")
        for k, joint in enumerate(LINKAGE.clearances):
            bearing, pin = (
                points_of(LINKAGE, REEL.film.position[[frame]], end)[0, :2]
                for end in (joint.bearing, joint.pin)
            )
            factor = enlarged(picture.layout.panels[0].radius, joint)
            # Bearing, its mark, pin, its mark; the bearing's outer edge is round.
            ring = drawn(picture, 1 + bodies + 4 * k)[0][:, :2]
            centre = 0.5 * (ring.min(axis=0) + ring.max(axis=0))
            assert centre == pytest.approx(picture.layout.panels[0].joints[k], abs=1e-6)
            mark = drawn(picture, 1 + bodies + 4 * k + 3)[0][:, :2].mean(axis=0)
            angle = points_of(LINKAGE, REEL.film.position[[frame]], joint.pin)[0, 2]
            along = 0.725 * factor.body * joint.pin_radius
            middle = mark - along * np.array([np.cos(angle), np.sin(angle)])
            assert middle - centre == pytest.approx(factor.gap * (pin - bearing), abs=2e-6)


def test_a_pin_that_just_touches_meets_the_bearing_in_the_picture() -> None:
    joint = LINKAGE.clearances[0]
    worn, groove = joint.bearing_surface.depth, joint.pin_surface.depth
    factor = enlarged(0.2)
    angle = (86 + 0.5) * np.pi / 180.0  # in the worn part, a bin centre
    normal = np.array([np.cos(angle), np.sin(angle)])
    row = np.array([50.0, 0.0, *normal, 0.0, 50.0])
    turned = angle - (229 + 0.5) * np.pi / 180.0  # the deepest part of the pin's groove
    reach = joint.clearance + worn[86] + groove[229]
    shapes = factor.contact(reach * normal, turned, row, 0.0)
    point = shapes[0].points[0]
    surface = factor.body * joint.pin_radius + factor.gap * (joint.clearance + worn[86])
    assert point == pytest.approx(surface * normal, abs=1e-12)
    # And so is the bearing drawn, but for two bins drawn as one.
    inner = factor.bodies(lambda layer: 0.0)[0][0].points[:180]
    nearest = inner[np.argmin(np.hypot(*(inner - point).T))]
    assert np.hypot(*nearest) == pytest.approx(surface, rel=1e-3)


def test_force_is_an_arrow_as_long_as_its_root() -> None:
    factor = enlarged(0.2)
    largest = factor.largest

    def length(force: float) -> float:
        row = np.array([force, 0.0, 1.0, 0.0, 0.0, force])
        shapes = factor.contact(np.array([factor.joint.clearance, 0.0]), 0.0, row, 0.0)
        if not shapes:
            return 0.0
        return float(max(s.points[:, 0].max() for s in shapes[1:]) - shapes[0].points[0, 0])

    assert length(0.0) == 0.0
    assert length(largest) == pytest.approx(0.55 * factor.radius)
    assert length(0.25 * largest) == pytest.approx(0.5 * length(largest))


def test_a_peak_in_words_is_never_below_its_force(picture: Picture) -> None:
    """With friction the whole force is above the normal one, of which the peak is."""
    instant = REEL.instant(20, 20)
    joints = instant.joints * np.array([100.0, 100.0, 1.0, 1.0, 1.0, 1.0])
    picture.set([replace(instant, joints=joints, peaks=joints[:, 0])], 0.0, "")
    told = picture.container.renderer.GetGraphicsData()["texts"]["text"]
    words = [re.search(r": \D* (\d+) N, peak (\d+) N$", own) for own in told]
    pairs = [own.groups() for own in words if own is not None]
    assert len(pairs) == 2
    assert all(int(force) == int(peak) > 0 for force, peak in pairs)


def test_a_spring_goes_from_end_to_end() -> None:
    spring = Spring("coil", LINKAGE.point("slider 6.centre", ""), (0.4, -0.3), 100.0, 0.1)
    picture = Picture([replace(REEL, linkage=replace(LINKAGE, springs=[spring]))], (480, 320))
    picture.set([REEL.instant(20, 20)], 0.0, "")
    ink = 1 + len(LINKAGE.bodies) + 4 * len(LINKAGE.clearances)
    points = drawn(picture, ink)[0][:, :2] - picture.layout.panels[0].offset
    slider = points_of(LINKAGE, REEL.film.position[[20]], spring.ends[0])[0, :2]
    for end in (slider, np.array([0.4, -0.3])):
        assert np.hypot(*(points - end).T).min() < 0.02
    picture.close()


def test_pixels_show_bodies_in_their_colours_and_a_contact_in_red(picture: Picture) -> None:
    picture.set([REEL.instant(20, 20)], 0.3, "")  # even frames press
    pixels = picture.image()
    assert pixels.shape == (320, 480, 3)
    found = {tuple(pixel) for pixel in pixels.reshape(-1, 3).tolist()}
    for code in ("#D55E00", "#0072B2", "#E69F00", "#009E73", "#CC79A7", "#56B4E9"):
        assert tuple(round(255 * part) for part in colour(code)[:3]) in found
    pressing = _red(picture)
    picture.set([REEL.instant(21, 21)], 0.3, "")
    assert 0 < _red(picture) < pressing  # the mark on the bar of time stays


def _red(picture: Picture) -> int:
    last = picture.system.systemData.NumberOfObjects() - 1
    return int(np.isclose(drawn(picture, last)[1], FORCE, atol=1e-6).all(axis=1).sum())


def test_words_tell_time_angle_stage_forces_and_factors(picture: Picture) -> None:
    picture.set([REEL.instant(20, 10)], 0.3, "slowed 18 times")
    words = " | ".join(picture.container.renderer.GetGraphicsData()["texts"]["text"])
    instant = REEL.instant(20, 10)
    for part in (
        "made up, first wear",
        f"t = {instant.time:.4f} s",
        "72.0 deg of cycle 1",
        "slowed 18 times",
        f"A: normal {instant.joints[0, 0]:.0f} N, peak {instant.peaks[0]:.0f} N",
        "clearance, wear x",
        "orange: wear once more",
    ):
        assert part in words


def test_the_path_reaches_back_and_no_further_than_the_film() -> None:
    assert len(REEL.instant(0, 0).past) == 1
    assert len(REEL.instant(FRAMES - 1, FRAMES - 2).past) == 61


def test_two_reels_stand_side_by_side_at_one_scale() -> None:
    deeper = made_up_reel("deeper", deepest=9e-5, largest=900.0)
    one, other = alike([REEL, deeper])
    assert one.deepest == other.deepest == {"A": 9e-5, "C": 9e-5}
    assert one.largest == other.largest == {"A": 900.0, "C": 900.0}
    both = Picture([one, other], (480, 320))
    both.set([one.instant(5, 5), other.instant(5, 5)], 0.5, "")
    left, right = both.layout.panels
    assert right.offset[0] - left.offset[0] == pytest.approx(0.75 * both.layout.height)
    assert right.offset[1] == left.offset[1]
    image = both.image().astype(int)
    # The same press twice: both halves agree but for words, wear and arrows.
    assert np.abs(image[40:170, :240] - image[40:170, 240:]).max(axis=2).mean() < 2.0
    both.close()


def test_the_first_image_already_has_the_right_view() -> None:
    fresh = Picture([REEL], (480, 320))
    fresh.set([REEL.instant(5, 5)], 0.5, "")
    first, second = fresh.image(), fresh.image()
    assert np.array_equal(first, second)
    bar = first[-20:].min(axis=2) < 230
    assert bar.any(axis=0).sum() > 0.9 * 480
    fresh.close()
