"""Linkages: assembled from their parts, written and read back, and refused in one line."""

import copy
import json
import math
import tomllib
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.linkage.drives import RISES, Drive, Follow, Rise
from presswear.linkage.elements import GROUND, Attachment, Bar, Body, Guide, OutputPoint, Pin
from presswear.linkage.linkage import (
    MAX_TURNS,
    Linkage,
    assemble,
    linkage_from,
    toml_of,
    values_of,
)
from presswear.linkage.loads import (
    Force,
    Harmonics,
    Load,
    Moment,
    OverPosition,
    OverTime,
    Spring,
)
from presswear.linkage.mechanisms import FOUR_BAR, GEOMETRIES, Press, SliderCrank
from presswear.tools.errors import InputError, one_line
from presswear.tools.user_function import UserFunction

LOADED = FOUR_BAR.changed(
    springs=[Spring("s", Attachment("rocker", 0.0, 0.01), Attachment(GROUND, 0.3, 0.1), 50.0, 0.1)],
    loads=[Load("coupler", y=-3.0, moment=0.1)],
    output=OutputPoint("coupler", 0.3, 0.01, 0.02),
    cycle=0.5,
    gravity=0.0,
    name="loaded",
)


def brake(speed: float) -> float:
    """A text with "quotes" and lines."""
    return -0.1 * speed


def wobble(time: float, speed: float) -> float:
    return math.sin(time) - speed


TABLE = OverPosition([(-0.1, 0.0), (0.1, -5.0)], "along", "hold", 0.02, True, unloading=30.0)
LIVELY = FOUR_BAR.changed(
    loads=[
        Load("coupler", y=-3.0),
        Force("rocker.head", 0.3, 5.0),
        Force("rocker", 0.3, TABLE, "brake"),
        Force(Attachment("rocker", 0.01, 0.02), -1.0, OverTime([(0.0, 1.0), (0.1, 5.0)])),
        Force("rocker.head", 0.3, OverTime([(0.0, 1.0), (0.1, 5.0)], 0.0)),
        Force("rocker.head", 0.3, Harmonics(0.1, 30.0, [(1.0, 2.0)])),
        Moment("crank", OverPosition([(0.0, 0.0), (1.0, 5.0)], outside="hold")),
        Moment("crank", OverTime([(0.0, 1.0)], 0.5)),
        Moment("crank", Harmonics(1.0)),
        Moment("crank", brake),
    ],
    drives=[replace(FOUR_BAR.drives[0], torque_limit=4.0)],
    name="lively",
)
EVERY = [
    FOUR_BAR,
    LOADED,
    LIVELY,
    SliderCrank().linkage(),
    *(Press(geometry=geometry).linkage() for geometry in GEOMETRIES.values()),
]


def table_of(linkage: Linkage) -> dict[str, Any]:
    """Return a linkage as it is read from a file."""
    data: dict[str, Any] = tomllib.loads(toml_of(linkage))["mechanism"]
    return data


@pytest.mark.parametrize("linkage", EVERY, ids=lambda linkage: linkage.name)
def test_a_linkage_is_read_back_bit_for_bit(linkage: Linkage) -> None:
    stored = json.loads(json.dumps(linkage.as_plain()))
    assert linkage_from(stored, "here") == linkage
    assert linkage_from(table_of(linkage), "here") == linkage


def test_every_value_is_listed_with_its_unit() -> None:
    values = {key: (value, text) for key, value, text in values_of(LOADED)}
    assert values["springs[0].stiffness"] == ("50.0 N/m", "stiffness")
    assert values["joints[1].first"][0] == "crank.head"
    assert values["bodies[0].length"][0] == "0.05 m"
    assert values["guess"][0] == "{ coupler = 0.6 rad, rocker = 1.4 rad }"
    assert values["cycle"][0] == "0.5 s"
    lively = {key: value for key, value, _ in values_of(LIVELY)}
    assert lively["loads[1].law"] == "5.0 N"
    assert "table = [[-0.1 m, 0.0 N], [0.1 m, -5.0 N]]" in lively["loads[2].law"]


def row_of(key: str, row: Any, **more: Any) -> dict[str, Any]:
    """Return the four-bar as a file has it, with one row of a table in place of its rows."""
    return {**table_of(FOUR_BAR), key: [row], **more}


