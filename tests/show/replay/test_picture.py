"""Pictures: positions, enlarged joints, forces and text in the data of the renderer."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from synthetic_clip import FRAMES, synthetic_clip

import presswear as pw
from presswear.show.replay.clip import Chapter, equal_limits
from presswear.show.replay.enlarged_joint import EnlargedJoint, force_text
from presswear.show.replay.picture import Picture
from presswear.show.replay.shapes import BODY_COLOURS, FORCE, attachments, points_of
from presswear.tools.arrays import Array

CLIP = synthetic_clip()
LINKAGE = CLIP.linkage


@pytest.fixture(scope="module")
def picture():
    made = Picture([CLIP], (480, 320))
    yield made
    made.close()


def drawn(picture: Picture, layer: int) -> Array:
    """Return the corners of the triangles in one layer of the renderer."""
    data = picture.container.renderer.GetGraphicsData()["triangles"]
    points = data["points"].reshape(-1, 3).astype(float)
    return points[np.isclose(points[:, 2], picture.height(layer), rtol=1e-5)][:, :2]


def words(picture: Picture) -> str:
    return " | ".join(picture.container.renderer.GetGraphicsData()["texts"]["text"])


def enlarged(radius: float) -> EnlargedJoint:
    joint = LINKAGE.clearances[0]
    limits = CLIP.max_depth[joint.name], CLIP.max_force[joint.name]
    return EnlargedJoint(joint, *limits, np.zeros(2), radius, FORCE)


@pytest.mark.parametrize("frame", [0, 17, FRAMES - 1])
def test_bodies_are_drawn_at_their_stored_positions(picture, frame):
    """Each mass centre is moved to the origin, where single precision is fine enough."""
    offset = picture.layout.panels[0].offset
    stored = CLIP.film.position[[frame]]
    for number, body in enumerate(LINKAGE.bodies):
        centre = stored[0, 3 * number : 3 * number + 2]
        state = CLIP.snapshot(frame, frame - 1)
        positions = state.positions.copy()
        positions[:, 0::3] -= (centre + offset)[0]
        positions[:, 1::3] -= (centre + offset)[1]
        picture.show([state._replace(positions=positions)], 0.0, "")
        assert np.hypot(*drawn(picture, 39).T).min() < 1e-9
        holes = drawn(picture, 41)
        for end in attachments(LINKAGE, body.name):
            joint = points_of(LINKAGE, stored, end)[0, :2] - centre
            assert np.hypot(*(holes - joint).T).min() < 3e-8


def test_an_enlarged_pin_has_the_stated_eccentricity(picture):
    frame = 40
    panel = picture.layout.panels[0]
    picture.show([CLIP.snapshot(frame, frame)], 0.0, "")
    rings, marks = (drawn(picture, layer) for layer in (70, 78))
    for centre, joint in zip(panel.joints, LINKAGE.clearances, strict=True):
        bearing, pin = (
            points_of(LINKAGE, CLIP.film.position[[frame]], end)[0]
            for end in (joint.bearing, joint.pin)
        )
        view = replace(enlarged(panel.radius), joint=joint)
        ring, mark = (
            points[np.hypot(*(points - centre).T) < 1.01 * panel.radius]
            for points in (rings, marks)
        )
        assert 0.5 * (ring.min(axis=0) + ring.max(axis=0)) == pytest.approx(
            centre, abs=1e-6
        )
        along = 0.725 * view.pin_factor * joint.pin_radius
        middle = mark.mean(axis=0) - along * np.array([np.cos(pin[2]), np.sin(pin[2])])
        assert middle - centre == pytest.approx(
            view.gap_factor * (pin - bearing)[:2], abs=2e-6
        )


def test_a_touching_pin_meets_the_worn_bearing():
    joint = LINKAGE.clearances[0]
    view = enlarged(0.2)
    worn = joint.bearing_surface.depth
    groove = joint.pin_surface.depth
    angle = (86 + 0.5) * np.pi / 180.0  # in the worn part, a bin centre
    normal = np.array([np.cos(angle), np.sin(angle)])
    row = np.array([50.0, 0.0, *normal, 0.0, 50.0])
    # the deepest part of the groove of the pin
    map_angle = angle - (229 + 0.5) * np.pi / 180.0
    reach = joint.clearance + worn[86] + groove[229]
    point = view.contact(reach * normal, map_angle, row)[0].points[0]
    surface = view.pin_factor * joint.pin_radius + view.gap_factor * (
        joint.clearance + worn[86]
    )
    assert point == pytest.approx(surface * normal, abs=1e-12)
    inner = view.bodies()[0][0].points[:180]
    nearest = inner[np.argmin(np.hypot(*(inner - point).T))]
    # Two bins are drawn as one.
    assert np.hypot(*nearest) == pytest.approx(surface, rel=1e-3)


def test_image_and_text(picture):
    state = CLIP.snapshot(20, 10)
    picture.show([state], 0.3, "slowed 18 times")
    normal, peak = (force_text(force) for force in (state.joints[0, 0], state.peaks[0]))
    force = f"A: normal {normal}, peak {peak}"
    parts = [
        "title, first wear",
        f"t = {state.time:.4f} s",
        "72.0 deg of cycle 1",
        force,
    ]
    for part in (
        *parts,
        "slowed 18 times",
        "clearance, wear x",
        "orange: wear depth x",
    ):
        assert part in words(picture)
    first = picture.image()
    second = picture.image()
    assert np.array_equal(first, second)
    assert first.shape == (320, 480, 3)
    colours = {tuple(pixel) for pixel in first.reshape(-1, 3).tolist()}
    bodies = CLIP.chapters[0].linkage.bodies
    for code in BODY_COLOURS[: len(bodies)]:
        assert tuple(round(255 * part) for part in to_rgb(code)) in colours


def test_two_clips_have_one_scale():
    pair = equal_limits(
        [CLIP, synthetic_clip("deeper", max_depth=9e-5, max_force=900.0)]
    )
    for clip in pair:
        assert (clip.max_depth["A"], clip.max_force["C"]) == (9e-5, 900.0)
    both = Picture(pair, (480, 320))
    both.show([clip.snapshot(5, 5) for clip in pair], 0.5, "")
    left, right = both.layout.panels
    assert right.offset - left.offset == pytest.approx([0.75 * both.layout.height, 0.0])
    image = both.image().astype(int)
    # Equal halves except for text, wear and arrows.
    assert np.abs(image[40:280, :120] - image[40:280, 240:360]).max(axis=2).mean() < 2.0
    both.close()


def test_a_spring_is_drawn_between_its_ends():
    spring = pw.Spring(
        "coil", pw.linkage.Attachment("slider 6", 0.0, 0.0), (0.4, -0.3), 100.0, 0.1
    )
    chapter = Chapter("first wear", LINKAGE.changed(springs=[spring]))
    picture = Picture([replace(CLIP, chapters=(chapter,))], (480, 320))
    picture.show([CLIP.snapshot(20, 20)], 0.0, "")
    points = drawn(picture, 38) - picture.layout.panels[0].offset
    slider = points_of(LINKAGE, CLIP.film.position[[20]], spring.ends[0])[0, :2]
    for end in (slider, np.array([0.4, -0.3])):
        assert np.hypot(*(points - end).T).min() < 0.02
    picture.close()
