"""Errors of the paper, each with the effect of its correction on the wear depth.

The file ``errors.toml`` lists the errors, and explains the source of each effect.
"""

import presswear as pw
from presswear.paper.evidence import Evidence
from presswear.paper.printed import Place
from presswear.paper.settings import (
    BASE,
    SENSITIVITIES,
    SETTINGS,
    WEAR,
    base_scene,
    read,
    run_name,
)
from presswear.paper.verdicts import ratio
from presswear.show.page import Table, plain_table, text_of

# Equation, printed form, right form, case and text of each error
_ROWS = read("errors.toml")["errors"]
CHORD = "chord"  # case with a closed form instead of a run
PLACE = Place(WEAR, 1, "A")  # stage and joint of the depth
# Runs that the table needs
RUNS = [run_name(BASE, WEAR)]
RUNS += [run_name(case, WEAR) for _, _, _, case, _ in _ROWS if case in SENSITIVITIES]


def chord_ratio(scene: pw.Scene) -> float:
    """Return the area of equations 25 to 27 over that with the half chord R_j sin(beta).

    The wear depth on unworn surfaces is inversely proportional to the area.
    """
    bearing = scene.bearing(PLACE.joint)
    return bearing.bearing_radius / (bearing.bearing_radius - bearing.clearance)


def effect(evidence: Evidence, case: str) -> pw.statistics.Estimate | float | None:
    """Return the change of the depth in a case, relative to the depth of the printed form."""
    if case == CHORD:
        return chord_ratio(base_scene(WEAR)) - 1.0
    depths = [evidence.estimate(name, PLACE, "depth") for name in (case, BASE)]
    positive = [depth for depth in depths if depth is not None and depth.mean > 0.0]
    if len(positive) < 2:
        return None
    change = ratio(positive[:1], positive[1:])
    low = None if change.low is None else change.low - 1.0
    high = None if change.high is None else change.high - 1.0
    return pw.statistics.Estimate(change.mean - 1.0, low, high)


def error_table(evidence: Evidence) -> Table:
    """Return every error with its effect on the depth in per cent."""
    lines = []
    for equation, printed, right, case, text in _ROWS:
        result = evidence.results.get(run_name(case, WEAR))
        if result is not None and result.status == "failed":
            effect_text = f"the run ends early: {result.message}"
        elif case:
            effect_text = text_of(effect(evidence, case), "%")
        else:
            effect_text = text
        lines.append((equation, printed, right, effect_text))
    setting = SETTINGS[WEAR].label
    head = (
        "equation",
        "printed",
        "right",
        f"effect on the depth at A, first wear, {setting} (%)",
    )
    return plain_table(head, lines, numeric=False)