def test_the_output_point_moves_along_its_guide() -> None:
    whole = Press().linkage().changed(output="slider 6.centre")
    assert whole.output == Press().linkage().output
    assert FOUR_BAR.changed(output="").output == OutputPoint("rocker")
    assert assemble([Body("a", 1.0, 1.0)], direction="90 deg").output.direction == 0.5 * math.pi


def test_a_bar_is_a_thin_rod_with_its_ends() -> None:
    bar = Bar("b", length="20 cm", mass="300 g")
    assert bar == Body("b", 0.3, 0.3 * 0.2**2 / 12.0, {"tail": (-0.1, 0.0), "head": (0.1, 0.0)})
    with pytest.raises(InputError, match=r"length of b = -1 m: allowed is 1e-06 to"):
        Bar("b", length=-1, mass=0.3)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        (
            {"joints": [Pin("O", (0, 0), "crnk.tail")]},
            "unknown body in joint O 'crnk'; did you mean",
        ),
        ({"joints": [Pin("O", (0, 0), "crank.tial")]}, "unknown point of crank in joint O 'tial'"),
        ({"joints": [Guide("g", "slider")]}, "unknown body in guide g 'slider'"),
        ({"drives": [Drive("crank", 1.0), Drive("crank", 2.0)]}, "drive of crank: the name stands"),
        ({"drives": [Drive("cank", 1.0)]}, "unknown body in drives 'cank'; did you mean crank"),
        ({"guess": {"rod": 1.0}}, "unknown body in guess 'rod'"),
        ({"loads": [Load("rod")]}, "unknown body in loads 'rod'"),
        ({"loads": [Force("rocker.haed", 0.0, 1.0)]}, "unknown point of rocker in loads 'haed'"),
        ({"loads": [Moment("frame", wobble)]}, "unknown body in loads 'frame'"),
        (
            {"loads": [Moment("crank", OverTime([(0.0, 1.0), (0.3, 2.0)]))]},
            "with a cycle of 0.20944 s allowed",
        ),
        ({"output": "rocker.nose"}, "unknown point of rocker in output 'nose'"),
        ({"bodies": [*FOUR_BAR.bodies, FOUR_BAR.bodies[0]]}, "body crank: the name stands twice"),
        ({"bodies": []}, "bodies: at least one is needed"),
        ({"drives": [Drive("crank", 30.0, follow=Follow("rocker.haed"))]}, "'haed'; did you mean"),
        ({"run_up": 1.5}, "run_up = 1.5: a whole number"),
        ({"gravity": "fast"}, "gravity = 'fast' is not a number"),
    ],
)
def test_parts_that_do_not_fit_together_are_refused(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        FOUR_BAR.changed(**changes)


ENDS = [(0.0, 0.0), (1.0, 5.0), (2.0, 0.0)]
SHEET = [(0.0, 0.0), (1.0, -5.0), (2.0, -6.0)]


@pytest.mark.parametrize(
    ("law", "values", "says"),
    [
        (OverTime, {"table": []}, "table: one row or more"),
        (OverTime, {"table": 3}, "table = 3: a list is expected"),
        (OverTime, {"table": [(0, 0), (0, 1)]}, r"table\[1\]: 0 does not lie above 0"),
        (OverTime, {"table": [(0, 0), (1, math.nan)]}, r"table\[1\]\[1\] = nan N or N m: allowed"),
        (OverTime, {"table": [(0, 0), (3, 1)], "period": 2.0}, "period of 2 s allowed is 0 to 2 s"),
        (OverPosition, {"table": [(1, 0), (0, 0)]}, r"table\[1\]: 0 does not lie above 1"),
        (OverPosition, {"table": [(0, 1), (1, 0)]}, "1 N or N m at the end, 0 m or rad, would be"),
        (OverPosition, {"table": ENDS, "sense": "allong"}, "sense = 'allong'.*did you mean along"),
        (OverPosition, {"table": ENDS, "sense": "along"}, "5 N or N m at 1 .*would drive"),
        (OverPosition, {"table": ENDS, "release": True}, "release: it needs a table"),
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
        (Harmonics, {"harmonics": [(1, 1)]}, "frequency = 0 rad/s: with harmonics"),
        (Moment, {"body": "crank", "law": 1.0}, "use Load for a constant moment"),
        (Moment, {"body": "crank", "law": "f.py:f"}, "there is no file"),
        (Force, {"point": "crank", "direction": 0.0, "law": None}, "law = None: a number"),
        (Force, {"point": "crank", "direction": 0.0, "law": math.pow}, "source of .* be read"),
        (Rise, {"start": 1.0, "end": 0.5, "by": 1.0}, "a rise from 1 to 0.5 rad: it must begin"),
        (Drive, {"body": "crank", "harmonics": [(0.0, 1.0)]}, "frequency of crank = 0 rad/s"),
        (Follow, {"point": "a", "rises": [Rise(0.0, 1.0, 0.1)]}, "must come back"),
    ],
)
def test_a_part_that_does_not_fit_is_refused(law: Any, values: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        law(**values)
    assert "\n" not in str(refusal.value)


def test_a_user_law_has_known_parameters() -> None:
    def of_angle(angle: float) -> float:
        return angle

    with pytest.raises(InputError, match="unknown parameter of of_angle in law of crank 'angle'"):
        Moment("crank", of_angle)
    assert isinstance(Moment("crank", wobble).law, UserFunction)


@pytest.mark.parametrize(
    ("speeds", "turns"), [((30.0,), 1), ((30.0, -30.0), 1), ((30.0, 20.0), 3), ((2.0, 3.0), 2)]
)
def test_the_cycle_follows_from_the_drives(speeds: tuple[float, ...], turns: int) -> None:
    names = ("crank", "coupler", "rocker")
    drives = [Drive(name, speed) for name, speed in zip(names, speeds, strict=False)]
    period = FOUR_BAR.changed(drives=drives).period
    assert period == pytest.approx(2.0 * math.pi * turns / abs(speeds[0]))


def test_a_missing_cycle_is_asked_for() -> None:
    for drives in ([], [Drive("crank", 1.0), Drive("rocker", math.pi)]):
        with pytest.raises(InputError, match="it is needed, s"):
            _ = FOUR_BAR.changed(drives=drives).period
    assert FOUR_BAR.changed(drives=[], cycle="2 s").period == 2.0


@given(st.lists(st.integers(1, 63), min_size=2, max_size=4))
def test_a_cycle_of_drives_has_few_turns(turns: list[int]) -> None:
    """Whole ratios of any size: no common cycle of more turns than allowed is accepted."""
    names = [f"crank {k}" for k in range(len(turns))]
    linkage = assemble(
        [Bar(name, 0.05, 0.3) for name in names],
        [Pin(f"O {k}", (0.2 * k, 0.0), f"crank {k}.tail") for k in range(len(turns))],
        [Drive(name, 3000.0 / turn) for name, turn in zip(names, turns, strict=True)],
    )
    if math.lcm(*turns) / min(turns) <= MAX_TURNS:
        assert linkage.period == pytest.approx(2.0 * math.pi * math.lcm(*turns) / 3000.0)
    else:
        with pytest.raises(InputError, match="cycle of linkage"):
            _ = linkage.period


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("bodies", 0, "mass"), "0.3", r"mass of crank = '0\.3' has no unit"),
        (("bodies", 0, "mass"), "0.3 m", r"unknown unit 'm'; known are kg, g, t"),
        (("bodies", 0, "mass"), "-1 kg", r"mass of crank = -1 kg: allowed is 1e-09 to"),
        (("bodies", 0, "mass"), None, r"bodies\[0\]: mass is missing"),
        (("bodies", 0, "mas"), "1 kg", r"unknown key of bodies\[0\] 'mas'; did you mean mass"),
        (("bodies", 0), 3, r"bodies\[0\] = 3: a Body is expected"),
        (("joints", 0, "second"), "crank.tale", "unknown point of crank in joint O 'tale'"),
        (("joints", 0, "first"), ["1 m", "2"], r"first\[1\] of O = '2' has no unit"),
        (("joints", 0, "secnd"), "crank.tail", r"key of joints\[0\] 'secnd'; did you mean second"),
        (("drives", 0, "speed"), "30 rpn", "unknown unit 'rpn'"),
        (("guess", "coupler"), "fast", "guess.coupler = 'fast' is not a number"),
        (("bodys",), [], "unknown key of here 'bodys'; did you mean bodies"),
        (("run_up",), 2000, "run_up = 2000: allowed is 0 to 1000"),
        (("drives", 0, "table"), [["0 deg", "1"]], r"table\[0\]\[1\] of crank = '1' has no unit"),
        (("drives", 0, "rises"), [{"start": 0, "end": "9 deg"}], "by is missing"),
        (("drives", 0, "follow"), {}, "follow of crank: point is missing"),
        (("drives", 0, "table"), [[0, 0], ["60 deg", "5 deg"]], "2 rows; allowed are 3 to 512"),
        (("loads",), [{"body": "crank", "law": {"kind": "over"}}], "unknown kind of law"),
        (("loads",), [{"point": "rocker", "law": "1 N"}], "direction is missing"),
    ],
)
def test_plain_data_that_does_not_fit_is_refused(path: Any, value: Any, says: str) -> None:
    data = copy.deepcopy(table_of(FOUR_BAR))
    owner: Any = data
    for key in path[:-1]:
        owner = owner[key]
    if value is None:
        del owner[path[-1]]
    else:
        owner[path[-1]] = value
    with pytest.raises(InputError, match=says) as refusal:
        linkage_from(data, "here")
    assert "here" in str(refusal.value)
    assert "\n" not in str(refusal.value)


