"""The head of the report, for who presses parts: what was run, and what the slider does."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from presswear.physics.bottom import bottom_of
from presswear.physics.statics import pull_of
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.drives import DriveDuty, drives_of
from presswear.results.result import Result
from presswear.results.stage import StageResult
from presswear.results.strokes import height_of, process_force, strokes_of
from presswear.results.tonnage import (
    PHASES,
    SNAP_THROUGH,
    SNAP_THROUGH_S,
    WORK,
    Tonnage,
    tonnage_of,
)
from presswear.scene.scene import Scene
from presswear.show.figures.style import length_scale, stage_names
from presswear.show.report.bottom import bottom_between, bottom_mean, risen
from presswear.show.report.moments import degrees
from presswear.show.report.parts import (
    MICRONS,
    MILLI,
    NOTHING,
    Rows,
    Text,
    estimated,
)
from presswear.tools.numbers import given, readable, whole, with_interval

OPENING = ("mechanism.png", "stroke.png", "force-over-stroke.png")
"""Files of the figures that stand in this part, the drawing of the mechanism first."""


@dataclass(frozen=True)
class Fact:
    """A row of the overview: its label, what it means in a sentence, and its text of a stage."""

    label: str
    meaning: str
    text: Text


@dataclass(frozen=True)
class Overview:
    """The table of the overview as the page shows it.

    Attributes
    ----------
    heads : tuple of str
        Stages.
    groups : tuple
        Rows under a heading each: label, meaning, texts.
    """

    heads: tuple[str, ...]
    groups: tuple[tuple[str, tuple[tuple[str, str, tuple[str, ...]], ...]], ...]


def compared(result: Result) -> tuple[StageResult, ...]:
    """The stages that ran soundly, new and worn."""
    return tuple(stage for stage in result.stages if not stage.failed)


def overview(result: Result, loaded: Rows[StageResult]) -> Overview | None:
    """Numbers of the stages that ran soundly; None where none did.

    What is known of no stage is left out.

    Parameters
    ----------
    loaded : Rows
        Of ``under_load``.
    """
    stages = compared(result)
    groups = []
    for heading, facts in _facts(result, loaded).items():
        rows = [(own.label, own.meaning, tuple(map(own.text, stages))) for own in facts]
        rows = [row for row in rows if any(text != NOTHING for text in row[2])]
        if rows:
            groups.append((heading, tuple(rows)))
    if not stages or not groups:
        return None
    return Overview(tuple(stage_names(result, stages)), tuple(groups))


def _facts(result: Result, loaded: Rows[StageResult]) -> dict[str, list[Fact]]:
    """Rows of the overview under their headings."""
    return {
        "Strokes": list(_strokes(result)),
        "Bottom dead centre": [*_bottom(result), *_clearance(result.scene, loaded)],
        "Work": list(_work(result)),
        "Joints": list(_forces(result)),
        "Drives": list(_drives(result)),
    }


def _strokes(result: Result) -> Iterator[Fact]:
    if any(stage.index > 0 for stage in compared(result)):
        yield Fact(
            "strokes that the wear stands for",
            "strokes of production after which the surfaces are as they are taken here",
            lambda stage: whole(_worn_strokes(result, stage)) if stage.index else "0",
        )
    meaning = "those of the computed motion, each a cycle"
    if result.scene.draws > 1:
        meaning += (
            f", of {result.scene.draws} starts together; each start is an "
            "independent run that begins in a slightly different position"
        )
    yield Fact("strokes computed", meaning, lambda stage: whole(stage.cycles))


def _worn_strokes(result: Result, stage: StageResult) -> float:
    earlier = (own for own in result.stages if own.index < stage.index)
    return sum(step.cycles_per_update for own in earlier for step in own.wear_steps)


def _bottom(result: Result) -> Iterator[Fact]:
    if not result.scene.clearance_joints:
        return
    watched = result.scene.watched
    yield Fact(
        "error of bottom dead centre (µm)",
        f"bottom dead centre is the lowest place of the {watched} in a stroke; the error is its "
        "mean height over that of the same linkage without clearance, below zero where it "
        "is deeper",
        bottom_mean("error", MICRONS),
    )
    if len(compared(result)) > 1:
        yield Fact(
            "the same, less that of the first stage (µm)",
            "what wear has moved bottom dead centre by",
            lambda stage: risen(stage, result.stages[0]),
        )
    spread = bottom_between("range", MICRONS)

    def repeated(stage: StageResult) -> str:
        text = spread(stage)
        if text == NOTHING:
            return f"not known from {_counted(stage.bdc.strokes)}"
        return text if "(" in text else f"{text} (too few strokes)"

    yield Fact(
        "repeatability (µm)",
        "from the deepest to the highest bottom dead centre of strokes that follow each other"
        + _in_groups(result),
        lambda stage: repeated(stage) if stage.statistics.bdc else NOTHING,
    )


def _counted(strokes: int) -> str:
    return "1 stroke" if strokes == 1 else f"{strokes} strokes"


def _in_groups(result: Result) -> str:
    counts = dict.fromkeys(
        stage.bdc.range_strokes for stage in compared(result) if stage.statistics.bdc
    )
    told = [_counted(count) for count in counts if count > 1]
    return f", {' or '.join(told)} at a time" if told else ""


def _clearance(scene: Scene, loaded: Rows[StageResult]) -> Iterator[Fact]:
    for text in list(loaded.values())[:1]:
        yield Fact(
            f"total clearance at the {scene.watched} (µm)",
            "how far it gives way at bottom dead centre, drives held, when it is pushed with "
            f"{given(pull_of(scene.linkage()))} N up and down",
            text,
        )


def _work(result: Result) -> Iterator[Fact]:
    process = result.scene.process
    if process is None:
        return
    found = {stage.index: tonnage_of(result.scene, stage) for stage in compared(result)}

    def of(own: Callable[[Tonnage], Estimate | None]) -> Text:
        def text(stage: StageResult) -> str:
            tonnage = found[stage.index]
            told = None if tonnage is None else own(tonnage)
            return NOTHING if told is None else with_interval(told.mean, told.half_width)

        return text

    mean = "mean over the recorded strokes, the first settled ones of one start"
    yield Fact(
        "greatest force of the work in a stroke (N)",
        f"what the work pushes back with, the tonnage; {mean}",
        of(lambda own: own.force_peak_N),
    )
    yield Fact(
        "energy that the work takes in a stroke (J)",
        f"its force summed over the way, without clearance {given(process.work)} J; {mean}",
        of(lambda own: own.work_J),
    )


@dataclass(frozen=True)
class _Peak:
    """The largest joint force in the recorded strokes: where, how much, when."""

    joint: str
    force: float
    angle: float
    place: str


def _forces(result: Result) -> Iterator[Fact]:
    scene = result.scene
    joints = scene.clearance_joints
    if not joints:
        return
    found = {stage.index: _peak(scene, stage) for stage in compared(result)}

    def largest(stage: StageResult) -> str | None:
        known = {name: own.peak_force for name, own in stage.statistics.joints.items()}
        return max(known, key=lambda name: known[name], default=None)

    def over_all(stage: StageResult) -> str:
        name = largest(stage)
        if name is None:
            return NOTHING
        return f"{readable(stage.statistics.joints[name].peak_force)} at {name}"

    def mean(stage: StageResult) -> str:
        name = largest(stage)
        return (
            NOTHING
            if name is None
            else estimated(stage.statistics.joints[name].peak_force_per_cycle)
        )

    def of(own: Callable[[_Peak], str]) -> Text:
        def text(stage: StageResult) -> str:
            peak = found[stage.index]
            return NOTHING if peak is None else own(peak)

        return text

    yield Fact(
        "largest joint force (N)",
        "greatest force of a pin on its bearing in the settled strokes of all starts, and the "
        "joint; strokes are settled behind the first two, where so many ran",
        over_all,
    )
    yield Fact("mean of the largest in each stroke (N)", "at the same joint", mean)
    yield Fact(
        "largest that was recorded (N)",
        "motion and forces are kept of the first strokes of one start only; the next two rows "
        "are of this one",
        of(lambda own: f"{readable(own.force)} at {own.joint}"),
    )
    yield Fact(
        f"its {scene.mechanism.linkage().phase} (degrees)",
        "counted from where the run starts, as in the figures; a cycle has 360",
        of(lambda own: f"{own.angle:.1f}"),
    )
    meaning = f"height of the {scene.watched} over bottom dead centre, and which way it goes"
    if scene.process is not None:
        meaning += f"; {PHASES[WORK]}: while it is in the work"
    if getattr(scene.process, "fracture", None) is not None:
        span = given(MILLI * SNAP_THROUGH_S)
        meaning += f", {PHASES[SNAP_THROUGH]}: in the {span} ms after that breaks"
    yield Fact("its place in the stroke", meaning, of(lambda own: own.place or NOTHING))


def _peak(scene: Scene, stage: StageResult) -> _Peak | None:
    time, period = stage.time, scene.mechanism.period
    if time.size < 2 or not stage.has_joint_series:
        return None
    # The same cycles as in the statistics.
    cycles = int((float(time[-1]) - scene.run_up) / period + 1e-3)
    begin = scene.run_up + period * max(min(STARTUP_CYCLES, cycles - 1), 0)
    rows = np.flatnonzero(time >= begin - 1e-9 * period)
    forces = {name: own.force[rows, 0] for name, own in stage.joints.items()}
    if not rows.size or not any(np.any(own > 0.0) for own in forces.values()):
        return None
    joint = max(forces, key=lambda name: float(forces[name].max()))
    row = int(rows[forces[joint].argmax()])
    place = ""
    if bottom_of(scene.ideal) is not None:
        height = height_of(scene, stage)
        factor, unit = length_scale(scene.stroke)
        falls = height[min(row + 1, time.size - 1)] < height[max(row - 1, 0)]
        place = f"{readable(factor * float(height[row]))} {unit}, going {'down' if falls else 'up'}"
        place += _phase(scene, stage, row)
    angle = float(degrees(scene, time[row : row + 1])[0])
    return _Peak(joint, float(forces[joint].max()), angle, place)


def _phase(scene: Scene, stage: StageResult, row: int) -> str:
    """Phase of the stroke on the work at a row of the series, in brackets; or nothing."""
    strokes, force, now = strokes_of(scene, stage), process_force(scene, stage), stage.time[row]
    if strokes is None or force is None:
        return ""
    for contact, fracture in zip(strokes.contact[:, 0], strokes.fracture[:, 0], strict=True):
        is_in = force[row] > 0.0 if np.isnan(fracture) else now < fracture
        if contact <= now and is_in:
            return f" ({PHASES[WORK]})"
        if fracture <= now < fracture + SNAP_THROUGH_S:
            return f" ({PHASES[SNAP_THROUGH]})"
    return ""


def _drives(result: Result) -> Iterator[Fact]:
    if result.scene.has_untrusted_loads:
        return
    found = {stage.index: drives_of(result.scene, stage) for stage in compared(result)}

    def of(body: str, own: Callable[[DriveDuty], float]) -> Text:
        def text(stage: StageResult) -> str:
            told = found[stage.index].get(body)
            if told is None:
                return NOTHING
            return f"{readable(own(told.duty))} (ideal {readable(own(told.ideal))})"

        return text

    for drive in result.scene.mechanism.linkage().drives:
        body = drive.body
        yield Fact(
            f"{body}: largest torque (N m)",
            "farthest from zero, counterclockwise above zero; in brackets that of the same linkage "
            "without clearance",
            of(body, lambda own: own.torque.peak),
        )
        yield Fact(
            f"{body}: rms torque (N m)",
            "root of the mean square, by which a motor gets warm",
            of(body, lambda own: own.torque.rms),
        )
        yield Fact(
            f"{body}: energy given in a cycle (J)",
            "what it puts into the linkage; some of it may come back",
            of(body, lambda own: own.given_J),
        )
        yield Fact(
            f"{body}: energy taken back (J)", "in a cycle", of(body, lambda own: own.returned_J)
        )


def in_short(result: Result) -> list[str]:
    """Sentences that say what the mechanism does, and the words of the table."""
    scene, stages = result.scene, compared(result)
    period = scene.mechanism.period
    if bottom_of(scene.ideal) is None:
        found = [
            f"The {scene.watched} stands still where no joint has clearance: it makes no strokes."
        ]
    else:
        factor, unit = length_scale(scene.stroke)
        found = [
            f"The {scene.watched} moves between its lowest and its highest place, "
            f"{readable(factor * scene.stroke)} {unit} apart, in every cycle; a cycle is a stroke, "
            f"{readable(60.0 / period)} of them a minute. Up is "
            "along the thick arrow of the drawing."
        ]
    if scene.process is not None:
        factor, unit = length_scale(scene.process.height)
        force = getattr(scene.process, "force", None)
        how = "" if force is None else f", with up to {readable(force)} N"
        found.append(
            f"It presses on work ({scene.process.kind}{how}), which it touches "
            f"{readable(factor * scene.process.height)} {unit} over bottom dead centre."
        )
    if scene.clearance_joints:
        gaps = ", ".join(
            f"{readable(MILLI * scene.bearing(name).clearance)} mm at {name}"
            for name in scene.clearance_joints
        )
        found.append(
            "A clearance is the play of a pin in its bearing, how far its centre can move from "
            f"the middle: {gaps}."
        )
    else:
        found.append(
            "No joint has clearance, so that its bottom dead centre is the ideal one; forces of "
            "joints are told where one has."
        )
    if any(stage.index > 0 for stage in stages):
        found.append(
            "A stage is the linkage on its surfaces at one time in its life; a wear takes "
            "material off all of them and leads to the next stage."
        )
    failed = [stage.name for stage in result.stages if stage.failed]
    if failed:
        found.append(f"Not told here, since it failed: {', '.join(failed)}.")
    untrusted = [key for key, law in scene.user_laws.items() if not law.is_trusted]
    if untrusted:
        found.append(
            f"Python source code is stored for {', '.join(untrusted)}. A report does not execute "
            "it, so numbers that need it are left out: heights at rest under a load for a law of a "
            "joint, torques of the drives for a law of a load."
        )
    has_torques = scene.has_untrusted_loads or any(drives_of(scene, stage) for stage in stages)
    if stages and not has_torques:
        found.append("Torques of the drives were not stored; drive_torque = on stores them.")
    found.append(
        "± is half the width of a 95 % interval, and what stands in brackets its ends; a number "
        "from too few strokes for one says so."
    )
    return found
