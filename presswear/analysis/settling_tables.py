"""Sentences and tables of final motions."""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from presswear.analysis.final_motions import FinalMotion, FinalMotions, FinalMotionsAt
from presswear.analysis.kicks import DIRECTIONS, STATES
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.tools.files import write_bytes
from presswear.tools.numbers import quantity_text, readable, whole

# Headings of the columns with units, and the rows
Table = tuple[Sequence[str], list[list[object]]]


def summary(result: FinalMotions, settled: FinalMotionsAt) -> list[str]:
    """Return sentences on the final motions at one value of the parameter."""
    sentences = [_starts_sentence(settled, result.watch.cycles)]
    if settled.half_life is not None:
        sentences.append(
            f"The irregular motion{_peak(settled.irregular_force)} has a half-life of "
            f"{settled.half_life} cycles."
        )
    for number, motion in enumerate(settled.motions, 1):
        if motion.kicks is not None:
            sentences.append(_kicks_sentence(result, number, motion))
    if settled.failed:
        sentences.append(f"{whole(settled.failed)} runs failed and are not counted.")
    if result.parameter is None or settled.value is None:
        return sentences
    value = quantity_text(settled.value, result.parameter.unit)
    return [f"{result.parameter.key} = {value}: {sentences[0]}", *sentences[1:]]


def _starts_sentence(settled: FinalMotionsAt, cycles: int) -> str:
    """Return a sentence on the number of starts that settled, and on their motions."""
    settled_count = settled.counted - settled.irregular
    if settled_count == 0:
        return _unsettled_sentence(settled, cycles)
    counts = f"{whole(settled_count)} of {whole(settled.counted)} starts"
    regular = [motion for motion in settled.motions if motion.period is not None]
    if len(regular) == 1:
        motions = f"the same motion{_peak(regular[0].peak_force)}"
    else:
        motions = f"{len(regular)} different motions"
    settling = settled.runs.settled[settled.runs.settled >= 0]
    range_text = f"{whole(settling.min())} to {whole(settling.max())} cycles"
    sentence = f"{counts} came to rest on {motions} after {range_text}"
    if settled.irregular:
        count = whole(settled.irregular)
        sentence += f", {count} did not settle in {whole(cycles)} cycles"
    elif (settling <= STARTUP_CYCLES).all():
        sentence += "; there is no irregular motion"
    return f"{sentence}."


def _unsettled_sentence(settled: FinalMotionsAt, cycles: int) -> str:
    """Return a sentence on starts of which none has settled."""
    counts = f"none of {whole(settled.counted)} starts"
    sentence = f"{counts} settled in {whole(cycles)} cycles"
    if not settled.least_half_life:
        return f"{sentence}."
    half_life = readable(settled.least_half_life, 2)
    return f"{sentence}: half-life longer than {half_life} cycles at 95 %."


def _peak(forces: Mapping[str, float]) -> str:
    """Return the largest of the peak forces as a text in brackets, or an empty text."""
    finite = {joint: force for joint, force in forces.items() if math.isfinite(force)}
    if not finite:
        return ""
    joint = max(finite, key=finite.__getitem__)
    return f" (mean peak force {readable(finite[joint], 4)} N at {joint})"


def _kicks_sentence(result: FinalMotions, number: int, motion: FinalMotion) -> str:
    """Return a sentence on the least kick of a motion."""
    if not motion.kicks:
        return f"Motion {number} does not return after a restart without a kick."
    least = motion.least_kick
    trials = f"from {STATES} states of the motion in {len(DIRECTIONS)} directions"
    if least is None:
        speed = readable(min(kick.returns for kick in motion.kicks))
        return f"Motion {number} returns after kicks of {speed} m/s, {trials}."
    linkage = result.scene.linkage()
    body = {joint.name: joint.bearing.body for joint in linkage.clearances}
    return (
        f"Motion {number} rattles again after a kick of {readable(least.rattles)} m/s at "
        f"{least.joint}, {least.direction} degrees from the axis of {body[least.joint]}. "
        f"It returns after {readable(least.returns)} m/s, {trials}; other weak kicks may rattle."
    )


def motion_rows(settled: FinalMotionsAt) -> tuple[list[str], list[list[str]]]:
    """Return headings and rows of the table of final motions for a terminal."""
    heads = [">motion", ">starts", ">share (%)", ">period"]
    heads += [">joint", ">peak (N)", ">contacts"]
    rows = []
    for number, motion in enumerate(settled.motions, 1):
        name = "irregular" if motion.period is None else f"{number}"
        first = [
            name,
            whole(motion.starts),
            _percent(motion.share),
            whole(motion.period),
        ]
        for joint in settled.joints:
            force = motion.peak_force[joint]
            count = motion.contacts[joint]
            rows.append([*first, joint, readable(force, 4), readable(count, 2)])
            first = [""] * len(first)
    return heads, rows


