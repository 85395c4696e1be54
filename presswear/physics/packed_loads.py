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
from presswear.tools.compiled_law import compile_function
from presswear.tools.user_function import UserFunction


@compiled
def _follow_sizes(loads: Loads, time: Array, levels: Array, sizes: Array) -> None:
    """Fill the sizes of ``sizes_in``; ``levels`` are q, v, a, shape (3, n, coordinates)."""
    q, v, a = levels
    place_loads(loads, q[0], v[0])
    for i in range(time.shape[0]):
        settle_loads(loads, time[i], q[i], v[i], a[i])
        for k in range(loads.records.shape[0]):
            load = loads.records[k]
            s, speed, _ = load_motion(load, q[i], v[i], a[i])
            sizes[i, k] = load_size(
                load, loads.nodes, loads.modes[k], time[i], s, speed
            )


def sizes_in(loads: Loads, time: Array, levels: Array) -> Array:
    """Return the sizes of loads along their directions in a motion, shape (n, loads), N or N m.

    The motion is followed from its first instant on. ``levels`` are positions,
    velocities and accelerations of all bodies, shape (3, n, 3 bodies).
    """
    sizes = np.zeros((len(time), len(loads.records)))
    if sizes.size:
        _follow_sizes(loads, np.ascontiguousarray(time), levels, sizes)
    return sizes


def load_forces(loads: Loads, time: Array, levels: Array) -> Array:
    """Return forces and moments of loads on the bodies in a motion; see ``sizes_in``.

    The shape is (n, 3 bodies), N and N m.
    """
    position = levels[0]
    forces = np.zeros_like(position)
    for load, size in zip(loads.records, sizes_in(loads, time, levels).T, strict=True):
        body = int(load["body"])
        along = size * load["cosine"]
        if load["turns"]:
            forces[:, body + 2] += along
            continue
        across = size * load["sine"]
        cosine = np.cos(position[:, body + 2])
        sine = np.sin(position[:, body + 2])
        arm_x = cosine * load["x"] - sine * load["y"]
        arm_y = sine * load["x"] + cosine * load["y"]
        forces[:, body] += along
        forces[:, body + 1] += across
        forces[:, body + 2] += arm_x * across - arm_y * along
    return forces


def sizes_over(laws: Iterable[OverPosition], linkage: Linkage, motion: Array) -> Array:
    """Return the sizes of loads over one coordinate in a recorded motion, shape (n, loads), N.

    The series has a row at every change of a mode of a load, so that the modes are those
    of the run. Columns of ``motion`` are time, s, and position, m, velocity and
    acceleration along the direction of the loads.
    """
    laws = tuple(laws)
    records = np.zeros(len(laws), LOAD)
    records["cosine"] = 1.0
    loads = _pack_laws(records, laws, linkage)
    levels = np.zeros((3, len(motion), 3))
    levels[:, :, 0] = motion[:, 1:].T
    return sizes_in(loads, motion[:, 0], levels) * loads.records["cosine"]


def pack_loads(linkage: Linkage) -> Loads:
    """Return the loads of a linkage that have a law."""
    loads = np.zeros(len(linkage.loads_with_law), LOAD)
    loads["cosine"] = 1.0
    for record, load in zip(loads, linkage.loads_with_law, strict=True):
        record["body"] = 3 * linkage.index(load.body)
        record["turns"] = isinstance(load, Moment)
        if isinstance(load, Force):
            point = load.attachment
            record["x"] = point.x
            record["y"] = point.y
            record["cosine"] = math.cos(load.direction)
            record["sine"] = math.sin(load.direction)
    return _pack_laws(loads, [load.law for load in linkage.loads_with_law], linkage)


def _pack_laws(records: Records, laws: Sequence[object], linkage: Linkage) -> Loads:
    """Return loads from their laws; ``records`` have the points and directions of the loads."""
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
                # In kernels a load acts while its position grows; see LOAD.
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
        else:  # a constant
            record["kind"] = SERIES
            record["mean"] = law
        record["first"] = len(nodes)
        record["count"] = len(table)
        nodes += table
    points = np.array(nodes, dtype=np.float64).reshape(-1, 2)
    return Loads(records, points, np.zeros(len(records), MODE))


def _whole_period(law: OverTime, period: float) -> list[tuple[float, float]]:
    """Return a table from 0 to the period: linear from its last node to its first one."""
    nodes = list(law.table)
    if period == 0.0:
        return nodes
    first_time, first_size = nodes[0]
    last_time, last_size = nodes[-1]
    gap = first_time + period - last_time
    size_at_end = last_size
    if gap > 0.0:
        rise = (first_size - last_size) * (period - last_time) / gap
        size_at_end = last_size + rise
    if first_time > 0.0:
        nodes.insert(0, (0.0, size_at_end))
    if last_time < period:
        nodes.append((period, size_at_end))
    return nodes
