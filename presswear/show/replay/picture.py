"""The picture: an Exudyn system that holds nothing but what is seen.

Bodies, bearings and pins are rigid bodies whose coordinates are those that were stored;
what changes its shape (forces, paths, words) is drawn anew for every frame.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from presswear.linkage.linkage import Linkage
from presswear.linkage.motions import run_up_motion
from presswear.show.replay.bodies import (
    INK,
    JOINTS,
    STEEL,
    Scale,
    body_graphics,
    extent,
    frame_graphics,
)
from presswear.show.replay.joints import BODIES, FORCE, EnlargedJoint
from presswear.show.replay.layout import Layout, Panel, layout_of
from presswear.show.replay.reel import NORMAL, Instant, Subject, points_of
from presswear.show.replay.shapes import Shape, graphics, line, text
from presswear.tools.exudyn import exudyn_module

Array = NDArray[np.float64]

exu = exudyn_module()

_AWAY = 10.0
"""Place of the joints of a stage that is not shown, heights of the picture: out of sight."""
_FONT = 13.0
"""Letters in a window 640 pixels high, pixels."""


@dataclass(frozen=True)
class _Show:
    """A subject in its panel, with the joints of each stage that it shows."""

    subject: Subject
    panel: Panel
    joints: tuple[tuple[EnlargedJoint, ...], ...]


class Picture:
    """Subjects side by side, as the renderer shows them.

    Parameters
    ----------
    subjects : sequence of Subject
    size : tuple of int
        Width and height, pixels.
    """

    def __init__(self, subjects: Sequence[Subject], size: tuple[int, int]) -> None:
        boxes = [extent(subject.linkage, subject.motion) for subject in subjects]
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
        for own in chain(*show.joints):
            for shapes in own.bodies(scale.layer):
                self._add_body(own.centre, [graphics(shapes)])

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
        origin = [0.0, 0.0, 0.0]
        self.container.renderer.SetModelView(0.5 * self.layout.height, origin, origin)

    def set(self, instants: Sequence[Instant], part: float, note: str) -> None:
        """Set the renderer's state to an instant of each subject.

        Parameters
        ----------
        part : float
            Place of that moment in all that is played, 0 .. 1.
        note : str
            Words on how it is played.
        """
        coordinates, ink, words = [], self._bar(part), []
        for show, instant in zip(self._shows, instants, strict=True):
            coordinates.append(instant.past[-1])
            words += self._title(show, instant, note)
            ink += self._springs(show, instant)
            for chapter, joints in enumerate(show.joints):
                if chapter != instant.chapter:
                    away = np.array([_AWAY * self.layout.height, 0.0, 0.0])
                    coordinates += [away] * (BODIES * len(joints))
                    continue
                for own, row, peak in zip(joints, instant.joints, instant.peaks, strict=True):
                    bearing, pin = (
                        points_of(show.subject.linkage, instant.past, end)
                        for end in (own.joint.bearing, own.joint.pin)
                    )
                    coordinates += own.coordinates(bearing[-1], pin[-1])
                    ink += own.moving(bearing, pin, row, self._scale.layer)
                    words += self._joint_words(own, row, peak)
        self._place(np.concatenate(coordinates), instants[0].time)
        self.system.SetObjectParameter(self._ink, "VgraphicsData", [graphics(ink), *words])

    def _springs(self, show: _Show, instant: Instant) -> list[Shape]:
        """A line from end to end of each spring."""
        linkage, shapes = show.subject.linkage, []
        for spring in linkage.springs:
            one, other = (
                points_of(linkage, instant.past[-1:], end)[0, :2] + show.panel.offset
                for end in spring.ends
            )
            shapes.append(line(one, other, 0.5 * self._scale.bar, self._scale.layer(38), STEEL))
        return shapes

    def _place(self, coordinates: Array, time: float) -> None:
        data = self.system.systemData
        for kind in (exu.ConfigurationType.Current, exu.ConfigurationType.Visualization):
            data.SetODE2Coordinates(coordinates, kind)
            data.SetTime(time, kind)

    def _joint_words(self, own: EnlargedJoint, row: Array, peak: float) -> list[dict[str, Any]]:
        font, z = self._scale.font, self._scale.layer(95)
        above = own.centre + np.array([-1.45, 1.13]) * own.radius
        below = own.centre + np.array([-1.45, -1.19]) * own.radius
        # Both of the normal force: a peak of one beside a value of the other would lie below it.
        force = f"normal {row[NORMAL]:.0f} N, peak {peak:.0f} N"
        words = [text(above, f"{own.joint.name}: {force}", z, font, own.paint)]
        for i, factor in enumerate(own.words()):
            words.append(text(below - [0.0, i * self._line(0.8)], factor, z, 0.75 * font, INK))
        return words

    def _line(self, size: float) -> float:
        """Height of a line of words of a part of the common size, m."""
        return 1.5 * size * _FONT / 640.0 * self.layout.height

    def _title(self, show: _Show, instant: Instant, note: str) -> list[dict[str, Any]]:
        subject, font, z = show.subject, self._scale.font, self._scale.layer(95)
        followed = run_up_motion(np.array(instant.time), subject.linkage.run_up_time)[0]
        turned = 360.0 * float(followed) / subject.period
        state = f"{subject.linkage.phase} {turned % 360.0:5.1f} deg"
        if not subject.later:
            # Cycles of a life are of different stages: no time runs through them.
            cycle = int(turned // 360.0) + 1
            state = f"t = {instant.time:.4f} s   {state} of cycle {cycle}"
        stage = subject.chapters[instant.chapter].stage
        below = show.panel.title - [0.0, self._line(1.2)]
        return [
            text(show.panel.title, f"{subject.title}, {stage}", z, 1.15 * font, INK),
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


def _show(subject: Subject, panel: Panel) -> _Show:
    chapters = tuple(_joints(subject, panel, own.linkage) for own in subject.chapters)
    return _Show(subject, panel, chapters)


def _joints(subject: Subject, panel: Panel, linkage: Linkage) -> tuple[EnlargedJoint, ...]:
    joints = []
    for k, (joint, centre) in enumerate(zip(linkage.clearances, panel.joints, strict=True)):
        room = subject.deepest[joint.name], subject.largest[joint.name]
        joints.append(EnlargedJoint(joint, *room, centre, panel.radius, JOINTS[k % len(JOINTS)]))
    return tuple(joints)
