"""Measure what the tolerance of ``dae`` changes in the statistics of cycles, and write the table.

    python docs/_tools/tolerances.py measure FILE [SCENE ...]
    python docs/_tools/tolerances.py fill FILE

The motion is chaotic, so that two tolerances give two samples of it. Replicates with
the same seeds run at each tolerance. Their mean is compared with the mean at the
reference, DOP853 at 1e-9. Each comparison has the 95 % interval of the difference of
two independent means. The step error is the error of the load distance in short pieces
of runs. A piece is repeated with a hundredth of the tolerance, and ends before the
motions diverge.
"""

import argparse
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import presswear as pw
from presswear.campaign.campaign import run_stage
from presswear.campaign.replicates import StepCheck, linkage_on, start_of
from presswear.campaign.wear_update import cycles_of_update
from presswear.engines.base import Plan, Run
from presswear.engines.settings import InHouse, Integrator
from presswear.recording.statistics import half_width, mean_map, quantile
from presswear.tools.arrays import Array

DOCS = Path(__file__).parents[1]
PAGE = DOCS / "theory" / "integration.md"
KINDS = {  # beginnings of the names of quantities, and headings
    "load distance": "load distance (N m; %)",
    "peak force": "peak force (N; %)",
    "contacts": "contacts (%)",
    "acceleration": "acceleration (m/s²; %)",
}
HEADS = (
    "scene",
    "method",
    "runs that fail",
    "CPU (ms a cycle)",
    "energy residual",
    "step error",
    *KINDS.values(),
)
FIRST = 10  # cycles of each run that are left out: the pins fall on their bearings
CHECKS = 4  # pieces of runs in the mean of the step error


class Setting(NamedTuple):
    """Integrator, its tolerance, and the fewest steps in a free impact."""

    integrator: Integrator
    tolerance: float
    impact_steps: int

    @property
    def name(self) -> str:
        """Name in the stored file."""
        return f"{self.integrator} {self.tolerance:g} {self.impact_steps}"


REFERENCE = Setting("dop853", 1e-9, 15)
SETTINGS = (
    *(Setting("dopri5", tolerance, 8) for tolerance in (1e-4, 1e-5, 3e-6, 1e-6)),
    *(Setting("dopri5", tolerance, 15) for tolerance in (1e-6, 1e-7)),
    REFERENCE,
)


@dataclass(frozen=True)
class Subject:
    """Scene in which the tolerances are compared."""

    scene: pw.Scene
    cycles: int  # of each replicate, after the ``FIRST`` cycles
    replicates: int = 64
    is_worn: bool = False


def subjects() -> dict[str, Subject]:
    """Return the scenes by their names in the table."""
    settings: dict[str, Any] = {"engine": "dae", "wear_updates": 0, "seed": 1}
    four_bar = pw.Scene(pw.FourBar(), bearings=pw.Bearing(clearance=0.8e-3), **settings)
    refined = pw.scenes.wear_times(conventions="refined", **settings)
    real = pw.scene_from(DOCS.parent / "scenarios" / "press-250kN.toml")
    prescribed = {"motor": "none", "servo": "none", "frame_stiffness": "none"}
    return {
        "press": Subject(pw.scenes.wear_times(**settings), 40),
        "slider-crank": Subject(pw.scenes.slider_crank(**settings), 40),
        "four-bar": Subject(four_bar, 40),
        "press of 250 kN": Subject(pw.changed(real, prescribed | settings), 20, 32),
        "press, worn": Subject(refined, 12, 24, is_worn=True),
        "four-bar, worn": Subject(four_bar, 24, 24, is_worn=True),
    }


@cache
def worn_depth(scene: pw.Scene) -> Array:
    """Return the depth of the surfaces after one wear update, m, (joints, 2, bins)."""
    scene = replace(scene, wear_updates=1, cycles=12, replicates=4)
    stage, ensemble = run_stage(scene)
    if stage.failed:
        raise pw.RunFailed(stage.message)
    return cycles_of_update(scene, ensemble) * mean_map(ensemble.maps)


def depth_of(subject: Subject) -> Array:
    """Return the depth of the surfaces on which a subject runs, m, (joints, 2, bins)."""
    depth = worn_depth(subject.scene)
    return depth if subject.is_worn else np.zeros_like(depth)


def means_of(run: Run, joints: Sequence[str]) -> dict[str, float]:
    """Return the means over the cycles of a run after the ``FIRST`` cycles."""
    recorder = run.recorder
    columns = {"acceleration": recorder.each_cycle("acceleration_max")}
    for k, joint in enumerate(joints):
        columns[f"load distance {joint}"] = recorder.each_cycle("load_distance", k)
        columns[f"peak force {joint}"] = recorder.each_cycle("force_max", k)
        columns[f"contacts {joint}"] = recorder.each_cycle("contacts", k)
    return {name: float(column[FIRST:].mean()) for name, column in columns.items()}


def step_error(scene: pw.Scene, engine: InHouse, depth: Array) -> float:
    """Return the relative error of the load distance in short pieces of runs."""
    scene = replace(scene, numerics=replace(scene.numerics, dae=engine))
    checks = [StepCheck(scene, depth, -1 - k)(lambda *_: None) for k in range(CHECKS)]
    return float(
        np.mean([check.get("load_distance_step_error", math.nan) for check in checks])
    )


