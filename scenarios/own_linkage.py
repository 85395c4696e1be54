"""Pendulum on a pin with clearance, assembled from a body and a joint, in the in-house solver.

Run:  python scenarios/own_linkage.py
"""

import numpy as np

import presswear as pw
from presswear.linkage import Attachment

pin = pw.linkage.ClearanceJoint(
    "pin", Attachment("bob", 0.0, 0.2), Attachment("frame", 0.0, 0.0), 0.015, 1e-3, 0.02,
    pw.linkage.NormalLaw(1e10, damping=0.1), pw.linkage.FrictionLaw(0.05),
)  # fmt: skip
bob = pw.Body("bob", mass=1.0, inertia=0.01)
pendulum = pw.assemble((bob,), clearances=(pin,))
start = pw.engines.Start(0.2 * np.array([np.sin(0.5), -np.cos(0.5), 2.5]), np.zeros(3))
run = pw.simulate(pendulum, start, duration="2 s", engine="dae")
print(
    f"after {run.time:g} s: {run.recorder.records.counters['contacts'][0]} contacts, {run.status}"
)
