"""A slider-crank at 5000 rpm with clearance between rod and slider, against the ideal one.

Run:  python scenarios/slider_crank.py
"""

import numpy as np

from presswear.campaign.campaign import Watcher, run_stage
from presswear.scene.catalog import slider_crank


def main() -> None:
    scene = slider_crank()
    stage = run_stage(scene, 0, {}, Watcher())
    time = np.linspace(0.0, scene.mechanism.period, 1001)
    column = 3 * stage.linkage.index("slider")
    ideal = scene.mechanism.ideal_motion(time).acceleration[:, column]
    slider, joint = stage.statistics["slider"], stage.statistics["joints"]["B"]
    print(f"ideal acceleration up to {np.abs(ideal).max():.0f} m/s^2")
    print(f"with clearance up to {slider['acceleration_max_m_s2']:.0f} m/s^2")
    print(f"joint B: {joint['contacts']} contacts, peak force {joint['force_max_N']:.0f} N")


if __name__ == "__main__":
    main()