def measure(subject: Subject, setting: Setting) -> dict[str, Any]:
    """Return means of each replicate, CPU time, energy residual and step error of a setting."""
    scene = subject.scene
    depth = depth_of(subject)
    linkage = linkage_on(scene, depth)
    period = scene.mechanism.period
    engine = InHouse(*setting[:2], impact_steps=setting.impact_steps)
    plan = Plan(period, FIRST + subject.cycles, 1, torques=False, run_up=scene.run_up)
    simulate = engine.for_cycle(period).simulate
    simulate(linkage, start_of(scene), replace(plan, cycles=1))  # compiles
    starts = [start_of(scene, 1 + k) for k in range(subject.replicates)]
    runs = [simulate(linkage, start, plan) for start in starts]
    sound = [run for run in runs if run.status != "failed"]
    failures = [run.message for run in runs if run.status == "failed"]
    if len(sound) < 2:
        return {"failures": failures}
    joints = [joint.name for joint in linkage.clearances]
    runs_means = [means_of(run, joints) for run in sound]
    numbers = [run.diagnostics for run in sound]
    residuals = [
        float(n["energy_residual_J"]) / float(n["drive_exchange_J"]) for n in numbers
    ]
    means = {}
    for name in runs_means[0]:
        means[name] = [run_means[name] for run_means in runs_means]
    return {
        "failures": failures,
        "means": means,
        "cpu": sum(run.cpu for run in sound) / (len(sound) * plan.cycles),
        "residual": float(np.median(np.abs(residuals))),
        "step_error": step_error(scene, engine, depth),
    }


def difference(
    values: Sequence[float], reference: Sequence[float]
) -> tuple[float, float]:
    """Return the difference of two means, and the half width of its 95 % interval (Welch)."""
    first = np.array(values)
    second = np.array(reference)
    result = float(first.mean() - second.mean())
    a = first.var(ddof=1) / first.size
    b = second.var(ddof=1) / second.size
    if a + b == 0.0:
        return result, 0.0
    freedom = (a + b) ** 2 / (a**2 / (first.size - 1) + b**2 / (second.size - 1))
    return result, quantile(freedom) * math.sqrt(a + b)


def cells(kind: str, row: Mapping[str, Any], reference: Mapping[str, Any]) -> str:
    """Return means of a quantity with their intervals, or their differences in per cent."""
    texts = []
    for name, values in row["means"].items():
        if not name.startswith(kind):
            continue
        expected = reference["means"][name]
        if row is reference:
            half = half_width(np.array(values)) or 0.0
            texts.append(f"{np.mean(values):.4g} ± {half:.2g}")
        else:
            change, half = difference(values, expected)
            percent = 100.0 / float(np.mean(expected))
            mark = "**" if abs(change) > half else ""
            text = f"{percent * change:+.2f} ± {percent * half:.2f}"
            texts.append(f"{mark}{text}{mark}")
    return "; ".join(texts)


def rows(name: str, settings: Mapping[str, Any]) -> list[str]:
    """Return the rows of a scene."""
    reference = settings[REFERENCE.name]
    lines = []
    for setting in SETTINGS:
        row = settings[setting.name]
        method = f"{setting.integrator.upper()}, {setting.tolerance:g}, {setting.impact_steps}"
        failed = len(row["failures"])
        if "means" not in row:
            lines.append(f"| {name} | {method} | all |{' |' * (len(HEADS) - 3)}")
            continue
        numbers = [f"{failed}", f"{1e3 * row['cpu']:.3g}"]
        sizes = row["residual"], row["step_error"]
        numbers += [f"{size:.1e}" if math.isfinite(size) else "" for size in sizes]
        numbers += [cells(kind, row, reference) for kind in KINDS]
        lines.append(f"| {name} | {method} | {' | '.join(numbers)} |")
    return lines


def count_significant(measured: Mapping[str, Any], setting: Setting) -> tuple[int, int]:
    """Return the number of differences from the reference beyond their intervals, and of all."""
    count = 0
    total = 0
    for settings in measured.values():
        row = settings[setting.name]
        reference = settings[REFERENCE.name]
        for name, values in row.get("means", {}).items():
            change, half = difference(values, reference["means"][name])
            total += 1
            count += abs(change) > half
    return count, total


def results_of(measured: Mapping[str, Any]) -> str:
    """Return the table with a sentence on each setting."""
    lines = [f"| {' | '.join(HEADS)} |", f"|---|---|{'---:|' * (len(HEADS) - 2)}"]
    for name, settings in measured.items():
        lines += rows(name, settings)
    lines.append("")
    for setting in SETTINGS:
        if setting != REFERENCE:
            count, total = count_significant(measured, setting)
            method = (
                f"{setting.tolerance:g} with {setting.impact_steps} steps in an impact"
            )
            lines.append(
                f"- DOPRI5 at {method}: {count} of {total} differences are beyond."
            )
    return "\n".join(lines)


def store(file: Path, names: Sequence[str]) -> None:
    """Measure all settings of the scenes and store them after each."""
    measured = json.loads(file.read_text()) if file.exists() else {}
    for name, subject in subjects().items():
        if names and name not in names:
            continue
        for setting in SETTINGS:
            if setting.name in measured.get(name, {}):
                continue
            result = measure(subject, setting)
            measured.setdefault(name, {})[setting.name] = result
            file.write_text(json.dumps(measured, indent=1))
            failed = len(result["failures"])
            print(
                f"{name}, {setting.name}: {result.get('cpu')} s, {failed} failed",
                flush=True,
            )


def main() -> None:
    """Measure, or write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("measure", "fill"))
    parser.add_argument("file", type=Path)
    parser.add_argument("scenes", nargs="*")
    arguments = parser.parse_args()
    if arguments.action == "measure":
        store(arguments.file, arguments.scenes)
        return
    results = results_of(json.loads(arguments.file.read_text()))
    marks = r"(?s)(<!-- result -->\n).*(<!-- end -->)"
    text = PAGE.read_text(encoding="utf-8")
    text = re.sub(marks, lambda match: f"{match[1]}\n{results}\n\n{match[2]}", text)
    PAGE.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
