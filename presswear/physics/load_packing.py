"""Loads with a law of their own as records for the kernels."""

import math
from collections.abc import Sequence

import numpy as np

from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import (
    LOAD_PARAMETERS,
    Force,
    Harmonics,
    Moment,
    OverPosition,
    OverTime,
    Table,
)
from presswear.physics.loads import LOAD, MODE, OWN, POSITION, SERIES, TIME, Loads
from presswear.tools.compile import Records, address_of, compile_function
from presswear.tools.user_function import UserFunction

_RISE = 1e-3  # speed from which a load in one sense is whole, m/s or rad/s


def pack_loads(linkage: Linkage) -> Loads | None:
    """The loads of a linkage that have a law."""
    if not linkage.live_loads:
        return None
    loads = np.zeros(len(linkage.live_loads), LOAD)
    for record, load in zip(loads, linkage.live_loads, strict=True):
        record["body"] = 3 * linkage.index(load.body)
        record["turns"] = isinstance(load, Moment)
        if isinstance(load, Force):
            point = load.attachment
            record["x"], record["y"] = point.x, point.y
            record["cosine"], record["sine"] = math.cos(load.direction), math.sin(load.direction)
    return pack_laws(loads, [load.law for load in linkage.live_loads], linkage)


def pack_laws(records: Records, laws: Sequence[object], linkage: Linkage) -> Loads:
    """Loads from records that say where they act, which this fills, and their laws."""
    nodes: list[tuple[float, float]] = []
    for record, law in zip(records, laws, strict=True):
        own = _pack_law(record, law, linkage)
        record["first"], record["count"] = len(nodes), len(own)
        nodes += own
    table = np.array(nodes, dtype=np.float64).reshape(-1, 2)
    return Loads(records, table, np.zeros(len(records), MODE))


def _pack_law(record: Records, law: object, linkage: Linkage) -> list[tuple[float, float]]:
    """Fill the law of a record; returns its nodes."""
    if isinstance(law, OverTime):
        period = linkage.period if law.period is None else law.period
        record["kind"], record["held"], record["period"] = TIME, True, period
        return _whole_period(law.table, period)
    if isinstance(law, OverPosition):
        record["kind"], record["held"] = POSITION, law.outside == "hold"
        record["period"], record["zero"] = 0.0, law.zero
        record["sense"] = {"both": 0.0, "along": 1.0, "against": -1.0}[law.sense]
        record["rise"], record["release"] = _RISE, law.release
        record["unloading"] = law.unloading
        return list(law.table)
    if isinstance(law, UserFunction):
        record["kind"] = OWN
        record["own"] = address_of(compile_function(law, LOAD_PARAMETERS), len(LOAD_PARAMETERS))
        return []
    record["kind"] = SERIES
    if isinstance(law, Harmonics):
        record["mean"], record["frequency"] = law.mean, law.frequency
        return list(law.harmonics)
    record["mean"] = law
    return []


def _whole_period(table: Table, period: float) -> list[tuple[float, float]]:
    """A table from 0 to its period, with what lies between its last node and its first."""
    nodes = list(table)
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
