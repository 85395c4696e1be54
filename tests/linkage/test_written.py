"""Linkages as plain data: read back equal, and what is wrong told in one line."""

import copy
import json
import math
import tomllib
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from presswear.linkage.elements import Bar, Body, Guide, Pin
from presswear.linkage.four_bar import FOUR_BAR
from presswear.linkage.linkage import Linkage
from presswear.linkage.loads import (
    Force,
    Harmonics,
    Load,
    Moment,
    OverPosition,
    OverTime,
    Spring,
)
from presswear.linkage.motions import Drive, Follow
from presswear.linkage.pieces import RISES, Rise
from presswear.linkage.points import GROUND, Attachment, Probe
from presswear.linkage.press import GEOMETRIES, Press
from presswear.linkage.reading import read
from presswear.linkage.slider_crank import SliderCrank
from presswear.linkage.written import toml_of, values_of, written
from presswear.tools.errors import InputError, one_line

LOADED = replace(
    FOUR_BAR,
    springs=[Spring("s", Attachment("rocker", 0.0, 0.01), Attachment(GROUND, 0.3, 0.1), 50.0, 0.1)],
    loads=[Load("coupler", y=-3.0, moment=0.1)],
    watch=Probe("coupler", 0.3, 0.01, 0.02),
    cycle=0.5,
    gravity=0.0,
)


def brake(speed: float) -> float:
    """A text with "quotes" and lines."""
    return -0.1 * speed


