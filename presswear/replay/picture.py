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

from presswear.replay.bodies import (
    INK,
    JOINTS,
    STEEL,
    Scale,
    body_graphics,
    extent,
    frame_graphics,
)
from presswear.replay.joints import (
    FORCE,
    Enlargement,
    bearing_shapes,
    contact_shapes,
    joint_words,
    largest_force,
    mark_shapes,
    path_shapes,
    pin_shapes,
    play_shapes,
    surfaces_angle,
)
from presswear.replay.layout import Layout, Panel, layout_of
from presswear.replay.reel import Reel
from presswear.replay.shapes import Shape, graphics, line, text

Array = NDArray[np.float64]

PATH_FRAMES = 60
"""Frames that the path of a pin's centre reaches back."""
_FONT = 13.0
"""Letters in a window 640 pixels high, pixels."""


@dataclass(frozen=True)
class _Joint:
    """An enlarged joint of one panel."""

    number: int
    centre: Array
    factor: Enlargement
    eccentricity: Array
    angles: Array
    """Of bearing and pin in every frame, rad, shape (n, 2)."""


@dataclass(frozen=True)
class _Show:
    """A reel in its panel."""

    reel: Reel
    panel: Panel
    joints: tuple[_Joint, ...]


class Picture:
    """Reels side by side, as the renderer shows them.

    Parameters
    ----------
    reels : sequence of Reel
    size : tuple of int
        Width and height, pixels.
    """

    def __init__(self, reels: Sequence[Reel], size: tuple[int, int]) -> None:
        boxes = [_padded(extent(reel.linkage, reel.film.position)) for reel in reels]
        counts = [len(reel.linkage.clearances) for reel in reels]
        self.layout: Layout = layout_of(boxes, counts, size[0] / size[1])
        self._scale = Scale(
            max(float(np.hypot(*(high - low))) for low, high in boxes), _FONT * size[1] / 640.0
        )
        self.shows = tuple(
            self._show(reel, panel)
            for reel, panel in zip(reels, self.layout.panels, strict=True)
        )
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        for show in self.shows:
            self._add(show)
        self._ink = self.system.AddObject({"objectType": "Ground"})
        self.system.Assemble()
        self._settings(size)

    def _show(self, reel: Reel, panel: Panel) -> _Show:
        joints = []
        for k, joint in enumerate(reel.linkage.clearances):
            largest = largest_force(reel.film.joints[:, k])
            factor = Enlargement.of(joint, reel.deepest[k], largest, panel.radius)
            angles = [reel.pose(end)[:, 2] for end in (joint.bearing, joint.pin)]
            own = _Joint(k, panel.joints[k], factor, reel.eccentricity(k), np.column_stack(angles))
            joints.append(own)
        return _Show(reel, panel, tuple(joints))

    def _add(self, show: _Show) -> None:
        """Frame, bodies and enlarged joints of one reel."""
        reel, panel, scale = show.reel, show.panel, self._scale
        still = frame_graphics(reel.linkage, reel.film.position, scale)
        self.system.AddObject(
            {
                "objectType": "Ground",
                "referencePosition": [*panel.offset, 0.0],
                "VgraphicsData": [*still],
            }
        )
        for body in reel.linkage.bodies:
            self._add_body(panel.offset, body_graphics(reel.linkage, body.name, scale))
        for own in show.joints:
            joint = reel.linkage.clearances[own.number]
            worn = reel.surfaces[own.number]
            drawn = (
                bearing_shapes(joint, worn.bearing, own.factor, self._layers(70)),
                mark_shapes(panel.radius, 0.02 * panel.radius, scale.layer(73)),
                pin_shapes(joint, worn.pin, own.factor, self._layers(75)),
                mark_shapes(
                    own.factor.body * joint.pin_radius, 0.02 * panel.radius, scale.layer(78)
                ),
            )
            for shapes in drawn:
                self._add_body(own.centre, [graphics(shapes)])

    def _layers(self, first: int) -> list[float]:
        return [self._scale.layer(first + i) for i in range(3)]

    def _add_body(self, origin: Array, drawn: list[dict[str, Any]]) -> None:
        node = self.system.AddNode(
            {
                "nodeType": "RigidBody2D",
                "referenceCoordinates": [*origin, 0.0],
                "Vshow": False,
            }
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
        settings = self.container.visualizationSettings
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

    def coordinates(self, frames: Sequence[int]) -> Array:
        """Coordinates of all bodies of the system in one frame of each reel."""
        parts = []
        for show, frame in zip(self.shows, frames, strict=True):
            parts.append(show.reel.film.position[frame])
            for own in show.joints:
                joint = show.reel.linkage.clearances[own.number]
                bearing, pin = own.angles[frame]
                moved = own.factor.gap * own.eccentricity[frame]
                parts += [
                    [0.0, 0.0, surfaces_angle(joint, bearing)],
                    [0.0, 0.0, bearing],
                    [*moved, surfaces_angle(joint, pin)],
                    [*moved, pin],
                ]
        return np.concatenate(parts)

    def set(self, frames: Sequence[int], peaks: Sequence[Array], part: float, note: str) -> None:
        """Set the renderer's state to one frame of each reel.

        Parameters
        ----------
        frames : sequence of int
        peaks : sequence of ndarray, shape (joints,)
            Greatest force that each joint bore since the picture before, N.
        part : float
            Where the frame is in what is played, 0 .. 1.
        note : str
            A word on how it is played.
        """
        data = self.system.systemData
        coordinates = self.coordinates(frames)
        time = float(self.shows[0].reel.film.time[frames[0]])
        for kind in (exu.ConfigurationType.Current, exu.ConfigurationType.Visualization):
            data.SetODE2Coordinates(coordinates, kind)
            data.SetTime(time, kind)
        ink, words = self._bar(part), []
        for show, frame, peak in zip(self.shows, frames, peaks, strict=True):
            words += self._title(show, frame, note)
            for own in show.joints:
                ink += self._moving(show, own, frame)
                words += self._joint_words(show, own, frame, float(peak[own.number]))
        drawn = [graphics(ink), *words]
        self.system.SetObjectParameter(self._ink, "VgraphicsData", drawn)

    def _moving(self, show: _Show, own: _Joint, frame: int) -> list[Shape]:
        reel, z = show.reel, self._scale.layer
        joint = reel.linkage.clearances[own.number]
        row = reel.film.joints[frame, own.number]
        worn = reel.surfaces[own.number].pin
        turned = surfaces_angle(joint, own.angles[frame, 1])
        paint = JOINTS[own.number % len(JOINTS)]
        way = own.eccentricity[max(frame - PATH_FRAMES, 0) : frame + 1]
        return [
            *play_shapes(own.centre, joint, own.factor, z(85)),
            *path_shapes(own.centre, way, own.factor, z(86), paint),
            *contact_shapes(
                own.centre, joint, worn, turned, own.eccentricity[frame], row, own.factor, z(88)
            ),
        ]

    def _joint_words(
        self, show: _Show, own: _Joint, frame: int, peak: float
    ) -> list[dict[str, Any]]:
        font, z = self._scale.font, self._scale.layer(95)
        row = show.reel.film.joints[frame, own.number]
        name = show.reel.linkage.clearances[own.number].name
        corner = own.centre + [-1.45 * own.factor.radius, 1.13 * own.factor.radius]
        paint = JOINTS[own.number % len(JOINTS)]
        words = [text(corner, joint_words(name, row, peak), z, font, paint)]
        for i, factor in enumerate(own.factor.words()):
            below = own.centre - [1.45 * own.factor.radius, 1.13 * own.factor.radius]
            below = below - [0.0, i * self._line(0.8)]
            words.append(text(below, factor, z, 0.75 * font, INK))
        return words

    def _line(self, size: float) -> float:
        """Height of a line of words of a part of the common size, m."""
        return 1.5 * size * _FONT / 640.0 * self.layout.height

    def _title(self, show: _Show, frame: int, note: str) -> list[dict[str, Any]]:
        reel, font, z = show.reel, self._scale.font, self._scale.layer(95)
        turned = np.degrees(reel.angle(frame))
        state = (
            f"t = {reel.film.time[frame]:.4f} s   crank {turned % 360.0:5.1f} deg "
            f"of cycle {int(turned // 360.0) + 1}"
        )
        below = show.panel.title - [0.0, self._line(1.2)]
        return [
            text(show.panel.title, f"{reel.title}, {reel.stage}", z, 1.15 * font, INK),
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
