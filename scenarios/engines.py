"""Slider-crank of Flores with clearance between rod and slider, in three engines.

Run:  python scenarios/engines.py
"""

import presswear as pw

tree = pw.engines.ExudynTree(tree_tolerance=1e-9)
for engine in (tree, pw.engines.ExudynJoints(), pw.engines.InHouse()):
    stage = pw.run(pw.scenes.slider_crank(cycles=5), engine=engine).stages[0]
    peak = stage.joints["B"].statistics.peak_force_per_cycle
    print(
        f"{stage.diagnostics['solver']}: mean peak force {peak} N, {stage.wall_s:.1f} s"
    )