TABLE = OverPosition([(-0.1, 0.0), (0.1, -5.0)], "along", "hold", 0.02, 0.01, True, unloading=30.0)
LIVELY = replace(
    FOUR_BAR,
    loads=[
        Load("coupler", y=-3.0),
        Force("rocker.head", 0.3, 5.0),
        Force("rocker", 0.3, TABLE, "brake"),
        Force(Attachment("rocker", 0.01, 0.02), -1.0, OverTime([(0.0, 1.0), (0.1, 5.0)])),
        Force("rocker.head", 0.3, OverTime([(0.0, 1.0), (0.1, 5.0)], 0.0)),
        Force("rocker.head", 0.3, Harmonics(0.1, 30.0, [(1.0, 2.0)])),
        Moment("crank", OverPosition([(0.0, 0.0), (1.0, 5.0)], repeats=2.0 * math.pi)),
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


@pytest.mark.parametrize("linkage", EVERY, ids=lambda linkage: linkage.name)
def test_a_linkage_is_read_back_bit_for_bit(linkage: Linkage) -> None:
    assert read(written(linkage), "here") == linkage
    data = tomllib.loads(toml_of(linkage))["mechanism"]
    assert read(data, "here", units=True) == linkage


def test_every_value_is_listed_with_its_unit() -> None:
    told = {key: (value, text) for key, value, text in values_of(LOADED)}
    assert told["springs[0].stiffness"] == ("50.0 N/m", "stiffness")
    assert told["pins[1].first"][0] == "crank.head"
    assert told["guess"][0] == "{ coupler = 0.6 rad, rocker = 1.4 rad }"
    assert told["cycle"][0] == "0.5 s"


def test_a_load_is_listed_by_its_law() -> None:
    told = {key: value for key, value, _ in values_of(LIVELY)}
    assert told["loads[1].force"] == "5.0 N"
    assert told["loads[2].over_position"] == "[[-0.1 m, 0.0 N], [0.1 m, -5.0 N]]"
    assert told["loads[2].release"] == "true"
    assert told["loads[6].over_angle"] == "[[0.0 rad, 0.0 N m], [1.0 rad, 5.0 N m]]"
    assert told["loads[9].function"].startswith("user law brake, ")


def load_of(**row: Any) -> dict[str, Any]:
    """The four-bar as data, with a load."""
    return {**tomllib.loads(toml_of(FOUR_BAR))["mechanism"], "loads": [row]}


ROWS = [["0 mm", "0 N"], ["3 mm", "0.5 kN"], ["4 mm", "0 N"]]


def test_a_load_is_read_with_its_units() -> None:
    data = load_of(point="rocker.head", over_position=ROWS, rise="1 mm/s", direction="90 deg")
    (load,) = read(data, "here", units=True).live_loads
    assert load == Force(
        Attachment("rocker", 0.06, 0.0),
        0.5 * math.pi,
        OverPosition([(0.0, 0.0), (0.003, 500.0), (0.004, 0.0)]),
    )


def at(**row: Any) -> dict[str, Any]:
    """A force on the rocker as a row."""
    return {"point": "rocker", **row}


def on(**row: Any) -> dict[str, Any]:
    """A moment on the crank as a row."""
    return {"body": "crank", **row}


ONE, OTHER = ["0 s", "1 N"], ["3 s", "1 N m"]


@pytest.mark.parametrize(
    ("row", "says"),
    [
        (at(point="rocker.haed", force="1 N"), "unknown point of rocker in loads 'haed'"),
        (at(point="roker", force="1 N"), "unknown body in loads 'roker'; did you mean rocker"),
        (at(over_position=ROWS[::-1]), r"over_position\[1\]: 0.003 does not lie"),
        (at(over_position=ROWS[:2]), "500 N or N m at the end, 0.003"),
        (at(over_position=[["0 mm", 3.0]]), r"\[0\] = '3.0' has no unit"),
        (at(over_position=[["0 s", "0 N"]]), r"\[0\] = '0 s': unknown unit 's'"),
        (at(over_position=[["0 m"]]), "2 values are expected: position, and the size"),
        (at(over_position="F"), "a list of rows is expected: position, and"),
        (at(over_angle=[]), "unknown key of .* 'over_angle'; did you mean"),
        (at(over_time=[], function="f.py:f"), "no file 'f.py'"),
        (
            at(over_time=[ONE], over_position=ROWS),
            "one law is expected, of over_time, .*; over_time and over_position is given",
        ),
        (at(), "one law is expected.*; none is given"),
        (at(over_position=ROWS, sense="up"), "sense = 'up': allowed is one of"),
        (at(over_position=ROWS, release=1), "release = 1: true or false"),
        (
            at(over_time=[ONE], sense="along"),
            "sense: it means nothing beside over_time",
        ),
        (at(force="1 N", period="1 s"), "period: it means nothing beside force"),
        ({"direction": "1 rad", "force": "1 N"}, "unknown key of .* 'direction'"),
        (on(over_angle=[["1 deg", "1 N m"], ["0 deg", "0 N m"]]), r"over_angle\[1\]"),
        (on(over_time=[ONE]), "unknown unit 'N'; did you mean Nm"),
        (on(over_time=[OTHER], period="1 s"), "with a period of 1 s allowed is 0 to 1 s"),
        ({"over_time": [OTHER]}, "body is missing"),
    ],
)
def test_a_load_that_is_none_is_told_by_its_key(row: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        read(load_of(**row), "here", units=True)
    assert "here" in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_what_slides_is_watched_along_its_guide() -> None:
    whole = replace(Press().linkage(), watch="slider 6.centre")
    assert whole.probe == Press().linkage().probe
    data = written(whole)
    del data["direction"]
    assert read(data, "here").probe == whole.probe
    assert replace(FOUR_BAR, watch="").probe == Probe("rocker")


def test_a_bar_is_a_thin_rod_with_its_ends() -> None:
    bar = Bar("b", length=0.2, mass=0.3)
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
        ({"watch": "rocker.nose"}, "unknown point of rocker in watch 'nose'"),
        ({"bodies": [*FOUR_BAR.bodies, FOUR_BAR.bodies[0]]}, "body crank: the name stands twice"),
    ],
)
def test_what_names_nothing_is_told(changes: dict[str, Any], says: str) -> None:
    with pytest.raises(InputError, match=says):
        replace(FOUR_BAR, **changes)


def test_a_body_without_a_point_stands_for_its_mass_centre() -> None:
    whole = replace(FOUR_BAR, watch="rocker.centre", loads=[Force("rocker.centre", 0.0, 1.0)])
    assert replace(FOUR_BAR, watch="rocker", loads=[Force("rocker", 0.0, 1.0)]) == whole


@pytest.mark.parametrize(
    ("speeds", "turns"), [((30.0,), 1), ((30.0, -30.0), 1), ((30.0, 20.0), 3), ((2.0, 3.0), 2)]
)
def test_the_cycle_follows_from_the_drives(speeds: tuple[float, ...], turns: int) -> None:
    names = ("crank", "coupler", "rocker")
    drives = [Drive(name, speed) for name, speed in zip(names, speeds, strict=False)]
    period = replace(FOUR_BAR, drives=drives).period
    assert period == pytest.approx(2.0 * math.pi * turns / abs(speeds[0]))


def test_a_cycle_that_there_is_not_has_to_be_given() -> None:
    for drives in ([], [Drive("crank", 1.0), Drive("rocker", math.pi)]):
        with pytest.raises(InputError, match="it has to be given"):
            _ = replace(FOUR_BAR, drives=drives).period
    assert replace(FOUR_BAR, drives=[], cycle=2.0).period == 2.0


def broken(*path: Any, value: Any) -> dict[str, Any]:
    """The four-bar as data, with one value changed; None takes it out."""
    data = copy.deepcopy(tomllib.loads(toml_of(FOUR_BAR))["mechanism"])
    owner: Any = data
    for key in path[:-1]:
        owner = owner[key]
    if value is None:
        del owner[path[-1]]
    else:
        owner[path[-1]] = value
    return data


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        (("bodies", 0, "mass"), "0.3", r"bodies\[0\]\.mass = '0\.3' has no unit"),
        (("bodies", 0, "mass"), 0.3, r"bodies\[0\]\.mass = '0\.3' has no unit"),
        (("bodies", 0, "mass"), "0.3 m", r"unknown unit 'm'; known are kg, g"),
        (("bodies", 0, "mass"), "-1 kg", r"mass = -1 kg: allowed is 1e-09 to"),
        (("bodies", 0, "mass"), None, r"bodies\[0\]: mass is missing"),
        (("bodies", 0, "inertia"), None, r"inertia of crank = 0 kg m\^2: must be"),
        (
            ("bodies", 0, "mas"),
            "1 kg",
            r"unknown key of here: bodies\[0\] 'mas'; did you mean mass",
        ),
        (("bodies",), [], "bodies: at least one is needed"),
        (("bodies",), 3, "bodies = 3: a list of tables is expected"),
        (("bodies", 0), 3, r"bodies\[0\] = 3: a table is expected"),
        (("bodies", 0, "points"), {"x": ["1 m"]}, r"points\.x = \['1 m'\]: two lengths"),
        (("pins", 0, "second"), "crank.tale", "unknown point of crank in joint O 'tale'"),
        (("pins", 0, "first"), ["1 m", "2"], r"pins\[0\]\.first = '2' has no unit"),
        (("drives", 0, "speed"), "30 rpn", "unknown unit 'rpn'"),
        (("guess", "coupler"), "fast", "guess.coupler = 'fast' is not a number"),
        (("bodys",), [], "unknown key of here 'bodys'; did you mean bodies"),
        (("gravity",), True, "gravity = 'True' is not a number"),
    ],
)
def test_what_does_not_fit_is_told_by_its_key(path: Any, value: Any, says: str) -> None:
    with pytest.raises(InputError, match=says) as refusal:
        read(broken(*path, value=value), "here", units=True)
    assert str(refusal.value).startswith(("here", "unknown key of here"))
    assert "\n" not in str(refusal.value)


