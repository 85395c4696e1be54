"""Sentences and tables of final motions."""

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from presswear.analysis.final_motions import FinalMotion, FinalMotions, FinalMotionsAt
from presswear.analysis.kicks import DIRECTIONS, STATES
from presswear.recording.statistics import STARTUP_CYCLES, Estimate
from presswear.results.export import write_rows
from presswear.tools.numbers import quantity_text, readable, whole

Row = dict[str, Any]  # cells of a table by the heads of their columns, with units


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
        share = _percent(motion.share)
        first = [name, whole(motion.starts), share, whole(motion.period)]
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


def write_tables(result: FinalMotions, folder: Path) -> list[Path]:
    """Write the tables of a result into a folder, in SI units; return the files."""
    tables = {
        "starts.csv": _start_rows,
        "motions.csv": _motion_rows,
        "half-life.csv": _half_life_rows,
        "kicks.csv": _kick_rows,
    }
    files = []
    for name, rows_of in tables.items():
        rows = []
        for settled in result.values:
            first = _parameter_of(result, settled)
            rows += [first | row for row in rows_of(settled)]
        write_rows(folder / name, rows)
        files.append(folder / name)
    return files


def _parameter_of(result: FinalMotions, settled: FinalMotionsAt) -> Row:
    """Return the value of the parameter by its name and unit; empty without a parameter."""
    parameter = result.parameter
    if parameter is None:
        return {}
    unit = f" ({parameter.unit})" if parameter.unit else ""
    return {f"{parameter.key}{unit}": settled.value}


def _start_rows(settled: FinalMotionsAt) -> Iterator[Row]:
    motion_of: dict[int, int] = {}  # number of the motion by index of the run
    for number, motion in enumerate(settled.motions, 1):
        motion_of |= dict.fromkeys(motion.runs, number)
    for k, run in enumerate(settled.runs):
        has_settled = run.settled >= 0
        row: Row = {
            "start": run.index,
            "motion": motion_of.get(k, "failed"),
            "cycles": run.cycles,
            "settled after (cycles)": run.settled if has_settled else None,
            "period (cycles)": run.period if has_settled else None,
        }
        for joint, name in enumerate(settled.joints):
            for quantity, unit in (("eccentricity", "m"), ("velocity", "m/s")):
                for axis, value in zip("xy", run[quantity][joint], strict=True):
                    row[f"{name}_{quantity}_{axis} ({unit})"] = value
            row[f"{name}_peak_force (N)"] = run.peak_force[joint]
            row[f"{name}_contacts"] = run.contacts[joint]
        yield row


def _motion_rows(settled: FinalMotionsAt) -> Iterator[Row]:
    for number, motion in enumerate(settled.motions, 1):
        row: Row = {
            "motion": number,
            "starts": motion.starts,
            "share": motion.share.mean,
            "share_low": motion.share.low,
            "share_high": motion.share.high,
            "period (cycles)": motion.period or "irregular",
        }
        for name in settled.joints:
            row[f"{name}_peak_force (N)"] = motion.peak_force[name]
            row[f"{name}_contacts"] = motion.contacts[name]
        least = motion.least_kick
        yield row | {"least kick (m/s)": least and least.rattles}


def _half_life_rows(settled: FinalMotionsAt) -> Iterator[Row]:
    life = settled.half_life
    yield {
        "starts": len(settled.runs),
        "settled": settled.counted - settled.irregular,
        "irregular": settled.irregular,
        "failed": settled.failed,
        "half_life (cycles)": life and life.mean,
        "half_life_low (cycles)": life.low if life else settled.least_half_life,
        "half_life_high (cycles)": life and life.high,
    }


def _kick_rows(settled: FinalMotionsAt) -> Iterator[Row]:
    for number, motion in enumerate(settled.motions, 1):
        for kick in motion.kicks or ():
            yield {
                "motion": number,
                "joint": kick.joint,
                "rattles (m/s)": kick.rattles,
                "returns (m/s)": kick.returns,
                "direction from the axis of the body of the bearing (deg)": kick.direction,
            }
