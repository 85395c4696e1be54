"""Measure the speed of the program beside others, and write the tables of README.md and cost.md.

    python docs/_tools/speed.py measure [NAME ...]    all: half an hour
    python docs/_tools/speed.py fill

Each measurement is stored in ``docs/validation/speed.json`` with its date, machine and
versions. A method whose program is not installed keeps its stored rows.
"""

import argparse
import json
import math
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from presswear.results.provenance import provenance
from presswear.tools.numbers import counted

ROOT = Path(__file__).parents[2]
FILE = ROOT / "docs" / "validation" / "speed.json"
PAGES = ROOT / "README.md", ROOT / "docs" / "validation" / "cost.md"
sys.path.insert(0, str(ROOT / "tests" / "benchmarks"))

from motor_costs import ratios as motor_ratios  # noqa: E402
from oil_costs import VISCOSITIES  # noqa: E402
from oil_costs import ratios as oil_ratios  # noqa: E402
from side_by_side import LEVELS, cost_at, points_of  # noqa: E402
from step_costs import LOOP, start_costs, step_costs  # noqa: E402

from presswear.scene.catalog import wear_times  # noqa: E402
from presswear.validation.benchmark import QUICK_FEATURES, feature_costs  # noqa: E402

Stored = dict[str, Any]
REPEATS = 27  # initial states of the fast methods
SLOW_REPEATS = 5
FAST = "exudyn-tree", "dae", "hand-written loop"
SLOW = "exudyn-joints", "hand-written, ", "MuJoCo", "Drake"
# Rows of the table in README, and what its reader needs after the name
IN_README = {
    "exudyn-tree": "",
    "dae, DOPRI5": "",
    "hand-written loop, DOPRI5": ", for this press",
    "MuJoCo, RK4": ", pin forces from our kernel through Python",
    "Drake, RK3": ", pin forces from our kernel through Python",
}
# Settings of the table of errors and costs
SETTINGS = {
    "exudyn-tree": (1e-5, 1e-8),
    "dae, DOPRI5": (1e-5, 1e-6, 1e-8),
    "exudyn-joints": (50, 200),
    "hand-written loop, DOPRI5": (1e-5, 1e-6, 1e-8),
}


def silent(name: str, share: float) -> None:
    """Ignore progress."""


def origin() -> Stored:
    """Return date, machine and versions of a measurement of today."""
    now = provenance()
    return {
        "date": now["started"][:10],
        "machine": now["machine"],
        "python": now["python"],
        "packages": now["packages"],
        "revision": now["revision"],
    }


def measure_methods(repeats: int, names: Sequence[str]) -> Stored:
    """Return the rows of each method, setting, error and cost, with their origin."""
    rows = dict(points_of(repeats, names))
    return {name: {**origin(), "rows": rows[name]} for name in rows}


def measured(data: Any) -> Stored:
    """Return a measurement with its origin."""
    return {**origin(), "rows": data}


MEASURES: Mapping[str, Callable[[], Stored]] = {
    "methods": lambda: measure_methods(REPEATS, FAST),
    "slow methods": lambda: measure_methods(SLOW_REPEATS, SLOW),
    "steps": lambda: measured(step_costs()),
    "starts": lambda: measured(start_costs()),
    "features": lambda: measured(feature_costs(wear_times(), QUICK_FEATURES, silent)),
    "motor": lambda: measured([*motor_ratios("dae", 9, 20)]),
    "motor in exudyn-tree": lambda: measured([*motor_ratios("exudyn-tree", 9, 5)]),
    "oil": lambda: measured([*oil_ratios(9, 2, 1e-7)]),
}


def relative_costs(stored: Stored) -> dict[str, list[str]]:
    """Return the costs of each method at LEVELS as texts, relative to exudyn-tree at 1e-8."""
    methods = {**stored["methods"], **stored["slow methods"]}
    unit = cost_of(methods["exudyn-tree"], 1e-8)
    texts = {}
    for name, method in methods.items():
        costs = method.get("relative")  # of a measurement whose rows are not stored
        if costs is None:
            points = [(error, cost) for _, error, cost in method["rows"]]
            costs = [cost_at(points, level) / unit for level in LEVELS]
        texts[name] = [_cost_text(cost) for cost in costs]
    return texts