numbers = st.floats(-1e3, 1e3)
pairs = st.lists(st.tuples(numbers, numbers), max_size=16)
rows = st.lists(st.tuples(numbers, numbers, numbers), min_size=3, max_size=30).map(
    lambda own: [(k * 2.0 * math.pi / len(own), *row[:1]) for k, row in enumerate(own)]
)
long_rows = st.lists(st.tuples(numbers, numbers, numbers), min_size=3, max_size=30).map(
    lambda own: [(k * 2.0 * math.pi / len(own), *row) for k, row in enumerate(own)]
)
swings = st.tuples(
    st.floats(0.0, 2.0), st.floats(0.1, 2.0), numbers, st.sampled_from([*RISES])
).map(
    lambda own: [
        Rise(own[0], own[0] + own[1], own[2], own[3]),
        Rise(own[0] + own[1] + 0.5, own[0] + own[1] + 1.5, -own[2]),
    ]
)
motions = st.one_of(
    st.fixed_dictionaries({"harmonics": pairs, "table": st.one_of(rows, long_rows)}),
    st.fixed_dictionaries({"harmonics": pairs, "rises": swings}),
    st.fixed_dictionaries({"harmonics": pairs}),
)
curves = st.builds(
    lambda motion, direction: Follow("rocker.head", direction, **motion),
    motions,
    st.one_of(st.none(), numbers),
)
own_drives = st.builds(
    lambda speed, angle, frequency, motion: Drive("crank", speed, angle, frequency, **motion),
    numbers,
    numbers,
    st.floats(1e-3, 1e3),
    st.one_of(motions, st.fixed_dictionaries({"follow": curves})),
)


