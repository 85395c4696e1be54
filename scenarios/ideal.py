"""The press without clearance in Exudyn, against its closed form.

Run:  python scenarios/ideal.py
"""

import numpy as np

from presswear.campaign.campaign import Watcher, run_stage
from presswear.scene.catalog import ideal


def main() -> None:
    scene = ideal()
    stage = run_stage(scene, 0, {}, Watcher())
    recorder = stage.ensemble.recorders[0]
    time, displacement = recorder.rows[:, :2].T
    column = 3 * stage.linkage.index("slider 6") + 1
    exact = scene.mechanism.ideal_motion(time).position[:, column]
    print(f"stroke {np.ptp(exact):.4f} m")
    print(f"Exudyn against the closed form {np.abs(displacement - exact + exact[0]).max():.1e} m")


if __name__ == "__main__":
    main()