def _cost_text(cost: float | None) -> str:
    if not cost or math.isnan(cost):
        return "-"
    return f"{cost:.2g}"


def cost_of(method: Stored, setting: float) -> float:
    """Return the cost of a method at a setting, s/s."""
    return next(float(cost) for value, _, cost in method["rows"] if value == setting)


def method_table(stored: Stored, labels: Mapping[str, str]) -> list[str]:
    """Return the rows of relative costs for some methods and what follows their names."""
    costs = relative_costs(stored)
    heads = " | ".join(short(f"{level:g} m") for level in LEVELS)
    lines = [f"| method | {heads} |", "|---|---:|---:|---:|"]
    lines += [
        f"| {name_of(name)}{label} | {' | '.join(costs[name])} |"
        for name, label in labels.items()
    ]
    return lines


def short(number: str) -> str:
    """Return a number without the zero of its exponent."""
    return number.replace("e-0", "e-")


def name_of(method: str) -> str:
    """Return the name of a method with the name of its engine as code."""
    return re.sub(r"^(exudyn-\w+|dae)", r"`\1`", method)


def readme_table(stored: Stored) -> list[str]:
    """Return the table of README."""
    return method_table(stored, IN_README)


def all_methods(stored: Stored) -> list[str]:
    """Return the table of all methods, and when each was measured."""
    methods = {**stored["methods"], **stored["slow methods"]}
    dates: dict[str, list[str]] = {}
    for name, method in methods.items():
        dates.setdefault(method["date"], []).append(name_of(name))
    lines = method_table(stored, dict.fromkeys(methods, ""))
    machines = dict.fromkeys(method["machine"] for method in methods.values())
    lines += ["", f"Measured on {' and '.join(machines)}:"]
    lines += [f"- {date}: {'; '.join(names)}" for date, names in sorted(dates.items())]
    return lines


def error_table(stored: Stored) -> list[str]:
    """Return errors and costs of the engines and of the loop at some settings."""
    methods = {**stored["methods"], **stored["slow methods"]}
    lines = ["| method | error (m) | s/s |", "|---|---:|---:|"]
    for name, settings in SETTINGS.items():
        rows = [row for row in methods[name]["rows"] if row[0] in settings]
        values = "; ".join(short(f"{value:g}") for value, _, _ in rows)
        what = " steps in a contact" if name == "exudyn-joints" else ""
        errors = "; ".join(short(f"{error:.1e}") for _, error, _ in rows)
        costs = "; ".join(f"{cost:.2g}" for _, _, cost in rows)
        lines.append(f"| {name_of(name)}, {values}{what} | {errors} | {costs} |")
    return lines


def step_table(stored: Stored) -> list[str]:
    """Return the cost of a step of the loop and of ``dae``."""
    heads = (
        "µs per step",
        "relative to the loop",
        "µs per trial step",
        "relative",
        "steps per cycle",
        "ms per cycle",
    )
    lines = [f"| | {' | '.join(heads)} |", f"|---|{'---:|' * len(heads)}"]
    for row in stored["steps"]["rows"]:
        is_loop = row["method"] == LOOP
        cells = (
            f"{1e6 * row['cpu_s_per_step']:.2f}",
            "" if is_loop else f"{row['relative']:.2f}",
            f"{1e6 * row['cpu_s_per_trial']:.2f}",
            "" if is_loop else f"{row['relative_trial']:.2f}",
            f"{row['steps_per_cycle']:,.0f}",
            f"{1e3 * row['cpu_s_per_cycle']:.2g}",
        )
        lines.append(f"| {name_of(row['method'])} | {' | '.join(cells)} |")
    return [*lines, "", measured_on(stored["steps"])]


def start_table(stored: Stored) -> list[str]:
    """Return the CPU times of first and second starts."""
    heads = "first start", "second start", "compilation"
    lines = [f"| | {' | '.join(heads)} |", "|---|---:|---:|---:|"]
    for row in stored["starts"]["rows"]:
        first = row["first_start_s"]
        second = row["second_start_s"]
        cells = f"{first:.1f} | {second:.1f} | {first - second:.1f}"
        lines.append(f"| `{row['engine']}` | {cells} |")
    return [*lines, "", measured_on(stored["starts"])]


