"""CPU time of the engines, of scipy on hand-written equations, MuJoCo and Drake at equal error.

usage: python tests/benchmarks/side_by_side.py [--repeats N] [--quick]

Every method runs the first 0.05 s of the unworn press, with ten touchdowns, over its
tolerances or steps from several initial states. The error is the largest one of the
slider and of the ends of the turning links at the end, relative to the in-house solver
at 1e-12. The cost at an error is interpolated between two settings. Simulators that are
not installed are left out.
"""

import argparse
import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from importlib.util import find_spec
from itertools import pairwise
from statistics import median

import numpy as np
from by_hand.equations import (
    OPEN,
    SIZE,
    parameters,
    state_of,
)
from by_hand.loop import run as run_loop
from evaluation import Outcome, evaluate, measured
from scipy.integrate import solve_ivp
from scipy.linalg import null_space
from scipy.stats import gmean
from simulators import SIMULATORS

from presswear.campaign.replicates import start_of
from presswear.engines.base import Plan, Start
from presswear.engines.settings import Engine, InHouse
from presswear.physics.constraints import constraints_of
from presswear.scene.catalog import wear_times
from presswear.scene.scene import Scene
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, specialised
from presswear.tools.errors import RunFailed
from presswear.validation.benchmark_problems import joints_over_impacts

# Function of start and setting that returns the final state and the cost, s/s
Method = Callable[[Start, float], tuple[Array, float]]

END = 0.05  # s
LEVELS = (1e-6, 1e-7, 1e-9)  # m, errors at which costs are compared
APART = 5e-3  # m/s of the slider and rad/s of rod 3 from one initial state to the next
MAX_STOPS = 10  # touchdowns and separations without any time between them
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)
STEPS = (5e-5, 2e-5, 1e-5, 5e-6, 2e-6, 1e-6)  # s
COUNTS = (20.0, 50.0, 100.0, 200.0, 400.0, 800.0)  # steps in an impact
SCIPY = {"LSODA": 7, "DOP853": 7, "Radau": 3}  # number of tolerances; Radau is slow


def solve(
    code: str,
    press: Records,
    start: Array,
    end: float,
    tolerance: float,
    longest: float,
) -> Outcome:
    """Integrate with a code of ``solve_ivp``, which ends its steps at touchdowns."""
    onset = np.full(2, OPEN)
    out = np.zeros(12)
    gaps = np.zeros((2, 2))
    kernel = specialised(evaluate, press, 0.0, start, onset, out, gaps)

    def rates(t: float, y: Array) -> Array:
        kernel(press, t, np.ascontiguousarray(y), onset, out, gaps)
        return out[:SIZE].copy()

    def penetration(k: int) -> Callable[[float, Array], float]:
        def event(t: float, y: Array) -> float:
            kernel(press, t, y, onset, out, gaps)
            return float(gaps[k, 0])

        vars(event)["terminal"] = True
        return event

    events = [penetration(0), penetration(1)]
    options = {
        "rtol": tolerance,
        "atol": tolerance,
        "max_step": longest,
        "events": events,
    }

    def run() -> Array:
        t = 0.0
        y = start.copy()
        stops = 0
        while t < end:
            for k, event in enumerate(events):
                vars(event)["direction"] = -1.0 if onset[k] >= 0.0 else 1.0
            part = solve_ivp(rates, (t, end), y, code, **options)
            stops = 0 if part.t[-1] > t else stops + 1
            if part.status < 0 or stops > MAX_STOPS:
                raise RunFailed(f"{code} at {tolerance:g}: stops at {t:g} s")
            t = float(part.t[-1])
            y = part.y[:, -1].copy()
            kernel(press, t, y, onset, out, gaps)
            for k in (k for k in (0, 1) if part.t_events[k].size):
                onset[k] = OPEN if onset[k] >= 0.0 else max(gaps[k, 1], 0.0)
        return y

    return measured(run)


def initial_states(scene: Scene, count: int) -> list[Start]:
    """Return the initial state of a scene, and others with faster free bodies.

    One state alone may be lucky: the position of a touchdown between two steps makes
    the error.
    """
    linkage = scene.linkage()
    start = start_of(scene)
    free = null_space(
        constraints_of(linkage).evaluate(0.0, start.position, start.velocity)[3]
    )
    places = [3 * linkage.index("slider 6") + 1, 3 * linkage.index("rod 3") + 2]
    faster = free @ free[places].sum(axis=0)
    return [
        replace(start, velocity=start.velocity + APART * k * faster)
        for k in range(count)
    ]


