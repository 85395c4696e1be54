"""CPU time of the press with motors on both cranks, relative to that with prescribed cranks.

usage: python tests/benchmarks/motor_costs.py [--repeats N] [--cycles N] [--engine WORD]
       [--errors]

Both are open trees of the paper's press with clearance at A and C, without wear updates:
of six coordinates with a motor with flywheel at crank 2 and a servo at crank 7, of four
with prescribed cranks. The flywheel is large, so that both have nearly the same motion.
Each repeat has a seed of its own, and its runs are interleaved. With ``--errors`` the
errors of the slide are printed, too, relative to a run at a tolerance 100 times smaller.
"""

import argparse
from statistics import median
from typing import Any

from scipy.stats import gmean

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Run
from presswear.engines.settings import ExudynTree, InHouse

TOLERANCES = {"dae": (1e-7, 1e-9), "exudyn-tree": (1e-6, 1e-8)}
END = 0.1  # s, at which errors are compared
CRANKS = {"inertia_2": "0.1 kg m^2", "inertia_7": "0.1 kg m^2"}
MOTORS = {
    "motor.torque": "20 N m",
    "motor.inertia": "10 kg m^2",
    "servo.stiffness": "10 kN m/rad",
    "servo.damping": "40 N m s/rad",
}


def run_of(scene: pw.Scene, tolerance: float, plan: Plan, seed: int) -> Run:
    """Return a run of the engine of a scene at a tolerance."""
    engine: InHouse | ExudynTree = ExudynTree(tree_tolerance=tolerance)
    if scene.engine == "dae":
        engine = InHouse(integration_tolerance=tolerance)
    run = engine.for_cycle(scene.mechanism.period).simulate(
        scene.linkage(), start_of(scene, seed), plan
    )
    if run.status == "failed":
        raise SystemExit(run.message)
    return run


def slide_error(scene: pw.Scene, tolerance: float, seed: int) -> float:
    """Return the error of the height of the slide after END, m."""
    place = 3 * scene.linkage().index("slider 6") + 1
    heights = [
        run_of(scene, each, Plan(END, 1), seed).end.position[place]
        for each in (tolerance, 1e-2 * tolerance)
    ]
    return max(abs(float(heights[0] - heights[1])), 1e-16)


def cost(scene: pw.Scene, tolerance: float, cycles: int, seed: int) -> list[float]:
    """Return CPU time, s, steps and contacts of a run."""
    plan = Plan(scene.mechanism.period, cycles, 1, torques=False)
    run = run_of(scene, tolerance, plan, seed)
    contacts = run.recorder.records.counters["contacts"].sum()
    return [run.cpu, run.recorder.each_cycle("steps").sum(), float(contacts)]


def ratios(engine: str, repeats: int, cycles: int) -> list[dict[str, Any]]:
    """Return medians of prescribed cranks and of motors, of each tolerance of an engine."""
    plain = pw.scenes.wear_times(conventions="refined", engine=engine)
    plain = pw.changed(plain, CRANKS)
    scenes = plain, pw.changed(plain, MOTORS)
    result = []
    for tolerance in TOLERANCES[engine]:
        for scene in scenes:
            cost(scene, tolerance, 1, 1)  # compiles
        rows = [
            [cost(scene, tolerance, cycles, seed) for scene in scenes]
            for seed in range(1, repeats + 1)
        ]
        values = list(zip(*rows, strict=True))
        numbers: dict[str, Any] = {
            "CPU time": [median(run[0] for run in runs) for runs in values],
            "steps": [median(run[1] for run in runs) for runs in values],
            "contacts": [median(run[2] for run in runs) for runs in values],
            "CPU time of a step": [
                median(run[0] / run[1] for run in runs) for runs in values
            ],
        }
        result.append({"engine": engine, "tolerance": tolerance, **numbers})
    return result


def main() -> None:
    """Print medians with prescribed cranks and with motors, and their ratios."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=9, help="(default 9)")
    parser.add_argument("--cycles", type=int, default=20, help="(default 20)")
    parser.add_argument("--engine", choices=TOLERANCES, default="dae")
    parser.add_argument("--errors", action="store_true")
    options = parser.parse_args()
    for row in ratios(options.engine, options.repeats, options.cycles):
        print(f"{row.pop('engine')}, tolerance {row['tolerance']:g}")
        tolerance = row.pop("tolerance")
        for name, (first, second) in row.items():
            print(f"  {name}: {first:.4g}, {second:.4g}; ratio {second / first:.3f}")
        if options.errors:
            plain = pw.scenes.wear_times(conventions="refined", engine=options.engine)
            plain = pw.changed(plain, CRANKS)
            seeds = range(1, options.repeats + 1)
            first, second = (
                gmean([slide_error(scene, tolerance, seed) for seed in seeds])
                for scene in (plain, pw.changed(plain, MOTORS))
            )
            print(f"  error of the slide, m: {first:.2g}, {second:.2g}")


if __name__ == "__main__":
    main()