def feature_table(stored: Stored) -> list[str]:
    """Return the cost of each feature."""
    heads = (
        "feature",
        "engine",
        "s per simulated second",
        "µs per step",
        "relative to the row without it",
    )
    lines = [f"| {' | '.join(heads)} |", "|---|---|---:|---:|---:|"]
    for row in stored["features"]["rows"]:
        cells = (
            f"{row['feature']}: {row['state']}",
            f"`{row['engine']}`",
            f"{row['cpu_s_per_simulated_s']:.3g}",
            f"{1e6 * row['cpu_s_per_step']:.1f}",
            f"{row['ratio_per_step']:.2f}",
        )
        lines.append(f"| {' | '.join(cells)} |")
    return [*lines, "", measured_on(stored["features"])]


def motor_table(stored: Stored) -> list[str]:
    """Return the cost of motors relative to prescribed cranks."""
    names = "CPU time", "steps", "CPU time of a step"
    lines = [
        f"| engine | tolerance | {' | '.join(names)} |",
        "|---|---|---:|---:|---:|",
    ]
    for key in ("motor", "motor in exudyn-tree"):
        rows = stored[key]["rows"]
        cells = []
        for name in names:
            ratios = (row[name][1] / row[name][0] for row in rows)
            cells.append("; ".join(f"{ratio:.2f}" for ratio in ratios))
        tolerances = "; ".join(short(f"{row['tolerance']:g}") for row in rows)
        lines.append(f"| `{rows[0]['engine']}` | {tolerances} | {' | '.join(cells)} |")
    return [*lines, "", measured_on(stored["motor"])]


def oil_table(stored: Stored) -> list[str]:
    """Return steps and CPU time with an oil film relative to the dry press."""
    heads = " | ".join(VISCOSITIES)
    lines = [f"| clearance, per mille of the radius | {heads} |"]
    lines.append(f"|---:|{'---:|' * len(VISCOSITIES)}")
    clearances = dict.fromkeys(row["per mille"] for row in stored["oil"]["rows"])
    for clearance in clearances:
        cells = [
            f"{row['steps']:.2f}; {row['CPU time']:.1f}"
            for row in stored["oil"]["rows"]
            if row["per mille"] == clearance
        ]
        lines.append(f"| {clearance} | {' | '.join(cells)} |")
    return [*lines, "", measured_on(stored["oil"])]


def measured_on(measurement: Stored) -> str:
    """Return a sentence on date and machine of a measurement."""
    return f"Measured on {measurement['date']} on {measurement['machine']}."


TABLES: Mapping[str, Callable[[Stored], list[str]]] = {
    "readme": readme_table,
    "methods": all_methods,
    "errors": error_table,
    "steps": step_table,
    "starts": start_table,
    "features": feature_table,
    "motor": motor_table,
    "oil": oil_table,
}


def filled(text: str) -> str:
    """Return the text of a page with the tables between their marks."""
    stored = json.loads(FILE.read_text())
    for name, table in TABLES.items():
        before, mark, after = text.partition(f"<!-- speed: {name} -->\n")
        if mark:
            lines = "\n".join(table(stored))
            _, end, after = after.partition("<!-- end -->")
            text = f"{before}{mark}\n{lines}\n\n{end}{after}"
    return text


def fill() -> None:
    """Write the tables into the pages."""
    for page in PAGES:
        page.write_text(filled(page.read_text()))


def store(names: Sequence[str]) -> None:
    """Measure and store after each measurement."""
    stored = json.loads(FILE.read_text()) if FILE.exists() else {}
    for name in names or MEASURES:
        # Methods that are not installed keep their rows.
        kept = stored.get(name, {}) if "methods" in name else {}
        stored[name] = {**kept, **MEASURES[name]()}
        FILE.write_text(f"{json.dumps(stored, indent=1)}\n")
        print(f"{name}: {counted(len(stored[name]), 'entry')}", flush=True)


def main() -> None:
    """Measure, or write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("action", choices=("measure", "fill"))
    parser.add_argument("names", nargs="*", help=f"of {', '.join(MEASURES)}")
    arguments = parser.parse_args()
    if arguments.action == "measure":
        store(arguments.names)
    else:
        fill()


if __name__ == "__main__":
    main()