def methods(scene: Scene) -> dict[str, tuple[Sequence[float], Method]]:
    """Return the settings of each method, coarse to fine, and a function that runs it."""
    press = parameters(scene)
    linkage = scene.linkage()
    period = scene.mechanism.period
    numerics = scene.numerics.resolved("trajectory")

    def engine(make: Callable[[float], Engine]) -> Method:
        def run(start: Start, value: float) -> tuple[Array, float]:
            plan = Plan(END, 1, 1, torques=False)
            result = (
                make(value).resolved().for_cycle(period).simulate(linkage, start, plan)
            )
            if result.status == "failed":
                raise RunFailed(result.message)
            return state_of(linkage, result.end), result.cpu / END

        return run

    def equations(solver: Callable[..., Outcome]) -> Method:
        def run(start: Start, value: float) -> tuple[Array, float]:
            longest = numerics.tree.longest(period)
            state, seconds = solver(
                press, state_of(linkage, start), END, value, longest
            )
            return state, seconds / END

        return run

    def joints(count: float) -> Engine:
        each = joints_over_impacts((round(count),), numerics, period)
        return next(method.engine for method in each if method.value == round(count))

    dae = (
        replace(numerics.dae, integrator="dopri5"),
        replace(numerics.dae, integrator="dop853"),
    )
    fine = (1e-3, *TOLERANCES)
    table: dict[str, tuple[Sequence[float], Method]] = {
        "exudyn-tree": (
            TOLERANCES,
            engine(lambda x: replace(numerics.tree, tree_tolerance=x)),
        ),
        "dae, DOPRI5": (
            fine,
            engine(lambda x: replace(dae[0], integration_tolerance=x)),
        ),
        "dae, DOP853": (
            fine,
            engine(lambda x: replace(dae[1], integration_tolerance=x)),
        ),
        "exudyn-joints": (COUNTS, engine(joints)),
    }
    for code, count in SCIPY.items():
        table[f"hand-written, {code}"] = (
            TOLERANCES[:count],
            equations(partial(solve, code)),
        )

    def loop(start: Start, value: float) -> tuple[Array, float]:
        longest = numerics.dae.longest(period)
        outcome = run_loop(press, state_of(linkage, start), [END], value, longest)
        return outcome.states[0, :SIZE], outcome.cpu / END

    table["hand-written loop, DOPRI5"] = fine, loop
    for package, (name, simulate, has_equal_steps) in SIMULATORS.items():
        if find_spec(package) is not None:
            settings = STEPS if has_equal_steps else (1e-3, *TOLERANCES[:-2])
            table[name] = settings, equations(simulate)
    return table


def distance(press: Records, one: Array, two: Array) -> float:
    p = press[0]
    lengths = np.array(
        [np.hypot(p["b_x"], p["b_y"]), p["length_3"], 1.0, p["length_5"]]
    )
    return float(np.abs(lengths * (one - two)[:4]).max())


def cost_at(points: Sequence[tuple[float, float]], error: float) -> float:
    """Return the cost at an error from (error, cost), coarse to fine; nan if none is so accurate.

    The cost is interpolated in logarithms between the last setting that is worse and
    the next.
    """
    worse = [i for i, (size, _) in enumerate(points) if not size <= error]
    if not worse:
        return points[0][1] if points else math.nan
    if worse[-1] + 1 == len(points):
        return math.nan
    (e_1, c_1), (e_2, c_2) = list(pairwise(points))[worse[-1]]
    part = math.log(error / e_1) / math.log(e_2 / e_1)
    return float(c_1 ** (1.0 - part) * c_2**part)


def points_of(
    repeats: int, names: Sequence[str] = (), stride: int = 1
) -> Iterator[tuple[str, list[list[float]]]]:
    """Yield each method with rows of its setting, its error, m, and its cost, s/s.

    ``names`` are beginnings of the names of methods, none for all; of the settings
    every ``stride``-th one runs.
    """
    scene = wear_times()
    press = parameters(scene)
    starts = initial_states(scene, repeats)
    exact = InHouse(integration_tolerance=1e-12, coordinates="all")
    plan = Plan(END, 1, 1, torques=False)
    references = [
        state_of(scene.linkage(), exact.simulate(scene.linkage(), start, plan).end)
        for start in starts
    ]
    for name, (settings, run) in methods(scene).items():
        if names and not name.startswith(tuple(names)):
            continue
        run(starts[0], settings[0])  # compiles
        rows = []
        for value in settings[::stride]:
            try:
                outcomes = [run(start, value) for start in starts]
            except RunFailed as error:
                print(f"{name:24} {value:8.2g} failed: {error}", flush=True)
                continue
            pairs = zip(outcomes, references, strict=True)
            error_m = float(
                gmean([distance(press, end, exact) for (end, _), exact in pairs])
            )
            rows.append([value, error_m, median(cost for _, cost in outcomes)])
            print(
                f"{name:24} {value:8.2g} {error_m:9.1e} m {rows[-1][2]:9.3g} s/s",
                flush=True,
            )
        yield name, rows


def main() -> None:
    """Print cost and error of all methods."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--repeats", type=int, default=5, help="initial states (default 5)"
    )
    parser.add_argument(
        "--quick", action="store_true", help="every second setting only"
    )
    arguments = parser.parse_args()
    for name, rows in points_of(arguments.repeats, stride=2 if arguments.quick else 1):
        points = [(error, cost) for _, error, cost in rows]
        costs = ", ".join(
            f"{cost_at(points, level):.3g} at {level:g} m" for level in LEVELS
        )
        print(f"{name}: s/s {costs}", flush=True)


if __name__ == "__main__":
    main()
