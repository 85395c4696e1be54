"""A slider-crank with clearance between rod and slider in three engines, after Flores.

Run:  python scenarios/engines.py
"""

import presswear as pw

for engine in (pw.ExudynTree(tree_tolerance=1e-9), pw.ExudynJoints(), pw.InHouse()):
    stage = pw.run(pw.scenes.slider_crank(cycles=3), engine=engine).stages[0]
    peak = stage.joints["B"].statistics.peak_force_per_cycle.mean
    print(f"{stage.diagnostics['solver']}: mean peak force {peak:.0f} N, {stage.wall_s:.1f} s")
