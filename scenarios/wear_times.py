"""Main scene of the paper: no wear, first and second wear update.

Run:  python scenarios/wear_times.py
"""

import presswear as pw

result = pw.run(pw.scenes.wear_times(cycles=3), "results/wear-times-script")
print(result)
print("report:", result.report())
