"""Loads of a linkage as records for the kernels, and their sizes in a recorded motion."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.load_laws import (
    LOAD_PARAMETERS,
    Harmonics,
    OverPosition,
    OverTime,
)
from presswear.linkage.loads import Force, Moment
from presswear.physics.load_transitions import place_loads, settle_loads
from presswear.physics.loads import (
    LOAD,
    MODE,
    POSITION,
    SERIES,
    TIME,
    USER,
    Loads,
    load_motion,
    load_size,
)
from presswear.tools.arrays import Array
from presswear.tools.compile import Records, address_of, compiled
from presswear.tools.user_function import UserFunction, compile_function


@compiled
def _follow_sizes(loads: Loads, motion: Array, sizes: Array, levels: Array) -> None:
    """Fill the sizes of ``sizes_over``; ``levels`` is room for the motion of one body."""
    q, v, a = levels
    q[0], v[0] = motion[0, 1], motion[0, 2]
    place_loads(loads, q, v)
    for i in range(motion.shape[0]):
        t = motion[i, 0]
        q[0], v[0], a[0] = motion[i, 1], motion[i, 2], motion[i, 3]
        settle_loads(loads, t, q, v, a)
        for k in range(loads.records.shape[0]):
            load = loads.records[k]
            s, speed, _ = load_motion(load, q, v, a)
            sizes[i, k] = load.cosine * load_size(
                load, loads.nodes, loads.modes[k], t, s, speed
            )


def sizes_over(laws: Iterable[OverPosition], linkage: Linkage, motion: Array) -> Array:
    """Return the sizes of loads over one coordinate in a recorded motion, shape (n, loads), N.

    They are in the modes of the run that recorded it: a row stands at every change of
    them. Columns of ``motion`` are time, s, and place, m, velocity and acceleration
    along the loads' direction.
    """
    chosen = tuple(laws)
    records = np.zeros(len(chosen), LOAD)
    records["cosine"] = 1.0
    loads = _pack_laws(records, chosen, linkage)
    sizes = np.zeros((len(motion), len(chosen)))
    if sizes.size:
        _follow_sizes(loads, np.ascontiguousarray(motion), sizes, np.zeros((3, 3)))
    return sizes


def pack_loads(linkage: Linkage) -> Loads | None:
    """Return the loads of a linkage that have a law."""
    if not linkage.live_loads:
        return None
    loads = np.zeros(len(linkage.live_loads), LOAD)
    loads["cosine"] = 1.0
    for record, load in zip(loads, linkage.live_loads, strict=True):
        record["body"] = 3 * linkage.index(load.body)
        record["turns"] = isinstance(load, Moment)
        if isinstance(load, Force):
            point = load.attachment
            record["x"], record["y"] = point.x, point.y
            record["cosine"] = math.cos(load.direction)
            record["sine"] = math.sin(load.direction)
    return _pack_laws(loads, [load.law for load in linkage.live_loads], linkage)


def _pack_laws(records: Records, laws: Sequence[object], linkage: Linkage) -> Loads:
    """Return loads from their laws and from records of where they act, which are filled."""
    nodes: list[tuple[float, float]] = []
    for record, law in zip(records, laws, strict=True):
        table: Sequence[tuple[float, float]] = ()
        if isinstance(law, OverTime):
            period = linkage.period if law.period is None else law.period
            record["kind"] = TIME
            record["is_constant_outside"] = True
            record["period"] = period
            table = _whole_period(law, period)
        elif isinstance(law, OverPosition):
            record["kind"] = POSITION
            record["is_constant_outside"] = law.outside == "hold"
            record["sense"] = {"both": 0.0, "along": 1.0, "against": -1.0}[law.sense]
            record["zero"] = law.zero
            record["release"] = law.release
            record["unloading"] = law.unloading
            table = law.table
            if law.sense == "against":
                for name in ("cosine", "sine", "zero"):
                    record[name] *= -1.0
                table = [(-place, -size) for place, size in reversed(table)]
        elif isinstance(law, UserFunction):
            kernel = compile_function(law, LOAD_PARAMETERS)
            record["kind"] = USER
            record["address"] = address_of(kernel, len(LOAD_PARAMETERS))
        elif isinstance(law, Harmonics):
            record["kind"] = SERIES
            table = law.harmonics
            record["mean"] = law.mean
            record["frequency"] = law.frequency
        else:
            record["kind"] = SERIES
            record["mean"] = law
        record["first"] = len(nodes)
        record["count"] = len(table)
        nodes += table
    points = np.array(nodes, dtype=np.float64).reshape(-1, 2)
    return Loads(records, points, np.zeros(len(records), MODE))


def _whole_period(law: OverTime, period: float) -> list[tuple[float, float]]:
    """Return a table from 0 to its period, with what lies between its last node and its first."""
    nodes = list(law.table)
    if period == 0.0:
        return nodes
    (x0, y0), (x1, y1) = nodes[0], nodes[-1]
    gap = x0 + period - x1
    edge = y1 + (y0 - y1) * (period - x1) / gap if gap > 0.0 else y1
    if x0 > 0.0:
        nodes.insert(0, (0.0, edge))
    if x1 < period:
        nodes.append((period, edge))
    return nodes
