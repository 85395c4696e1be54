"""Press without clearance in Exudyn, compared with its closed form.

Run:  python scenarios/ideal.py
"""

import numpy as np

import presswear as pw

scene = pw.scenes.ideal()
stage = pw.run(scene).stages[0]
exact = scene.ideal_slider(stage.time)[:, 0]
print(f"stroke {np.ptp(exact):.4f} m")
print(
    f"difference from the closed form {np.abs(stage.displacement - exact).max():.1e} m"
)
