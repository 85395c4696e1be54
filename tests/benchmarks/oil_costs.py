"""Steps and CPU time of the oiled press of 250 kN, relative to the dry press.

usage: python tests/benchmarks/oil_costs.py [--repeats N] [--cycles N] [--tolerance T]

Both cranks turn at constant speed, and the frame is rigid. Dry and oiled joints have the
same clearance, 1 to 5 per mille of the radius; their runs are interleaved.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from typing import Any

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse

PRESS = Path(__file__).parents[2] / "scenarios" / "press-250kN.toml"
RIGID = {"motor": "none", "servo": "none", "frame_stiffness": "none"}
RADIUS = 45e-3  # m
PER_MILLE = (1, 2, 3, 5)
VISCOSITIES = ("0.005 Pa s", "0.02 Pa s", "0.1 Pa s", "1 Pa s")


def cost(scene: pw.Scene, tolerance: float, cycles: int) -> tuple[float, float, int]:
    """Return CPU time, s, steps and repeated steps of a run."""
    period = scene.mechanism.period
    engine = InHouse("dopri5", integration_tolerance=tolerance).for_cycle(period)
    plan = Plan(period, cycles, 1)
    run = engine.simulate(scene.linkage(), start_of(scene, 1), plan)
    if run.status == "failed":
        raise SystemExit(run.message)
    steps = float(run.recorder.each_cycle("steps").sum())
    return run.cpu, steps, int(run.diagnostics["steps_sent_back"])


def ratios(repeats: int, cycles: int, tolerance: float) -> Iterator[dict[str, Any]]:
    """Yield the ratios of an oiled run to a dry one, of each clearance and viscosity."""
    press = pw.changed(pw.scene_from(PRESS), {**RIGID, "replicates": 1})
    for part in PER_MILLE:
        dry = pw.changed(press, {"clearance": 1e-3 * part * RADIUS})
        for viscosity in VISCOSITIES:
            oiled = pw.changed(dry, {"viscosity": viscosity, "film": "run"})
            for scene in (dry, oiled):
                cost(scene, tolerance, cycles)  # compiles
            pairs = [
                [cost(scene, tolerance, cycles) for scene in (dry, oiled)]
                for _ in range(repeats)
            ]
            (_, before, _), (_, steps, repeated) = pairs[0]
            yield {
                "per mille": part,
                "viscosity": viscosity,
                "CPU time": median(second[0] / first[0] for first, second in pairs),
                "steps": steps / before,
                "repeated": repeated / steps,
            }


def main() -> None:
    """Print a line for each clearance and viscosity."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=9, help="(default 9)")
    parser.add_argument("--cycles", type=int, default=4, help="(default 4)")
    parser.add_argument("--tolerance", type=float, default=1e-6, help="(default 1e-6)")
    options = parser.parse_args()
    for row in ratios(options.repeats, options.cycles, options.tolerance):
        print(
            f"{row['per mille']} per mille, {row['viscosity']}: CPU time "
            f"{row['CPU time']:.2f}, steps {row['steps']:.2f}, repeated "
            f"{row['repeated']:.2f} of the steps"
        )


if __name__ == "__main__":
    main()
