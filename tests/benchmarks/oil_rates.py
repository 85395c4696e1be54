"""Eigenvalues of the equations of the oiled press of 250 kN along a cycle.

usage: python tests/benchmarks/oil_rates.py [--tolerance T] [--restitution E]

Where an oiled joint takes more steps than a dry one, they tell why: a rate of decay
bounds the steps of an explicit method, and an oscillation has to be resolved.
"""

import argparse

import numpy as np
from oil_costs import PER_MILLE, PRESS, RADIUS, RIGID, VISCOSITIES

import presswear as pw
from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, recorder_of
from presswear.engines.dae.engine import _Solver
from presswear.engines.settings import InHouse
from presswear.physics.equations.function import function_of
from presswear.tools.arrays import Array
from presswear.tools.packing import pack_arguments

INSTANTS = 300  # of a cycle, at which eigenvalues are computed
STABLE = 3.3  # rate times step up to which DOPRI5 is stable


def rates(scene: pw.Scene, tolerance: float) -> tuple[Array, float]:
    """Return eigenvalues along the second cycle, 1/s, and the steps of this cycle.

    The shape is (instants, states). The film opens and closes at different rates, so
    that the eigenvalues of both senses of a difference are returned.
    """
    linkage, start = scene.linkage(), start_of(scene, 1)
    period = scene.mechanism.period
    plan = Plan(period, 2, recorded_cycles=0)
    engine = InHouse("dopri5", integration_tolerance=tolerance).for_cycle(period)
    recorder = recorder_of(linkage, start, plan)
    solver = _Solver(linkage, start, engine, plan, recorder)
    function = function_of(solver.equations.text)
    data = pack_arguments(solver.model)
    layout = solver.equations.layout
    changes = np.full(layout.first_energy, 1e-11)  # m; of a place on a film
    changes[: layout.first_state] = 1e-6
    changes[: layout.coordinates] = 1e-8
    out = np.zeros_like(solver.y)

    def rate(state: Array) -> Array:
        function(data, solver.time, state, out, 1)
        return out[: changes.size].copy()

    found = []
    solver.advance(period)
    before = int(solver.control["steps"][0])
    for instant in range(INSTANTS):
        solver.advance((1.0 + (instant + 1) / INSTANTS) * period)
        here = rate(solver.y)
        for sense in (1.0, -1.0):
            columns = []
            for i, change in enumerate(sense * changes):
                state = solver.y.copy()
                state[i] += change
                columns.append((rate(state) - here) / change)
            found.append(np.linalg.eigvals(np.transpose(columns)))
    steps = int(solver.control["steps"][0]) - before
    return np.array(found).reshape(INSTANTS, -1), float(steps)


def print_rates(oiled: pw.Scene, words: str, tolerance: float) -> None:
    """Print fastest decay and oscillation of a cycle, and the steps that they need."""
    values, steps = rates(oiled, tolerance)
    decay = np.maximum(-values.real, 0.0).max(axis=1)
    slow = np.median(np.abs(values.imag).max(axis=1)) / (2.0 * np.pi)
    need = decay.mean() * oiled.mechanism.period / STABLE
    print(
        f"{words}: greatest rate {decay.max():.1e} 1/s, above 1e5 1/s for "
        f"{100.0 * (decay > 1e5).mean():.0f} % of the cycle, {need:.0f} steps at the limit of "
        f"stability of {steps:.0f}; median of the fastest oscillation {slow:.0f} Hz"
    )


def main() -> None:
    """Print a line for each clearance and viscosity."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tolerance", type=float, default=1e-7, help="(default 1e-7)")
    parser.add_argument("--restitution", type=float, default=0.8, help="(default 0.8)")
    options = parser.parse_args()
    contact = {"restitution": options.restitution, "replicates": 1}
    press = pw.changed(pw.scene_from(PRESS), {**RIGID, **contact})
    for part in PER_MILLE:
        for viscosity in VISCOSITIES:
            values = {"clearance": 1e-3 * part * RADIUS, "viscosity": viscosity}
            oiled = pw.changed(press, {**values, "film": "run"})
            print_rates(oiled, f"{part} per mille, {viscosity}", options.tolerance)


if __name__ == "__main__":
    main()
