"""Hand-written adaptive loop for the press: DOPRI5 whose steps end on touchdowns and separations.

usage: python tests/benchmarks/adaptive.py [--repeats N]

It solves the equations of ``by_hand`` and shares no kernel with the engines. Task a is the first
0.05 s of the unworn press with ten touchdowns; its error is the largest of the slider and of the
ends of the turning links, relative to the in-house solver at 1e-12. Task b is a number of cycles;
its error is that of the work per cycle (normal force times slip) at A and C, as in ``presswear
benchmark``. All times are CPU times per simulated second.
"""

import argparse
import math
import time as clock
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from by_hand import OPEN, SIZE, accelerations, cranks, parameters, state_of
from side_by_side import distance, methods

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan
from presswear.engines.settings import LEAST_STEPS, InHouse
from presswear.recording.statistics import STARTUP_CYCLES, after_startup
from presswear.scene.catalog import wear_times
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, compiled
from presswear.validation.benchmark import measure
from presswear.validation.benchmark_problems import QUICK, wear_cycles, work_per_cycle

END = 0.05  # s
MAX_APART = 1e-7  # m, distance of the last tolerance from the in-house solver
TOLERANCES = (1e-5, 1e-6, 1e-8)
ENGINES = {  # with tolerances, or steps in a contact
    "exudyn-tree": (1e-5, 1e-8),
    "dae, DOPRI5": (1e-5, 1e-6, 1e-8),
    "exudyn-joints": (50.0, 200.0),
}
STAGES = 7
WIDTH = SIZE + 2  # of the state: with the load distance at A and C
NEAR = 1e-14  # m, penetration at which a touchdown or a separation is located


@compiled
def rates(press: Records, t: float, y: Array, onset: Array, out: Array, gaps: Array) -> None:
    """Fill rates of coordinates, velocities and load distances, and the gaps, shape (2, 2)."""
    x, u = (y[0], y[1], y[2], y[3]), (y[4], y[5], y[6], y[7])
    a, _, one, two = accelerations(press, cranks(press, t), onset, x, u)
    for i in range(4):
        out[i], out[4 + i] = u[i], a[i]
    out[8], out[9] = one.load, two.load
    gaps[0, 0], gaps[0, 1] = one.depth, one.rate
    gaps[1, 0], gaps[1, 1] = two.depth, two.rate


@compiled
def step(
    press: Records,
    t: float,
    h: float,
    y: Array,
    onset: Array,
    k: Array,
    z: Array,
    gaps: Array,
    tolerance: float,
) -> float:
    """Step from ``y``, whose rates are ``k[0]``, to ``z``; return the error over the allowed."""
    for i in range(WIDTH):
        z[i] = y[i] + h * 0.2 * k[0, i]
    rates(press, t + 0.2 * h, z, onset, k[1], gaps)
    for i in range(WIDTH):
        z[i] = y[i] + h * (3 / 40 * k[0, i] + 9 / 40 * k[1, i])
    rates(press, t + 0.3 * h, z, onset, k[2], gaps)
    for i in range(WIDTH):
        z[i] = y[i] + h * (44 / 45 * k[0, i] - 56 / 15 * k[1, i] + 32 / 9 * k[2, i])
    rates(press, t + 0.8 * h, z, onset, k[3], gaps)
    for i in range(WIDTH):
        part = 19372 / 6561 * k[0, i] - 25360 / 2187 * k[1, i]
        z[i] = y[i] + h * (part + 64448 / 6561 * k[2, i] - 212 / 729 * k[3, i])
    rates(press, t + 8 / 9 * h, z, onset, k[4], gaps)
    for i in range(WIDTH):
        part = 9017 / 3168 * k[0, i] - 355 / 33 * k[1, i] + 46732 / 5247 * k[2, i]
        z[i] = y[i] + h * (part + 49 / 176 * k[3, i] - 5103 / 18656 * k[4, i])
    rates(press, t + h, z, onset, k[5], gaps)
    for i in range(WIDTH):
        part = 35 / 384 * k[0, i] + 500 / 1113 * k[2, i] + 125 / 192 * k[3, i]
        z[i] = y[i] + h * (part - 2187 / 6784 * k[4, i] + 11 / 84 * k[5, i])
    rates(press, t + h, z, onset, k[6], gaps)
    worst = 0.0
    for i in range(SIZE):
        part = 71 / 57600 * k[0, i] - 71 / 16695 * k[2, i] + 71 / 1920 * k[3, i]
        part += -17253 / 339200 * k[4, i] + 22 / 525 * k[5, i] - 1 / 40 * k[6, i]
        worst = max(worst, abs(h * part) / (tolerance * (1.0 + abs(y[i]))))
    return worst


@compiled
def crossing(h: float, before: Array, after: Array) -> float:
    """Return the part of a step at which a penetration is zero, from a cubic through both ends."""
    low, high = 0.0, 1.0
    if before[0] * after[0] >= 0.0:
        return 1.0
    for _ in range(50):
        s = 0.5 * (low + high)
        rest = 1.0 - s
        depth = rest * rest * ((1.0 + 2.0 * s) * before[0] + s * h * before[1])
        depth += s * s * ((1.0 + 2.0 * rest) * after[0] - rest * h * after[1])
        if depth * before[0] > 0.0:
            low = s
        else:
            high = s
    return high


