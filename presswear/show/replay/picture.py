"""The picture: an Exudyn system that holds nothing but what is seen.

Bodies, bearings and pins are rigid bodies whose coordinates are those that were stored;
what changes its shape (forces, paths, words) is drawn anew for every frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import exudyn as exu
import numpy as np
from numpy.typing import NDArray

from presswear.linkage.elements import ClearanceJoint
from presswear.show.replay.bodies import (
    INK,
    JOINTS,
    STEEL,
    Scale,
    body_graphics,
    extent,
    frame_graphics,
)
from presswear.show.replay.joints import (
    FORCE,
    Enlargement,
    bearing_shapes,
    contact_shapes,
    joint_words,
    map_angle,
    mark_shapes,
    path_shapes,
    pin_shapes,
    play_shapes,
)
from presswear.show.replay.layout import Layout, Panel, layout_of
from presswear.show.replay.reel import Instant, Subject, Surfaces, points_of
from presswear.show.replay.shapes import Colour, Shape, graphics, line, text

Array = NDArray[np.float64]

_FONT = 13.0
"""Letters in a window 640 pixels high, pixels."""


@dataclass(frozen=True)
class _Joint:
    """An enlarged joint of one panel."""

    number: int
    joint: ClearanceJoint
    centre: Array
    factor: Enlargement
    worn: Surfaces

    @property
    def paint(self) -> Colour:
        return JOINTS[self.number % len(JOINTS)]


@dataclass(frozen=True)
class _Show:
    """A subject in its panel."""

    subject: Subject
    panel: Panel
    joints: tuple[_Joint, ...]


class Picture:
    """Subjects side by side, as the renderer shows them.

    Parameters
    ----------
    subjects : sequence of Subject
    size : tuple of int
        Width and height, pixels.
    """

    def __init__(self, subjects: Sequence[Subject], size: tuple[int, int]) -> None:
        boxes = [_padded(extent(subject.linkage, subject.motion)) for subject in subjects]
        counts = [len(subject.linkage.clearances) for subject in subjects]
        self.layout: Layout = layout_of(boxes, counts, size[0] / size[1])
        self._scale = Scale(
            max(float(np.hypot(*(high - low))) for low, high in boxes), _FONT * size[1] / 640.0
        )
        self._shows = tuple(map(_show, subjects, self.layout.panels))
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        for show in self._shows:
            self._add(show)
        self._ink = self.system.AddObject({"objectType": "Ground"})
        self.system.Assemble()
        self._settings(size)

    def _add(self, show: _Show) -> None:
        """Frame, bodies and enlarged joints of one subject."""
        linkage, panel, scale = show.subject.linkage, show.panel, self._scale
        still = frame_graphics(linkage, show.subject.motion, scale)
        self.system.AddObject(
            {
                "objectType": "Ground",
                "referencePosition": [*panel.offset, 0.0],
                "VgraphicsData": [*still],
            }
        )
        for body in linkage.bodies:
            self._add_body(panel.offset, body_graphics(linkage, body.name, scale))
        for own in show.joints:
            width = 0.02 * panel.radius
            pin_radius = own.factor.body * own.joint.pin_radius
            drawn = (
                bearing_shapes(own.joint, own.worn.bearing, own.factor, self._layers(70)),
                mark_shapes(panel.radius, width, scale.layer(73)),
                pin_shapes(own.joint, own.worn.pin, own.factor, self._layers(75)),
                mark_shapes(pin_radius, width, scale.layer(78)),
            )
            for shapes in drawn:
                self._add_body(own.centre, [graphics(shapes)])

    def _layers(self, first: int) -> list[float]:
        return [self._scale.layer(first + i) for i in range(3)]

    def _add_body(self, origin: Array, drawn: list[dict[str, Any]]) -> None:
        node = self.system.AddNode(
            {"nodeType": "RigidBody2D", "referenceCoordinates": [*origin, 0.0], "Vshow": False}
        )
        self.system.AddObject(
            {
                "objectType": "RigidBody2D",
                "nodeNumber": node,
                "mass": 1.0,
                "inertia": 1.0,
                "VgraphicsData": drawn,
            }
        )

    def _settings(self, size: tuple[int, int]) -> None:
        settings: Any = self.container.visualizationSettings
        settings.view0.window.renderWindowSize = list(size)
        settings.view0.window.showComputationInfo = False
        settings.view0.scene.drawCoordinateSystem = False
        settings.nodes.show = False
        # Plain colours: all light is ambient.
        settings.openGL.lightModelAmbient = [1.0, 1.0, 1.0, 1.0]
        for number in range(4):
            getattr(settings.openGL, f"light{number}").enable = False
        settings.general.autoFitScene = False
        # Texts that are always in front keep OpenGL from clearing its depths.
        settings.general.textAlwaysInFront = False
        settings.raytracer.multiSampling = 2
        # Without the reset a view that is set before the first image is lost.
        self.container.renderer.ResetState()
        self.look()

    def look(self) -> None:
        """Point the view at the whole picture."""
        # Exudyn's zoom is half of the height that it shows.
        self.container.renderer.SetModelView(
            0.5 * self.layout.height, [0.0, 0.0, 0.0], [*self.layout.centre, 0.0]
        )

    def set(self, instants: Sequence[Instant], part: float, note: str) -> None:
        """Set the renderer's state to an instant of each subject.

        Parameters
        ----------
        part : float
            Where that is in what is played, 0 .. 1.
        note : str
            A word on how it is played.
        """
        coordinates, ink, words = [], self._bar(part), []
        for show, instant in zip(self._shows, instants, strict=True):
            coordinates.append(instant.past[-1])
            words += self._title(show, instant, note)
            for own in show.joints:
                bearing, pin = (
                    points_of(show.subject.linkage, instant.past, end)
                    for end in (own.joint.bearing, own.joint.pin)
                )
                coordinates += _enlarged(own, bearing[-1], pin[-1])
                ink += self._moving(own, instant, bearing, pin)
                words += self._joint_words(own, instant)
        self._place(np.concatenate(coordinates), instants[0].time)
        self.system.SetObjectParameter(self._ink, "VgraphicsData", [graphics(ink), *words])

    def _place(self, coordinates: Array, time: float) -> None:
        data = self.system.systemData
        for kind in (exu.ConfigurationType.Current, exu.ConfigurationType.Visualization):
            data.SetODE2Coordinates(coordinates, kind)
            data.SetTime(time, kind)

    def _moving(self, own: _Joint, instant: Instant, bearing: Array, pin: Array) -> list[Shape]:
        """Path, contact and force of a joint; poses of bearing and pin, shape (n, 3)."""
        z = self._scale.layer
        eccentricity = (pin - bearing)[:, :2]
        turned = map_angle(own.joint, float(pin[-1, 2]))
        row = instant.joints[own.number]
        return [
            *play_shapes(own.centre, own.joint, own.factor, z(85)),
            *path_shapes(own.centre, eccentricity, own.factor, z(86), own.paint),
            *contact_shapes(
                own.centre,
                own.joint,
                own.worn.pin,
                turned,
                eccentricity[-1],
                row,
                own.factor,
                z(88),
            ),
        ]

    def _joint_words(self, own: _Joint, instant: Instant) -> list[dict[str, Any]]:
        font, z = self._scale.font, self._scale.layer(95)
        row, peak = instant.joints[own.number], float(instant.peaks[own.number])
        radius = own.factor.radius
        above = own.centre + np.array([-1.45, 1.13]) * radius
        below = own.centre + np.array([-1.45, -1.19]) * radius
        words = [text(above, joint_words(own.joint.name, row, peak), z, font, own.paint)]
        for i, factor in enumerate(own.factor.words()):
            words.append(text(below - [0.0, i * self._line(0.8)], factor, z, 0.75 * font, INK))
        return words

    def _line(self, size: float) -> float:
        """Height of a line of words of a part of the common size, m."""
        return 1.5 * size * _FONT / 640.0 * self.layout.height

    def _title(self, show: _Show, instant: Instant, note: str) -> list[dict[str, Any]]:
        subject, font, z = show.subject, self._scale.font, self._scale.layer(95)
        turned = 360.0 * instant.time / subject.period
        state = (
            f"t = {instant.time:.4f} s   crank {turned % 360.0:5.1f} deg "
            f"of cycle {int(turned // 360.0) + 1}"
        )
        below = show.panel.title - [0.0, self._line(1.2)]
        return [
            text(show.panel.title, f"{subject.title}, {subject.stage}", z, 1.15 * font, INK),
            text(below, f"{state}   {note}", z, font, INK),
        ]

    def _bar(self, part: float) -> list[Shape]:
        start, end = self.layout.bar
        width, z = 0.006 * self.layout.height, self._scale.layer(90)
        here = start + part * (end - start)
        mark = np.array([0.0, 1.6 * width])
        return [
            line(start, end, width, z, STEEL),
            line(start, here, width, z + self._scale.layer(1), INK),
            line(here - mark, here + mark, 1.2 * width, z + self._scale.layer(2), FORCE),
        ]

    def image(self) -> NDArray[np.uint8]:
        """The picture as set, ray-traced without a display; shape (height, width, 3)."""
        found: NDArray[np.uint8] = self.container.renderer.RedrawAndGetImage(True)
        return found

    def close(self) -> None:
        """Give the container back."""
        self.container.Reset()


def _padded(box: tuple[Array, Array]) -> tuple[Array, Array]:
    low, high = box
    margin = 0.09 * float(np.hypot(*(high - low)))
    return low - margin, high + margin


def _show(subject: Subject, panel: Panel) -> _Show:
    joints = []
    for k, joint in enumerate(subject.linkage.clearances):
        factor = Enlargement.of(joint, subject.deepest[k], subject.largest[k], panel.radius)
        joints.append(_Joint(k, joint, panel.joints[k], factor, subject.surfaces[k]))
    return _Show(subject, panel, tuple(joints))


def _enlarged(own: _Joint, bearing: Array, pin: Array) -> list[Array]:
    """Coordinates of an enlarged joint: bearing, its mark, pin, its mark."""
    x, y = own.factor.gap * (pin - bearing)[:2]
    angles = bearing[2], pin[2]
    maps = [map_angle(own.joint, float(angle)) for angle in angles]
    return [
        np.array([0.0, 0.0, maps[0], 0.0, 0.0, angles[0]]),
        np.array([x, y, maps[1], x, y, angles[1]]),
    ]
