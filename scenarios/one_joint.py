"""Largest acceleration of the slider of a press with clearance in one joint only.

Run:  python scenarios/one_joint.py
"""

import presswear as pw

for scene in (pw.scenes.clearance_a(cycles=2), pw.scenes.clearance_c(cycles=2)):
    peak = pw.run(scene, engine="dae").stages[0].output.acceleration_max
    print(f"{scene.title}: slider acceleration up to {peak:.0f} m/s^2")