numbers = st.floats(-1e3, 1e3)
pairs = st.lists(st.tuples(numbers, numbers), max_size=16)
rows = st.tuples(
    st.lists(st.tuples(numbers, numbers, numbers), min_size=3, max_size=30), st.sampled_from([1, 3])
).map(
    lambda pair: [
        (k * 2.0 * math.pi / len(pair[0]), *row[: pair[1]]) for k, row in enumerate(pair[0])
    ]
)
swings = st.tuples(
    st.floats(0.0, 2.0), st.floats(0.1, 2.0), numbers, st.sampled_from([*RISES])
).map(
    lambda one: [
        Rise(one[0], one[0] + one[1], one[2], one[3]),
        Rise(one[0] + one[1] + 0.5, one[0] + one[1] + 1.5, -one[2]),
    ]
)
motions = st.one_of(
    st.fixed_dictionaries({"harmonics": pairs, "table": rows}),
    st.fixed_dictionaries({"harmonics": pairs, "rises": swings}),
)
curves = st.builds(
    lambda motion, direction: Follow("rocker.head", direction, **motion),
    motions,
    st.one_of(st.none(), numbers),
)
any_drive = st.builds(
    lambda speed, angle, frequency, motion: Drive("crank", speed, angle, frequency, **motion),
    numbers,
    numbers,
    st.floats(1e-3, 1e3),
    st.one_of(motions, st.fixed_dictionaries({"follow": curves})),
)


