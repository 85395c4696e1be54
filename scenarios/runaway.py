"""Depth of the second wear update in the paper's scene, with one convention changed at a time.

In the paper the wear depth at joint A grows from 1.221 µm to 1178 µm by the second wear
update. The surfaces of one long run are then run again with both contact models.

Run:  python scenarios/runaway.py [FOLDER]      (20 minutes of one core)
"""

import sys
from collections.abc import Mapping
from dataclasses import replace
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.stats import binomtest

import presswear as pw

RUNAWAY = 10.0  # ratio of the second to the first added depth that counts as growth
FOUNDATION = {"contact": "foundation"}
ARC = {"wear_distribution": "arc", "extrapolation": "single"}
REFINED = {"conventions": "refined", "wear_maps": "raw"}
ASSUMPTIONS: dict[str, tuple[str, dict[str, Any]]] = {
    "paper": ("as printed", {}),
    "foundation": ("contact on a foundation", FOUNDATION),
    "turning": ("maps turn with the bodies", {"map_frame": "body"}),
    "sliding": ("slip is true sliding", {"slip": "sliding"}),
    "steps": ("wear in steps", {"extrapolation": "steps"}),
    "arc": ("wear over the arc", ARC),
    "arc-foundation": ("arc, contact on a foundation", ARC | FOUNDATION),
    "arc-steps": ("arc, wear in steps", {"wear_distribution": "arc"}),
    "arc-once": ("arc, multiplied from one cycle", ARC | {"cycles": 1}),
    "arc-once-foundation": (
        "arc, one cycle, foundation",
        ARC | FOUNDATION | {"cycles": 1},
    ),
    "arc-twice": ("arc, multiplied from two cycles", ARC | {"cycles": 2}),
    **{
        f"angles-{m}": (f"{m} angles", {"angles": m})
        for m in (60, 72, 90, 180, 720, 1440)
    },
    "refined": ("refined, wear in steps", REFINED),
    "refined-single": ("refined, one jump", REFINED | {"extrapolation": "single"}),
    "coarse": (
        "RK4 at 5e-5 s",
        {"engine": "dae", "integrator": "rk4", "equal_step": "5e-5 s"},
    ),
    "paper-step": (
        "RK4 at 1e-4 s, as the paper",
        {"engine": "dae", "integrator": "rk4-paper"},
    ),
}


def make_scenes(common: dict[str, Any]) -> dict[str, pw.Scene]:
    scenes = {}
    for key, (_, changes) in ASSUMPTIONS.items():
        scene = pw.scenes.wear_times(**common | changes)
        # The second update in one step follows from stage 1; many steps need stage 2.
        scenes[key] = replace(scene, wear_updates=2) if scene.wears_in_steps else scene
    cycles = max(200 * common["cycles"] * common["replicates"] // (5 * 16), 1)
    long = {"cycles": cycles, "replicates": 1, "wear_updates": 2}
    return scenes | {"longer": pw.scenes.wear_times(**common | long)}


def depths_of(result: pw.Result) -> list[Any]:
    """Return the depth that each wear update adds, m, each of shape (joints, replicates)."""
    stages = [
        stage.statistics.joints for stage in result.stages[:2] if not stage.failed
    ]
    return [
        np.array([one.wear_depth_max_by_replicate for one in s.values()])
        for s in stages
    ]


def mean_text(estimate: Any, factor: float = 1.0) -> str:
    return f"{factor * estimate.mean:.3g} ± {factor * (estimate.half_width or nan):.2g}"


def row_of(label: str, result: pw.Result) -> list[str]:
    """Return label, median depths, ratio, runs with growth, peak forces at A, and message."""
    wears = depths_of(result)
    texts = [
        ", ".join(f"{1e6 * depth:.3g}" for depth in np.median(wear, axis=1))
        for wear in wears
    ]
    growth = away = "-"
    if len(wears) == 2:
        ratios = (wears[1] / wears[0]).max(axis=0)
        growth = "{1:.2g} ({0:.2g} to {2:.2g})".format(
            *np.quantile(ratios, (0.05, 0.5, 0.95))
        )
        count = int((ratios > RUNAWAY).sum())
        interval = binomtest(count, ratios.size).proportion_ci(method="wilson")
        away = f"{count} of {ratios.size} ({interval.low:.0%} to {interval.high:.0%})"
    joints = [
        stage.joints["A"].statistics for stage in result.stages if not stage.failed
    ]
    forces = ", ".join(f"{joint.peak_force_per_cycle.mean:.0f}" for joint in joints)
    return [label, *[*texts, "-", "-"][:2], growth, away, forces, result.message]


def draw(results: Mapping[str, pw.Result], file: Path) -> None:
    panels = Figure(figsize=(7.0, 5.0), layout="constrained").subplots(
        1, 2, sharey=True
    )
    for row, key in enumerate(ASSUMPTIONS):
        for wear, mark, colour in zip(
            depths_of(results[key]), "os", ("C0", "C1"), strict=False
        ):
            for axes, depth, joint in zip(panels, 1e6 * wear, "AC", strict=True):
                axes.plot(depth, [row] * depth.size, mark, color=colour, markersize=3)
                axes.set(
                    xscale="log",
                    xlabel=f"depth added at {joint}: wear 1 (○), 2 (□) (µm)",
                )
    panels[0].set_yticks(
        range(len(ASSUMPTIONS)), [label for label, _ in ASSUMPTIONS.values()]
    )
    panels[0].figure.savefig(file)


def main(
    folder: str = "results/runaway", jobs: int | None = None, **settings: Any
) -> None:
    def show(name: str, fraction: float, words: str) -> None:
        if fraction == 1.0:
            print(f"finished {name}: {words}")

    common = {
        "conventions": "paper",
        "cycles": 5,
        "replicates": 16,
        "wear_updates": 1,
    } | settings
    results = pw.run_scenes(make_scenes(common), folder, jobs=jobs, on_progress=show)
    print(
        "convention | update 1 at A, C | update 2 (µm) | ratio | growth | force at A (N)"
    )
    for key, (label, _) in ASSUMPTIONS.items():
        print(" | ".join(row_of(label, results[key])))
    draw(results, Path(folder) / "two-wears.png")
    again = {}
    for stage in (1, 2):
        surfaces = pw.results.read_surfaces(f"{folder}/longer:{stage}")
        for contact in ("radial", "foundation"):
            scene = pw.scenes.wear_times(
                **common | {"contact": contact, "wear_updates": 0}
            )
            again[f"on-{stage}-{contact}"] = replace(scene, surfaces=surfaces)
    print(
        "same surfaces | peak force at A (N) | energy created by contacts in a cycle (mJ)"
    )
    for key, result in pw.run_scenes(
        again, folder, jobs=jobs, on_progress=show
    ).items():
        made = result.stages[0].statistics.energy_made_per_cycle
        force = result.stages[0].joints["A"].statistics.peak_force_per_cycle
        print(f"{key} | {mean_text(force)} | {mean_text(made, 1e3)}")


if __name__ == "__main__":
    main(sys.argv[1] if sys.argv[1:] else "results/runaway")
