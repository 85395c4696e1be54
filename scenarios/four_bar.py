"""Four-bar linkage with two different bearings and a user friction law.

Run:  python scenarios/four_bar.py
"""

import math

import presswear as pw


def rub(sliding: float, normal: float, coefficient: float) -> float:
    return -coefficient * normal * math.tanh(sliding / 0.5e-3)


bars = [
    pw.Bar("crank", 0.05, 0.3),
    pw.Bar("coupler", 0.20, 0.5),
    pw.Bar("rocker", 0.12, 0.4),
]
pins = [
    pw.Pin("O", (0.0, 0.0), "crank.tail"),
    pw.Pin("A", "crank.head", "coupler.tail"),
    pw.Pin("B", "coupler.head", "rocker.head"),
    pw.Pin("P", (0.18, 0.0), "rocker.tail"),
]
guess = {"coupler": 0.6, "rocker": 1.4}  # rad, approximate angles
four_bar = pw.assemble(bars, pins, [pw.Drive("crank", 30.0)], "rocker.head", guess)
bearings = {
    "A": pw.Bearing(clearance=0.1e-3, normal_law="flores", restitution=0.6),
    "B": pw.Bearing(clearance=0.3e-3, friction=0.1, friction_law=rub),
}
result = pw.run(
    pw.Scene(four_bar, bearings=bearings, wear_updates=0, cycles=4), engine="dae"
)
for name, joint in result.stages[0].joints.items():
    print(f"{name}: mean peak force {joint.statistics.peak_force_per_cycle.mean:.0f} N")
