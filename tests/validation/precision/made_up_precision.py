"""A study of speed against error whose numbers are made up, as exactly as a test needs."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from presswear.dynamics.lyapunov import Exponent
from presswear.engines.settings import ExudynJoints
from presswear.recording.sampling import Estimate, Interval
from presswear.scene.catalog import wear_times
from presswear.validation.precision.chaos import Chaos, StatisticPoint
from presswear.validation.precision.diagram import Diagram, Quantity, TaskPoint
from presswear.validation.precision.growth import Parting
from presswear.validation.precision.methods import IMPACT, Method, finest, statistics_methods
from presswear.validation.precision.statistic import StepError
from presswear.validation.precision.study import QUICK, Precision
from presswear.validation.precision.wear import DEEPEST, VOLUME, Group, Varied, WearPoint, WearStudy
from presswear.validation.timing import Timing

Array = NDArray[np.float64]
SCENE = wear_times()
NAMES = tuple(
    f"{kind} at {joint}" for kind in ("wear total", "wear map", "peak force") for joint in "AC"
)
STAGE_CYCLES = 16
DEFAULTS = ("exudyn-tree, DOPRI5, tolerance 1e-08", "dae, DOP853, tolerance 1e-09")
"""Taken by default here, whatever the code takes."""
METHODS = tuple(
    replace(method, is_default=method.label in DEFAULTS) for method in statistics_methods(SCENE)
)


def timing(method: Method, wall: float, steps: int) -> Timing:
    walls = tuple(wall * factor for factor in (0.9, 1.0, 1.3))
    return Timing(method.label, "tree 4", 0.14, steps, steps // 10, 7 * steps, walls)


def diagram(key: str = "horizon", constant: float = 1.0) -> Diagram:
    """Methods of the real ladder whose error is that of their tolerance or step to the fourth."""
    points = []
    for method in METHODS:
        if method.is_paper:
            points.append(TaskPoint(method, failure="the state is no longer finite (t = 0.02 s)"))
            continue
        is_step = method.knob.startswith("step")
        error = constant * (1e15 * method.value**4 if is_step else 100.0 * method.value)
        steps = round(1.0 / method.value if is_step else 100.0 * method.value**-0.2)
        errors = {
            "slider position": error,
            "slider velocity": 50.0 * error,
            "energy residual / exchanged": error / 10.0,
        }
        timed = timing(method, 2e-5 * steps, steps)
        points.append(TaskPoint(method, errors, {"touches": 54.0}, 2.5, timed))
    for count in (20, 50):
        engine = ExudynJoints(count, 10, free_step=1e-4)
        method = Method(engine, "trapezoidal rule", IMPACT, count)
        points.append(TaskPoint(method, failure="3 of the first 10 touches missing"))
    return Diagram(
        key,
        f"Task <{key}>",
        "Something that runs & ends.",
        (
            Quantity("slider position", "m", 1e-8),
            Quantity("slider velocity", "m/s", 1e-6),
            Quantity("energy residual / exchanged", ""),
        ),
        "a run at 1e-13",
        tuple(points),
    )


def statistic_point(method: Method, bias: float, bound: float, cost: float) -> StatisticPoint:
    """Every statistic has the mean 1 and the same difference."""
    if method.is_paper:
        return StatisticPoint(method, failure="start 1: the state is no longer finite")
    seen = bias - 0.03 > 0.0
    step = StepError(bias, 0.01 if seen else -0.03, bias + 0.03, bound)
    return StatisticPoint(
        method,
        (0.9 * cost, cost, 1.1 * cost),
        2.0,
        100.0,
        10_000,
        {name: Estimate(1.0 + bias, 0.02, 100) for name in NAMES},
        dict.fromkeys(NAMES, step),
    )


def parting(time: Array, apart: Array, touches: Array) -> Parting:
    return Parting(tuple(time.tolist()), tuple(apart.tolist()), tuple(touches.astype(int).tolist()))


def chaos(coarsest_honest: float = 1e-6, bound: float = 0.03) -> Chaos:
    """Settings coarser than one tolerance are biased by a tenth, finer ones are honest."""
    reference = statistic_point(finest(SCENE), 0.0, 0.0, 0.3)
    points = []
    for method in METHODS:
        fine = method.value <= 1.001 * coarsest_honest and method.knob == "tolerance"
        cost = 0.05 * method.value**-0.1
        points.append(statistic_point(method, 0.0 if fine else 0.1, bound if fine else 0.15, cost))
    time = np.linspace(0.0, 0.57, 400)
    apart = np.minimum(1e-9 * np.exp(77.0 * np.maximum(time - 0.05, 0.0)), 1e-3)
    growth = parting(time, apart, np.floor(200.0 * time))
    return Chaos(growth, Exponent(33.0, 4.0, 360), reference, tuple(points), STAGE_CYCLES)


def interval(value: float, part: float = 0.05) -> Interval:
    return Interval(value, (1.0 - part) * value, (1.0 + part) * value)


def joint_wears(depth: float, volume: float) -> dict[str, dict[str, Interval]]:
    return {
        joint: {
            DEEPEST: interval(1e-6 * depth * factor),
            VOLUME: interval(1e-9 * volume * factor),
        }
        for joint, factor in (("A", 1.0), ("C", 0.3))
    }


def wear_point(
    group: Group, conventions: str, label: str, value: float | None, depth: float
) -> WearPoint:
    return WearPoint(
        Varied(group, conventions, label, value, label in ("360", "cycle by cycle")),
        joint_wears(depth, 10.0),
        joint_wears(1.2 * depth, 11.0),
        1,
        60,
        3.5,
    )


def wear() -> WearStudy:
    """Depths of the paper's conventions go with the angles, those of the refined do not."""
    points = []
    for conventions in ("paper", "refined"):
        for angles in (90, 360, 1440):
            depth = 10.0 if conventions == "refined" else 3600.0 / angles
            points.append(wear_point("angles", conventions, f"{angles}", angles, depth))
        for cycles in (5, 50, 200):
            depth = 10.0 + 20.0 / cycles
            points.append(wear_point("cycles", conventions, f"{cycles}", cycles, depth))
    for label, depth in (("single jump", 30.0), ("cycle by cycle", 10.0)):
        points.append(wear_point("jump", "refined", label, None, depth))
    points.append(wear_point("contact", "paper", "radial", None, 10.0))
    foundation = Varied("contact", "paper", "foundation", None, False)
    points.append(WearPoint(foundation, failure="stage 1: it blew up"))
    return WearStudy(tuple(points), {"paper": 50, "refined": 20}, "dae, DOPRI5 at tolerance 1e-07")


def precision() -> Precision:
    return Precision(
        SCENE,
        QUICK,
        {
            "packages": {"presswear": "0.1.0", "exudyn": "1.13.6"},
            "python": "3.11.0",
            "revision": "abc",
            "source": "0123456789abcdef",
            "machine": "Linux, 2 cores",
            "started": "2024-01-01T00:00:00Z",
        },
        "A processor <with> & name",
        100.0,
        0.1411,
        (diagram("ideal", 1e-3), diagram("horizon")),
        chaos(),
        wear(),
    )