def _percent(share: Estimate) -> str:
    low = 100.0 * (share.low or 0.0)
    high = 100.0 * (share.high or 0.0)
    return f"{100.0 * share.mean:.0f} ({low:.0f} to {high:.0f})"


def tables(result: FinalMotions) -> dict[str, Table]:
    """Return the tables of a result by the names of their files; SI units."""
    parameter = result.parameter
    joints = result.scene.clearance_joints
    first = [] if parameter is None else [_named(parameter.key, parameter.unit)]
    return {
        "starts.csv": ([*first, *_start_heads(joints)], _start_rows(result)),
        "motions.csv": ([*first, *_motion_heads(joints)], _motion_rows(result)),
        "half-life.csv": ([*first, *_HALF_LIFE], _half_life_rows(result)),
        "kicks.csv": ([*first, *_KICKS], _kick_rows(result)),
    }


_HALF_LIFE = (
    "starts",
    "settled",
    "irregular",
    "failed",
    "half_life (cycles)",
    "half_life_low (cycles)",
    "half_life_high (cycles)",
)
_KICKS = (
    "motion",
    "joint",
    "rattles (m/s)",
    "returns (m/s)",
    "direction from the axis of the body of the bearing (deg)",
)


def _named(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


def _values(result: FinalMotions) -> Iterable[tuple[list[object], FinalMotionsAt]]:
    """Yield the first cells of the rows, with the value of the parameter, and the motions."""
    for settled in result.values:
        yield ([] if result.parameter is None else [settled.value]), settled


def _start_heads(joints: Sequence[str]) -> list[str]:
    heads = ["start", "motion", "cycles", "settled after (cycles)", "period (cycles)"]
    for joint in joints:
        heads += [f"{joint}_eccentricity_{axis} (m)" for axis in "xy"]
        heads += [f"{joint}_velocity_{axis} (m/s)" for axis in "xy"]
        heads += [f"{joint}_peak_force (N)", f"{joint}_contacts"]
    return heads


def _start_rows(result: FinalMotions) -> list[list[object]]:
    rows = []
    for first, settled in _values(result):
        motion_of: dict[int, int] = {}  # number of the motion by index of the run
        for number, motion in enumerate(settled.motions, 1):
            for index in motion.runs:
                motion_of[index] = number
        for k, run in enumerate(settled.runs):
            row = [*first, int(run.index), motion_of.get(k, "failed"), int(run.cycles)]
            if run.settled >= 0:
                row += [int(run.settled), int(run.period)]
            else:
                row += ["", ""]
            for joint in range(len(settled.joints)):
                row += run.eccentricity[joint].tolist()
                row += run.velocity[joint].tolist()
                row += [float(run.peak_force[joint]), float(run.contacts[joint])]
            rows.append(row)
    return rows


def _motion_heads(joints: Sequence[str]) -> list[str]:
    heads = ["motion", "starts", "share", "share_low", "share_high", "period (cycles)"]
    for joint in joints:
        heads += [f"{joint}_peak_force (N)", f"{joint}_contacts"]
    return [*heads, "least kick (m/s)"]


def _motion_rows(result: FinalMotions) -> list[list[object]]:
    rows = []
    for first, settled in _values(result):
        for number, motion in enumerate(settled.motions, 1):
            share = motion.share
            least = motion.least_kick
            row = [*first, number, motion.starts, share.mean, share.low, share.high]
            row.append("irregular" if motion.period is None else motion.period)
            for joint in settled.joints:
                row += [motion.peak_force[joint], motion.contacts[joint]]
            rows.append([*row, "" if least is None else least.rattles])
    return rows


def _half_life_rows(result: FinalMotions) -> list[list[object]]:
    rows = []
    for first, settled in _values(result):
        count = settled.counted - settled.irregular
        row = [*first, len(settled.runs), count, settled.irregular, settled.failed]
        life = settled.half_life
        if life is not None:
            row += [life.mean, life.low, life.high]
        elif settled.least_half_life is not None:
            row += ["", settled.least_half_life, ""]
        else:
            row += ["", "", ""]
        rows.append(row)
    return rows


def _kick_rows(result: FinalMotions) -> list[list[object]]:
    rows = []
    for first, settled in _values(result):
        for number, motion in enumerate(settled.motions, 1):
            for kick in motion.kicks or ():
                limit = "" if kick.rattles is None else kick.rattles
                rows.append(
                    [*first, number, kick.joint, limit, kick.returns, kick.direction]
                )
    return rows


def write_tables(result: FinalMotions, folder: Path) -> list[Path]:
    """Write the tables of a result into a folder; return the files."""
    files = []
    for name, (heads, rows) in tables(result).items():
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(heads)
        writer.writerows(rows)
        write_bytes(folder / name, text.getvalue().encode())
        files.append(folder / name)
    return files
