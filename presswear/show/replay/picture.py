"""Pictures of clips: an Exudyn system that contains only what is visible.

Bodies, bearings and pins are rigid bodies with the stored coordinates. Shapes that change (forces,
paths, text) are replaced in every picture.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.drives import run_up_motion
from presswear.linkage.linkage import Linkage
from presswear.show.replay.clip import NORMAL, Clip, Snapshot, points_of
from presswear.show.replay.mechanism import (
    BODIES_PER_JOINT,
    FORCE,
    INK,
    JOINT_COLOURS,
    STEEL,
    EnlargedJoint,
    Scale,
    body_graphics,
    bounding_box,
    frame_graphics,
)
from presswear.show.replay.shapes import Shape, exu, graphics, line, text

Array = NDArray[np.float64]

HEAD, FOOT, MARGIN = 0.11, 0.09, 0.02  # title, time bar and margin over the height of the picture
HIDDEN = 10.0  # position of the joints of a hidden stage over the height of the picture
FONT = 13.0  # letters in a picture of 640 pixels height, pixels


@dataclass(frozen=True)
class Panel:
    """Positions of one clip in the plane of the picture, m: origin, title and enlarged joints."""

    offset: Array
    title: Array
    joints: tuple[Array, ...]
    radius: float


@dataclass(frozen=True)
class Layout:
    """Picture with its centre at the origin: height, panels and ends of the time bar, m."""

    height: float
    panels: tuple[Panel, ...]
    bar: tuple[Array, Array]


def layout_of(boxes: Sequence[tuple[Array, Array]], joints: Sequence[int], aspect: float) -> Layout:
    """Arrange clips side by side in a picture of an aspect, width over height.

    Boxes are the corners, m, between which each mechanism moves; ``joints`` are the numbers of
    enlarged joints.
    """
    # All lengths except those of the boxes are relative to the height of the picture.
    width = aspect / len(boxes)
    inside, usable = width - 2.0 * MARGIN, 1.0 - HEAD - FOOT
    count = max(joints)
    is_column = len(boxes) == 1  # joints beside the mechanism, otherwise below it
    if count == 0:
        room, radius = np.array([inside, usable]), 0.0
    elif is_column:
        radius = min(0.34 * usable / count, 0.15 * width)
        room = np.array([inside - 3.4 * radius, usable])
    else:
        radius = min(0.13 * usable * 1.6, 0.36 * inside / count)
        room = np.array([inside, usable - 3.1 * radius])
    height = max(float(((high - low) / room).max()) for low, high in boxes)
    panels = []
    for k, ((low, high), number) in enumerate(zip(boxes, joints, strict=True)):
        left, top = -0.5 * aspect + k * width, 0.5 - HEAD
        steps = (np.arange(number) + 0.5) / max(number, 1)
        x, y = left + MARGIN + inside * steps, np.full(number, -0.5 + FOOT + 1.35 * radius)
        if is_column:
            x, y = np.full(number, left + width - MARGIN - 1.65 * radius), top - usable * steps
        middle = np.array([left + MARGIN, top]) + 0.5 * room * (1.0, -1.0)
        offset = height * middle - 0.5 * (low + high)
        title = height * np.array([left + MARGIN, 0.5 - 0.045])
        panels.append(
            Panel(offset, title, tuple(height * np.column_stack([x, y])), height * radius)
        )
    end = height * np.array([0.5 * aspect - 2.0 * MARGIN, -0.5 + 0.4 * FOOT])
    return Layout(height, tuple(panels), (end * (-1.0, 1.0), end))


def _enlarged_joints(clip: Clip, panel: Panel, linkage: Linkage) -> list[EnlargedJoint]:
    paints = [JOINT_COLOURS[k % len(JOINT_COLOURS)] for k in range(len(panel.joints))]
    return [
        EnlargedJoint(
            joint,
            clip.max_depth[joint.name],
            clip.max_force[joint.name],
            centre,
            panel.radius,
            paint,
        )
        for joint, centre, paint in zip(linkage.clearances, panel.joints, paints, strict=True)
    ]


class Picture:
    """Clips side by side in Exudyn's renderer, in a picture of a width and height in pixels."""

    def __init__(self, clips: Sequence[Clip], size: tuple[int, int]) -> None:
        self.clips = tuple(clips)
        boxes = [bounding_box(clip.linkage, clip.film.position) for clip in clips]
        counts = [len(clip.linkage.clearances) for clip in clips]
        self.layout = layout_of(boxes, counts, size[0] / size[1])
        diagonal = max(float(np.hypot(*(high - low))) for low, high in boxes)
        self._scale = Scale(diagonal, FONT * size[1] / 640.0)
        self._joints: list[list[list[EnlargedJoint]]] = []  # of each chapter of each clip
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        for clip, panel in zip(clips, self.layout.panels, strict=True):
            ground = frame_graphics(clip.linkage, clip.film.position, self._scale)
            self._add_ground([*panel.offset, 0.0], ground)
            for body in clip.linkage.bodies:
                self._add_body(panel.offset, body_graphics(clip.linkage, body.name, self._scale))
            chapters = [_enlarged_joints(clip, panel, each.linkage) for each in clip.chapters]
            self._joints.append(chapters)
            for joint in chain(*chapters):
                for shapes in joint.bodies(self._scale.layer):
                    self._add_body(joint.centre, [graphics(shapes)])
        self._changing = self._add_ground([0.0, 0.0, 0.0], [])
        self.system.Assemble()
        settings: Any = self.container.visualizationSettings
        settings.view0.window.renderWindowSize = list(size)
        settings.view0.window.showComputationInfo = False
        settings.view0.scene.drawCoordinateSystem = False
        settings.nodes.show = False
        settings.openGL.lightModelAmbient = [1.0, 1.0, 1.0, 1.0]  # plain colours
        for number in range(4):
            getattr(settings.openGL, f"light{number}").enable = False
        settings.general.autoFitScene = False
        # Text in front of everything would keep OpenGL from clearing its depth buffer.
        settings.general.textAlwaysInFront = False
        settings.raytracer.multiSampling = 2
        self.container.renderer.ResetState()  # otherwise the view set before an image is lost
        self.set_view()

    def _add_ground(self, position: list[float], drawn: list[dict[str, Any]]) -> Any:
        return self.system.AddObject(
            {"objectType": "Ground", "referencePosition": position, "VgraphicsData": drawn}
        )

    def _add_body(self, origin: Array, drawn: list[dict[str, Any]]) -> None:
        node = self.system.AddNode(
            {"nodeType": "RigidBody2D", "referenceCoordinates": [*origin, 0.0], "Vshow": False}
        )
        body = {"nodeNumber": node, "mass": 1.0, "inertia": 1.0, "VgraphicsData": drawn}
        self.system.AddObject({"objectType": "RigidBody2D", **body})

    def set_view(self) -> None:
        """Point the view at the whole picture; Exudyn's zoom is half of the visible height."""
        origin = [0.0, 0.0, 0.0]
        self.container.renderer.SetModelView(0.5 * self.layout.height, origin, origin)

    def show(self, states: Sequence[Snapshot], part: float, note: str) -> None:
        """Set the renderer to the state of each clip.

        ``part`` is the position of the time bar, 0 to 1; ``note`` is a text on the playing speed.
        """
        coordinates, shapes, words = [], self._time_bar(part), []
        parts = zip(self.clips, self.layout.panels, self._joints, states, strict=True)
        for clip, panel, chapters, state in parts:
            coordinates.append(state.positions[-1])
            words += self._title(clip, panel, state, note)
            for spring in clip.linkage.springs:
                start, end = (
                    points_of(clip.linkage, state.positions[-1:], point)[0, :2] + panel.offset
                    for point in spring.ends
                )
                z = self._scale.layer(38)
                shapes.append(line(start, end, 0.5 * self._scale.bar, z, STEEL))
            for chapter, joints in enumerate(chapters):
                if chapter != state.chapter:
                    hidden = np.array([HIDDEN * self.layout.height, 0.0, 0.0])
                    coordinates += [hidden] * (BODIES_PER_JOINT * len(joints))
                    continue
                for joint, row, peak in zip(joints, state.joints, state.peaks, strict=True):
                    bearing, pin = (
                        points_of(clip.linkage, state.positions, end)
                        for end in (joint.joint.bearing, joint.joint.pin)
                    )
                    coordinates += joint.coordinates(bearing[-1], pin[-1])
                    shapes += joint.moving(bearing, pin, row, self._scale.layer)
                    words += self._joint_text(joint, row, peak)
        data = self.system.systemData
        for kind in (exu.ConfigurationType.Current, exu.ConfigurationType.Visualization):
            data.SetODE2Coordinates(np.concatenate(coordinates), kind)
            data.SetTime(states[0].time, kind)
        drawn = [graphics(shapes), *words]
        self.system.SetObjectParameter(self._changing, "VgraphicsData", drawn)

    def _joint_text(self, joint: EnlargedJoint, row: Array, peak: float) -> list[dict[str, Any]]:
        font, z = self._scale.font, self._scale.layer(95)
        force = f"{joint.joint.name}: normal {row[NORMAL]:.0f} N, peak {peak:.0f} N"
        above, below = (joint.centre + joint.radius * np.array([-1.45, y]) for y in (1.13, -1.19))
        words = [text(above, force, z, font, joint.paint)]
        for k, label in enumerate(joint.labels()):
            point = below - [0.0, k * self._line_height(0.8)]
            words.append(text(point, label, z, 0.75 * font, INK))
        return words

    def _line_height(self, size: float) -> float:
        """Return the height of a line of text, m, from its size relative to the font."""
        return 1.5 * size * FONT / 640.0 * self.layout.height

    def _title(self, clip: Clip, panel: Panel, state: Snapshot, note: str) -> list[dict[str, Any]]:
        font, z = self._scale.font, self._scale.layer(95)
        linkage = clip.linkage
        elapsed = float(run_up_motion(np.array(state.time), linkage.run_up_time)[0])
        angle = 360.0 * elapsed / clip.period
        status = f"{linkage.phase} {angle % 360.0:5.1f} deg"
        if len(clip.chapters) == 1:  # the cycles of a service life have no common time
            cycle = int(angle // 360.0) + 1
            status = f"t = {state.time:.4f} s   {status} of cycle {cycle}"
        title = f"{clip.title}, {clip.chapters[state.chapter].stage}"
        below = panel.title - [0.0, self._line_height(1.2)]
        return [
            text(panel.title, title, z, 1.15 * font, INK),
            text(below, f"{status}   {note}", z, font, INK),
        ]

    def _time_bar(self, part: float) -> list[Shape]:
        start, end = self.layout.bar
        width, layer = 0.006 * self.layout.height, self._scale.layer
        now = start + part * (end - start)
        mark = np.array([0.0, 1.6 * width])
        return [
            line(start, end, width, layer(90), STEEL),
            line(start, now, width, layer(91), INK),
            line(now - mark, now + mark, 1.2 * width, layer(92), FORCE),
        ]

    def image(self) -> NDArray[np.uint8]:
        """Return the picture, ray-traced without a display; shape (height, width, 3)."""
        pixels: NDArray[np.uint8] = self.container.renderer.RedrawAndGetImage(True)
        return pixels

    def close(self) -> None:
        """Release the container."""
        self.container.Reset()
