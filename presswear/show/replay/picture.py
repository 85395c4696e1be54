"""Pictures of clips: an Exudyn system that contains only what is visible.

All shapes belong to one ground object and are replaced in every picture.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND
from presswear.physics.drive_motion import run_up_motion
from presswear.show.replay import shapes
from presswear.show.replay.clip import NORMAL, Clip, Snapshot
from presswear.show.replay.enlarged_joint import EnlargedJoint, force_text
from presswear.show.replay.shapes import FORCE, INK, STEEL, Shape, points_of
from presswear.tools.arrays import Array
from presswear.tools.exudyn import exudyn_module

exu = exudyn_module()
from exudyn.graphics import FromPointsAndTrigs  # noqa: E402  (after the choice of the module)

# Over the height of the picture
HEAD = 0.11  # title
FOOT = 0.09  # time bar
MARGIN = 0.02
FONT = 13.0  # letters in a picture of 640 pixels height, pixels
LETTER_WIDTH = 0.74  # width of a letter over its height


DrawnJoint = tuple[EnlargedJoint, list[list[Shape]]]


class Panel(NamedTuple):
    """Positions of one clip in the plane of the picture, m: origin, title and enlarged joints."""

    offset: Array
    title: Array
    joints: tuple[Array, ...]
    radius: float


class DrawnClip(NamedTuple):
    """Clip with its panel, and the shapes of its bodies, enlarged joints and worn walls."""

    clip: Clip
    panel: Panel
    wall_factor: float  # factor of the wear of walls; 0 without wear
    bodies: list[list[Shape]]
    joints: list[list[DrawnJoint]]  # by chapter
    # by chapter; in each the walls of the frame, then of each body
    walls: list[list[list[Shape]]]


class Layout(NamedTuple):
    """Picture with its centre at the origin: height, panels and ends of the time bar, m."""

    height: float
    panels: tuple[Panel, ...]
    bar: tuple[Array, Array]


def layout_of(
    boxes: Sequence[tuple[Array, Array]], joints: Sequence[int], aspect: float
) -> Layout:
    """Arrange clips side by side, with the enlarged joints of each at its right.

    Boxes are the corners, m, between which each mechanism moves; ``joints`` are the
    numbers of enlarged joints, and the aspect is width over height of the picture.
    """
    # All lengths except those of the boxes are relative to the height of the picture.
    width = aspect / len(boxes)
    usable = 1.0 - HEAD - FOOT
    radius = min(0.34 * usable / max(joints), 0.15 * width) if any(joints) else 0.0
    room = np.array([width - 2.0 * MARGIN - 3.4 * radius, usable])
    sizes = [high - low for low, high in boxes]
    height = max(float((size / room).max()) for size in sizes)
    panels = []
    for k, ((low, high), number) in enumerate(zip(boxes, joints, strict=True)):
        left = -0.5 * aspect + k * width + MARGIN
        top = 0.5 - HEAD
        y = top - usable * (np.arange(number) + 0.5) / max(number, 1)
        x = np.full(number, left + width - 2.0 * MARGIN - 1.65 * radius)
        places = tuple(height * np.column_stack([x, y]))
        middle = np.array([left, top]) + 0.5 * room * (1.0, -1.0)
        offset = height * middle - 0.5 * (low + high)
        title = height * np.array([left, 0.5 - 0.045])
        panels.append(Panel(offset, title, places, height * radius))
    end = height * np.array([0.5 * aspect - 2.0 * MARGIN, -0.5 + 0.4 * FOOT])
    return Layout(height, tuple(panels), (end * (-1.0, 1.0), end))


class Picture:
    """Clips side by side in Exudyn's renderer, in a picture of a width and height in pixels."""

    def __init__(self, clips: Sequence[Clip], size: tuple[int, int]) -> None:
        boxes = [
            shapes.bounding_box(clip.linkage, clip.film.position) for clip in clips
        ]
        counts = [len(shapes.loose_pins(clip.linkage)) for clip in clips]
        self.layout = layout_of(boxes, counts, size[0] / size[1])
        sizes = [high - low for low, high in boxes]
        self._size = max(float(np.hypot(*size)) for size in sizes)  # m
        self._bar = shapes.BAR * self._size
        self._font = FONT * size[1] / 640.0
        self.container = exu.SystemContainer()
        self.system: Any = self.container.AddSystem()
        ground = {"objectType": "Ground", "referencePosition": [0.0, 0.0, 0.0]}
        self._ground = self.system.AddObject({**ground, "VgraphicsData": []})
        self._frame: list[Shape] = []
        self._clips: list[DrawnClip] = []
        for clip, panel in zip(clips, self.layout.panels, strict=True):
            offset = np.append(panel.offset, 0.0)
            frame = shapes.frame_shapes(clip.linkage, clip.film.position, self._bar)
            self._frame += [shapes.moved(shape, offset) for shape in frame]
            self._clips.append(_drawn(clip, panel, self._bar))
        self.system.Assemble()
        self._set_look(size)
        # otherwise the view set before an image is lost
        self.container.renderer.ResetState()
        self.set_view()

    def _set_look(self, size: tuple[int, int]) -> None:
        """Set the size of the picture, plain colours and texts."""
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

    def height(self, layer: int) -> float:
        """Return the height of a layer, m."""
        return layer * shapes.LAYER_STEP * self._size

    def set_view(self) -> None:
        """Point the view at the whole picture; Exudyn's zoom is half of the visible height."""
        origin = [0.0, 0.0, 0.0]
        self.container.renderer.SetModelView(0.5 * self.layout.height, origin, origin)

    def show(self, states: Sequence[Snapshot], fraction: float, note: str) -> None:
        """Set the renderer to the state of each clip.

        ``fraction`` is the position of the time bar, 0 to 1; ``note`` is a text on the
        playing speed.
        """
        pieces = [*self._frame, *self._time_bar(fraction)]
        texts = []
        for drawn, state in zip(self._clips, states, strict=True):
            texts += self._title(drawn, state, note)
            pieces += self._moving_shapes(drawn, state)
            linkage = drawn.clip.linkage
            # Pins are drawn. Corners of slides follow them in a state and are not drawn.
            joints = zip(
                drawn.joints[state.chapter], state.joints, state.peaks, strict=False
            )
            for (joint, bodies), row, peak in joints:
                bearing = points_of(linkage, state.positions, joint.joint.bearing)
                pin = points_of(linkage, state.positions, joint.joint.pin)
                pieces += joint.shapes(bodies, bearing, pin, row)
                texts += self._joint_text(joint, row, peak)
                place = drawn.panel.offset + bearing[-1, :2]
                name = self._text(place, joint.joint.name, 1.4, layer=60)
                texts.append({**name, "offset": [0.8, 0.5]})
        data = [self._triangles(pieces), *texts]
        self.system.SetObjectParameter(self._ground, "VgraphicsData", data)

    def _moving_shapes(self, drawn: DrawnClip, state: Snapshot) -> list[Shape]:
        """Return the bodies, the worn walls and the springs of a clip in a state."""
        offset = np.append(drawn.panel.offset, 0.0)
        frame_walls, *body_walls = drawn.walls[state.chapter]
        pieces = [shapes.moved(shape, offset) for shape in frame_walls]
        poses = state.positions[-1].reshape(-1, 3) + offset
        for body, walls, pose in zip(drawn.bodies, body_walls, poses, strict=True):
            pieces += [shapes.moved(shape, pose) for shape in (*body, *walls)]
        linkage = drawn.clip.linkage
        for spring in linkage.springs:
            ends = [points_of(linkage, state.positions, end) for end in spring.ends]
            start, end = (offset + points[-1] for points in ends)
            pieces.append(shapes.line(start[:2], end[:2], 0.5 * self._bar, 38, STEEL))
        return pieces

    def _triangles(self, pieces: Sequence[Shape]) -> dict[str, Any]:
        """Return shapes as one triangle list of Exudyn."""
        counts = [len(shape.points) for shape in pieces]
        starts = np.cumsum([0, *counts[:-1]])
        heights = np.repeat([self.height(shape.layer) for shape in pieces], counts)
        points = np.column_stack(
            [np.vstack([shape.points for shape in pieces]), heights]
        )
        triangles = [
            shape.triangles + start for shape, start in zip(pieces, starts, strict=True)
        ]
        colours = np.repeat([shape.colour for shape in pieces], counts, axis=0)
        normals = np.tile([0.0, 0.0, 1.0], len(points))
        data: dict[str, Any] = FromPointsAndTrigs(
            points, np.vstack(triangles), colours, normals
        )
        return data

    def _text(
        self,
        point: Array,
        words: str,
        size: float,
        paint: shapes.Colour = INK,
        layer: int = 95,
    ) -> dict[str, Any]:
        """Return a text that starts at a point, with letters of a size relative to the font."""
        position = [float(point[0]), float(point[1]), self.height(layer)]
        line_style = {
            "position": position,
            "color": list(paint),
            "fontSize": size * self._font,
        }
        return {"type": "Text", "text": words, **line_style}

    def _line_height(self, size: float) -> float:
        """Return the height of a line of text, m, from its size relative to the font."""
        return 1.5 * size * FONT / 640.0 * self.layout.height

    def _joint_text(
        self, joint: EnlargedJoint, row: Array, peak: float
    ) -> list[dict[str, Any]]:
        normal = force_text(float(row[NORMAL]))
        force = f"{joint.joint.name}: normal {normal}, peak {force_text(peak)}"
        letter = LETTER_WIDTH * FONT / 640.0 * self.layout.height
        size = min(1.0, 3.0 * joint.radius / (letter * len(force)))
        above = joint.centre + joint.radius * np.array([-1.45, 1.13])
        texts = [self._text(above, force, size, joint.paint)]
        below = joint.centre + joint.radius * np.array([-1.45, -1.19])
        for k, label in enumerate(joint.labels()):
            line = below - [0.0, k * self._line_height(0.8)]
            texts.append(self._text(line, label, 0.75))
        return texts

    def _title(
        self, drawn: DrawnClip, state: Snapshot, note: str
    ) -> list[dict[str, Any]]:
        clip = drawn.clip
        linkage = clip.linkage
        elapsed = state.time
        if linkage.leader is None:
            elapsed = run_up_motion(linkage.run_up_time, elapsed)[0]
        angle = 360.0 * elapsed / clip.period
        status = f"{linkage.phase} {angle % 360.0:5.1f} deg"
        if len(clip.chapters) == 1:  # the cycles of a service life have no common time
            cycle = int(angle // 360.0) + 1
            status = f"{status} of cycle {cycle}"
            if linkage.leader is None:  # a film of a motor has no time of the clock
                status = f"t = {state.time:.4f} s   {status}"
        title = f"{clip.title}, {clip.chapters[state.chapter].stage}"
        if drawn.wall_factor:
            note = f"{note}   wear of walls x{drawn.wall_factor:.4g}"
        above = drawn.panel.title
        below = above - [0.0, self._line_height(1.2)]
        return [
            self._text(above, title, 1.15),
            self._text(below, f"{status}   {note}", 1.0),
        ]

    def _time_bar(self, fraction: float) -> list[Shape]:
        start, end = self.layout.bar
        width = 0.006 * self.layout.height
        now = start + fraction * (end - start)
        mark = np.array([0.0, 1.6 * width])
        return [
            shapes.line(start, end, width, 90, STEEL),
            shapes.line(start, now, width, 91, INK),
            shapes.line(now - mark, now + mark, 1.2 * width, 92, FORCE),
        ]

    def image(self) -> NDArray[np.uint8]:
        """Return the picture, ray-traced without a display; shape (height, width, 3)."""
        pixels: NDArray[np.uint8] = self.container.renderer.RedrawAndGetImage(True)
        return pixels

    def close(self) -> None:
        """Release the container."""
        self.container.Reset()


def _drawn(clip: Clip, panel: Panel, bar: float) -> DrawnClip:
    """Return a clip with its shapes; ``bar`` is half the width of a bar, m."""
    linkage = clip.linkage
    depths = [clip.max_depth[corner.name] for corner in linkage.corners]
    factor = shapes.wall_factor(max(depths, default=0.0), bar)
    positions = clip.film.position
    bodies = []
    for k in range(len(linkage.bodies)):
        bodies.append(shapes.body_shapes(linkage, positions, k, bar))
    names = [GROUND, *(body.name for body in linkage.bodies)]
    joints = []
    walls = []
    for chapter in clip.chapters:
        worn = chapter.linkage
        joints.append(_enlarged(clip, panel, worn))
        walls.append([shapes.worn_walls(worn, factor, name) for name in names])
    return DrawnClip(clip, panel, factor, bodies, joints, walls)


def _enlarged(clip: Clip, panel: Panel, worn: Linkage) -> list[DrawnJoint]:
    """Return the enlarged pin joints of a linkage with its worn surfaces."""
    joints = []
    pins = shapes.loose_pins(worn)
    for k, (joint, centre) in enumerate(zip(pins, panel.joints, strict=True)):
        enlarged = EnlargedJoint(
            joint,
            clip.max_depth[joint.name],
            clip.max_force[joint.name],
            centre,
            panel.radius,
            paint=shapes.JOINT_COLOURS[k % len(shapes.JOINT_COLOURS)],
        )
        joints.append((enlarged, enlarged.bodies()))
    return joints
