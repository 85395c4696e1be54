"""Laws of loads: what is no law is refused in one line that names it."""

import math
from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.loads import (
    LEAST_GAP,
    Force,
    Harmonics,
    Load,
    Moment,
    OverPosition,
    OverTime,
)
from presswear.linkage.points import Attachment
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction

ENDS = [(0.0, 0.0), (1.0, 5.0), (2.0, 0.0)]
SHEET = [(0.0, 0.0), (1.0, -5.0), (2.0, -6.0)]


def wobble(time: float, speed: float) -> float:
    return math.sin(time) - speed


@pytest.mark.parametrize(
    ("law", "values", "says"),
    [
        (OverTime, {"table": []}, "over_time: a table of one row or more"),
        (OverTime, {"table": 3}, r"table = 3: a list of \(finite number"),
        (OverTime, {"table": [(0, 1, 2)]}, r"table\[0\] = \(0, 1, 2\): a \(finite"),
        (OverTime, {"table": [(0, 0), (0, 1)]}, r"over_time\[1\]: 0 does not lie above 0"),
        (OverTime, {"table": [(0, 0), (1, math.nan)]}, r"table\[1\]\[1\] = nan: a finite"),
        (OverTime, {"table": [(0, 0), (3, 1)], "period": 2.0}, "period of 2 s allowed is 0 to 2 s"),
        (OverTime, {"table": [(0, 0)], "period": -1.0}, "period = -1 s: allowed is 0 to"),
        (OverPosition, {"table": [(1, 0), (0, 0)]}, r"over_position\[1\]: 0 does not lie above 1"),
        (OverPosition, {"table": [(0, 1), (1, 0)]}, "1 N or N m at the end, 0 m or rad, would be"),
        (OverPosition, {"table": ENDS, "sense": "allong"}, "sense = 'allong'.*did you mean along"),
        (OverPosition, {"table": ENDS, "outside": "held"}, "outside = 'held'.*did you mean hold"),
        (
            OverPosition,
            {"table": ENDS, "sense": "along"},
            "5 N or N m at 1 .*would drive",
        ),
        (OverPosition, {"table": ENDS, "rise": 0.0}, "rise = 0 m/s or rad/s: allowed is 1e-09 to"),
        (OverPosition, {"table": ENDS, "release": True}, "release: it needs a table"),
        (OverPosition, {"table": ENDS, "repeats": 1.0}, "with repeats = 1 allowed is 0 to 1"),
        (OverPosition, {"table": [(0, 1), (1, 2)], "repeats": 1.0}, "repeats with a jump from 2"),
        (OverPosition, {"table": ENDS, "unloading": 9.0}, "unloading: it needs a table that acts"),
        (
            OverPosition,
            {"table": SHEET, "sense": "along", "outside": "hold", "unloading": 4.9},
            "unloading = 4.9 N/m or N m/rad: allowed is 5, the steepest rise of the table, to",
        ),
        (
            OverPosition,
            {"table": SHEET[1:], "sense": "along", "outside": "hold", "unloading": 9.0},
            "-5 N or N m at 1 m or rad, where it begins; with unloading allowed is 0",
        ),
        (OverPosition, {"table": SHEET, "unloading": -1.0}, "unloading = -1 N/m or N m/rad: allo"),
        (Harmonics, {"harmonics": [(1, 1)]}, "frequency = 0 rad/s: with harmonics"),
        (Harmonics, {"mean": math.inf}, "mean = inf: a finite number"),
        (Moment, {"body": "crank", "law": 1.0}, "a constant moment is one of Load"),
        (Moment, {"body": "crank", "law": "strong"}, "there is no file"),
        (Force, {"point": "crank", "direction": 0.0, "law": None}, "law = None: a finite"),
        (Force, {"point": "crank", "direction": math.nan, "law": 1.0}, "direction = nan"),
        (Force, {"point": "crank", "direction": 0.0, "law": math.pow}, "source of .* be read"),
    ],
)
def test_what_is_no_law_is_told(law: Any, values: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        law(**values)
    assert "\n" not in str(refusal.value)


def test_a_function_asks_for_what_is_known() -> None:
    def of_angle(angle: float) -> float:
        return angle

    with pytest.raises(InputError, match="unknown parameter of of_angle in law 'angle'"):
        Moment("crank", of_angle)
    assert isinstance(Moment("crank", wobble).law, UserFunction)


@pytest.mark.parametrize(
    ("load", "says"),
    [
        (Load("rod"), "unknown body in loads 'rod'"),
        (Force("rocker.haed", 0.0, 1.0), "unknown point of rocker in loads 'haed'; did you mean"),
        (Force("roker", 0.0, 1.0), "unknown body in loads 'roker'; did you mean rocker"),
        (Moment("frame", wobble), "unknown body in loads 'frame'"),
        (
            Moment("crank", OverTime([(0.0, 1.0), (0.3, 2.0)])),
            "with a cycle of 0.20944 s allowed",
        ),
    ],
)
def test_a_load_on_nothing_is_told(load: Any, says: str) -> None:
    with pytest.raises(InputError, match=says):
        replace(FOUR_BAR, loads=[load])


def test_points_are_found_and_kinds_told_apart() -> None:
    constant, force = Load("crank", y=1.0), Force("rocker.head", 0.0, 1.0)
    linkage = replace(FOUR_BAR, loads=[constant, force, Force("rocker", 0.0, 2.0)])
    assert linkage.dead_loads == (constant,)
    assert [load.law for load in linkage.live_loads] == [1.0, 2.0]
    ends = [load.point for load in linkage.live_loads if isinstance(load, Force)]
    assert ends == [Attachment("rocker", 0.06, 0.0), Attachment("rocker", 0.0, 0.0)]


ROWS = st.lists(
    st.tuples(st.floats(-1e3, 1e3, width=32), st.floats(-1e6, 1e6)), min_size=1, max_size=8
)


@given(ROWS)
def test_a_table_is_taken_where_it_rises(rows: list[tuple[float, float]]) -> None:
    places = [place for place, _ in rows]
    least = LEAST_GAP * (max(places) - min(places))
    rises = all(b - a > least for a, b in pairwise(places))
    for law in (lambda: OverTime(rows, 0.0), lambda: OverPosition(rows, outside="hold")):
        if rises:
            assert law().table == tuple(rows)
        else:
            with pytest.raises(InputError, match="does not lie above"):
                law()