@compiled
def march(
    press: Records,
    start: float,
    end: float,
    y: Array,
    onset: Array,
    tolerance: float,
    longest: float,
    work: Array,
    gaps: Array,
) -> None:
    """Integrate ``y`` to the end; steps end on touchdowns and separations."""
    k, z, before, now = work[:STAGES], work[STAGES], gaps[0], gaps[1]
    t, h = start, 1e-6
    rates(press, t, y, onset, k[0], before)
    while t < end:
        h = min(h, longest, end - t)
        error = step(press, t, h, y, onset, k, z, now, tolerance)
        if error > 1.0:
            h *= max(0.2, 0.9 * error**-0.2)
            continue
        following = h * min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
        part, joint = 2.0, -1
        for i in range(2):
            if (now[i, 0] > 0.0) != (onset[i] >= 0.0):
                at = crossing(h, before[i], now[i])
                if at < part:
                    part, joint = at, i
        if joint >= 0 and part < 1.0:
            h *= part
            for trial in range(5):
                step(press, t, h, y, onset, k, z, now, tolerance)
                if abs(now[joint, 0]) < NEAR or trial == 4:
                    break
                h -= now[joint, 0] / now[joint, 1]
        t += h
        for i in range(WIDTH):
            y[i], k[0, i] = z[i], k[6, i]
        if joint >= 0:
            onset[joint] = OPEN if onset[joint] >= 0.0 else max(now[joint, 1], 0.0)
            rates(press, t, y, onset, k[0], now)
        for i in range(2):
            before[i, 0], before[i, 1] = now[i, 0], now[i, 1]
        h = following


def run(
    press: Records, start: Array, ends: Sequence[float], tolerance: float, longest: float
) -> tuple[Array, float]:
    """Return the state at each end, shape (ends, 10), and the CPU time, s."""
    y, onset = np.append(start, (0.0, 0.0)), np.full(2, OPEN)
    work, gaps, states, t = np.zeros((STAGES + 1, WIDTH)), np.zeros((2, 2, 2)), [], 0.0
    started = clock.process_time()
    for end in ends:
        march(press, t, end, y, onset, tolerance, longest, work, gaps)
        states.append(y.copy())
        t = end
    return np.array(states), clock.process_time() - started


def main() -> None:
    """Print errors and CPU times of both tasks, for the engines and for the hand-written loop."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeats", type=int, default=5, help="repeats of each run (default 5)")
    repeats = parser.parse_args().repeats
    scene = wear_times()
    linkage, start, period = scene.linkage(), start_of(scene), scene.mechanism.period
    press, longest, y = parameters(scene), period / LEAST_STEPS, state_of(linkage, start)
    plan = Plan(END, 1, 1, torques=False)
    exact = InHouse(integration_tolerance=1e-12, coordinates="all").simulate(linkage, start, plan)
    end = state_of(linkage, exact.end)
    problem = wear_cycles(scene, QUICK, lambda *_: None)
    long = replace(problem.plan, cycles=QUICK.reference_cycles)
    mean = work_per_cycle(InHouse("dopri5", 1e-8).simulate(linkage, start, long)).mean(axis=0)
    interval = ", ".join(f"{100.0 * value:.0f} %" for value in problem.quantities.values())
    counted = problem.plan.cycles - STARTUP_CYCLES
    print(f"error b: of the work per cycle over {counted} cycles, the larger one of A and C")
    print(f"95 % interval of this error at A and C, from chaos alone: {interval}")
    print(f"{'method':34}{'error a (m)':>12}{'a (s/s)':>10}{'error b (%)':>12}{'b (s/s)':>10}")

    def show(name: str, *numbers: float) -> None:
        error_a, a, error_b, b = (f"{x:.2g}" if math.isfinite(x) else "-" for x in numbers)
        print(f"{name:34}{error_a:>12}{a:>10}{error_b:>12}{b:>10}", flush=True)

    table = methods(scene)
    for name, values in ENGINES.items():
        engine_run = table[name][1]
        for value in values:
            ends = [engine_run(start, value) for _ in range(repeats + 1)]
            chosen = [
                each
                for each in problem.methods
                if each.value == value and name in (each.family, each.engine.word)
            ][:1]
            points = measure(replace(problem, methods=tuple(chosen)), 2, lambda *_: None)
            b = [
                (100.0 * max(p.errors.values()), p.timing.cpu / p.timing.simulated)
                for p in points
                if p.timing
            ]
            numbers = distance(press, ends[0][0], end), min(cost for _, cost in ends)
            show(f"{name} {value:g}", *numbers, *(b[0] if b else (math.nan, math.nan)))
    cycles = (period * np.arange(problem.plan.cycles + 1)[1:]).tolist()
    for tolerance in TOLERANCES:
        one = [run(press, y, [END], tolerance, longest) for _ in range(repeats + 1)]
        two = [run(press, y, cycles, tolerance, longest) for _ in range(repeats + 1)]
        apart = distance(press, one[0][0][0, :SIZE], end)
        work = after_startup(np.diff(two[0][0][:, SIZE:], axis=0, prepend=0.0))
        show(
            f"by hand, DOPRI5 {tolerance:g}",
            apart,
            min(cpu for _, cpu in one) / END,
            100.0 * float(np.abs(work.mean(axis=0) / mean - 1.0).max()),
            min(cpu for _, cpu in two) / cycles[-1],
        )
    if apart > MAX_APART:
        raise SystemExit(f"at {TOLERANCES[-1]:g} the loop is {apart:.2g} m off the in-house solver")


if __name__ == "__main__":
    main()