@given(any_drive, st.integers(0, 1000))
def test_motions_are_stored_to_the_last_bit(drive: Drive, run_up: int) -> None:
    linkage = FOUR_BAR.changed(drives=[drive], run_up=run_up)
    assert linkage_from(json.loads(json.dumps(linkage.as_plain())), "here") == linkage
    assert linkage_from(table_of(linkage), "here") == linkage


values = st.recursive(
    st.one_of(
        st.integers(-3, 3),
        st.floats(),
        st.booleans(),
        st.text(max_size=4),
        st.sampled_from(["30 deg", "1 rad", "5 mm", "20 rpm", "rocker.head", "cycloidal", "3-4-5"]),
    ),
    lambda inner: st.one_of(
        st.lists(inner, max_size=4),
        st.dictionaries(
            st.sampled_from(["start", "end", "by", "law", "point", "table", "rises", "x"]),
            inner,
            max_size=4,
        ),
    ),
    max_leaves=12,
)
KEYS = ("speed", "angle", "frequency", "harmonics", "table", "rises", "follow", "tabel")


@given(st.dictionaries(st.sampled_from(KEYS), values, min_size=1, max_size=4))
def test_any_drive_is_read_or_refused_in_one_line(row: dict[str, Any]) -> None:
    data = row_of("drives", {"body": "crank", **row})
    message = "here"
    try:
        assert len(linkage_from(data, "here").drives) == 1
    except InputError as error:
        message = str(error)
    assert "here" in message
    assert "\n" not in one_line(message)
