"""Greatest forces at A and C of the press of 250 kN by law and restitution, dry and oiled.

usage: python tests/benchmarks/peak_forces.py

Both cranks turn at constant speed, and the frame is rigid. Means of strokes 3 to 6.
"""

import numpy as np
from oil_costs import PRESS, RIGID

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.engines.settings import InHouse
from presswear.results.rigid_joints import ideal_forces

LAWS = "lankarani-nikravesh", "hunt-crossley", "flores", "gonthier"
VISCOSITIES = "0.1 Pa s", "0.02 Pa s"
RESTITUTIONS = 0.5, 0.8, 0.9, 1.0
STROKES = 6


def peaks(scene: pw.Scene) -> str:
    """Return the greatest forces of both joints, kN."""
    period = scene.mechanism.period
    engine = InHouse("dopri5", integration_tolerance=1e-7).for_cycle(period)
    plan = Plan(period, STROKES, 1)
    run = engine.simulate(scene.linkage(), start_of(scene, 1), plan)
    each = (run.recorder.each_cycle("force_max", joint)[2:] for joint in range(2))
    return "; ".join(f"{1e-3 * np.mean(one):.0f}" for one in each)


def main() -> None:
    """Print a line for each law and viscosity."""
    press = pw.changed(pw.scene_from(PRESS), {**RIGID, "replicates": 1})
    _, forces = ideal_forces(press)
    ideal = (f"{1e-3 * np.abs(forces[joint]).max():.0f}" for joint in "AC")
    print(f"without clearance: {'; '.join(ideal)} kN at A; C")
    rows = [{"normal_law": law} for law in LAWS]
    rows += [{"viscosity": oil, "film": "run"} for oil in VISCOSITIES]
    for row in rows:
        found = [
            f"{number}: {peaks(pw.changed(press, {**row, 'restitution': number}))}"
            for number in RESTITUTIONS
        ]
        print(f"{', '.join(row.values())}: {', '.join(found)}")


if __name__ == "__main__":
    main()
