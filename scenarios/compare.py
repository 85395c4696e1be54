"""Effect of friction and speed on the wear depth at joint A (paper, sections 5.4.2 and 5.4.3).

Run:  python scenarios/compare.py
"""

import presswear as pw

for setting in ({"friction": 0.05}, {"friction": 0.1}, {"speed": "8pi rad/s"}):
    result = pw.run(pw.scenes.friction(cycles=5, wear_updates=0, **setting))
    wear = result.stages[0].joints["A"].statistics.wear_peaks["both"].depth.mean
    print(f"{setting}: wear depth {1e6 * wear:.1f} µm at A")