@given(own_drives, st.integers(0, 1000))
def test_motions_are_kept_to_the_last_bit(drive: Drive, run_up: int) -> None:
    linkage = replace(FOUR_BAR, drives=[drive], run_up=run_up)
    assert read(written(linkage), "here") == linkage
    assert read(json.loads(json.dumps(written(linkage))), "here") == linkage
    assert read(tomllib.loads(toml_of(linkage))["mechanism"], "here", units=True) == linkage


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


@given(st.dictionaries(st.sampled_from(KEYS), values, min_size=1, max_size=4), st.booleans())
def test_any_drive_is_read_or_refused_in_one_line(row: dict[str, Any], units: bool) -> None:
    data = tomllib.loads(toml_of(FOUR_BAR))["mechanism"] if units else written(FOUR_BAR)
    data["drives"] = [{"body": "crank", **row}]
    told = "here"
    try:
        assert len(read(data, "here", units=units).drives) == 1
    except InputError as error:
        told = str(error)
    assert told.startswith(("here", "unknown key of here"))
    assert "\n" not in one_line(told)


@pytest.mark.parametrize(
    ("row", "told"),
    [
        ({"table": [["0 deg", 1]]}, r"here: drives\[0\]\.table\[0\] = '1' has no unit"),
        (
            {"table": [["0 deg", "1 rad", "2 rad"]]},
            r"drives\[0\]\.table\[0\] = .*: 2 or 4 values are expected: phase of the cycle",
        ),
        (
            {"harmonics": [["1 rad"]]},
            r"harmonics\[0\] = .*: 2 values are expected: cosine and sine",
        ),
        ({"rises": 3}, r"here: drives\[0\]\.rises = 3: a list of tables is expected"),
        ({"rises": [{"start": 0, "end": "9 deg"}]}, r"drives\[0\]\.rises\[0\]: by is missing"),
        ({"rises": [{"stat": 0}]}, r"unknown key of here: drives\[0\]\.rises\[0\] 'stat'; did you"),
        (
            {"rises": [{"start": 0, "end": "9 deg", "by": "9 deg", "law": "cycloid"}]},
            "here: drive of crank: unknown law of a rise 'cycloid'; did you mean cycloidal",
        ),
        ({"follow": {}}, r"here: drives\[0\]\.follow: point is missing"),
        ({"follow": {"point": "roker.head"}}, "unknown body in follow of crank 'roker'; did you"),
        (
            {"table": [[0, 0], ["60 deg", "5 deg"]]},
            "here: table of crank: 2 rows are given; allowed are 3 to 256",
        ),
    ],
)
def test_a_motion_that_is_none_is_told_by_its_key(row: dict[str, Any], told: str) -> None:
    data = tomllib.loads(toml_of(FOUR_BAR))["mechanism"]
    data["drives"] = [{"body": "crank", "frequency": "30 rpm", **row}]
    with pytest.raises(InputError, match=told):
        read(data, "here", units=True)


@pytest.mark.parametrize("wrong", ["2.5", -1, 1.5, True, "2 s", 2000])
def test_a_run_up_is_a_whole_number_of_cycles(wrong: Any) -> None:
    data = tomllib.loads(toml_of(FOUR_BAR))["mechanism"]
    assert read(data | {"run_up": 2}, "here", units=True).run_up == 2
    with pytest.raises(InputError, match="run_up"):
        read(data | {"run_up": wrong}, "here", units=True)
