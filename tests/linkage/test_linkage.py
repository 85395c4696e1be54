"""Linkages and their loads: assembled, written and read back, refused."""

import json
import math
from dataclasses import replace
from typing import Any

import pytest
from four_bar_linkage import FOUR_BAR
from hypothesis import given
from hypothesis import strategies as st
from slotted import boom_press, geared_five_bar, quick_return
from upright_press import upright_press

from presswear.linkage.bodies import Bar, Body
from presswear.linkage.cycle import MAX_TURNS
from presswear.linkage.drives import Drive, Follow
from presswear.linkage.joints import Guide, Pin
from presswear.linkage.linkage import Linkage, assemble, linkage_from
from presswear.linkage.load_laws import Harmonics, OverPosition, OverTime
from presswear.linkage.loads import Force, Load, Moment
from presswear.linkage.mechanisms import SliderCrank
from presswear.linkage.motion_pieces import MAX_PIECES, Rise
from presswear.linkage.motor import Motor
from presswear.linkage.points import GROUND, Attachment, OutputPoint
from presswear.linkage.press import GEOMETRIES, Press
from presswear.linkage.process import Blanking, Drawing
from presswear.linkage.spring import Spring
from presswear.tools.errors import InputError
from presswear.tools.user_function import UserFunction

LOADED = FOUR_BAR.changed(
    springs=[
        Spring(
            "s",
            Attachment("rocker", 0.0, 0.01),
            Attachment(GROUND, 0.3, 0.1),
            50.0,
            0.1,
        )
    ],
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


TABLE = OverPosition(
    [(-0.1, 0.0), (0.1, -5.0)], "along", "hold", 0.02, True, unloading=30.0
)
LIVELY = FOUR_BAR.changed(
    loads=[
        Load("coupler", y=-3.0),
        Force("rocker.head", 0.3, 5.0),
        Force("rocker", 0.3, TABLE, "brake"),
        Force(
            Attachment("rocker", 0.01, 0.02), -1.0, OverTime([(0.0, 1.0), (0.1, 5.0)])
        ),
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
SINE = [
    (k * math.pi / 3.0, *values)
    for k, *values in ((0, 0.1, 0.2, 1.0 / 3.0), (1, -7e2, 0, 1))
]
MOTIONS: tuple[dict[str, Any], ...] = (
    {"frequency": 1.0 / 7.0, "harmonics": [(0.1, -1e3), (1e-300, 0.3)], "angle": -0.7},
    {"table": [*((angle, value) for angle, value, *_ in SINE), (2.0, 0.5)]},
    {"table": [*SINE, (2.0, 0.1, 0.2, 0.3)], "harmonics": [(1.0, 2.0)]},
    {
        "rises": [
            Rise(0.1, 0.9, 0.7, "modified-sine"),
            Rise(1.0, 2.0, -0.7, "cycloidal"),
        ]
    },
    {
        "follow": Follow(
            "rocker.head", rises=[Rise(0.0, 1.0, 0.1), Rise(2.0, 3.0, -0.1, "3-4-5")]
        )
    },
    {"follow": Follow("rocker.head", 0.3, harmonics=[(1.0 / 3.0, 2.0)])},
)
EVERY = [
    FOUR_BAR,
    LOADED,
    LIVELY,
    *(
        FOUR_BAR.changed(
            drives=[Drive("crank", 30.0, **motion)], run_up=k, name=f"motion {k}"
        )
        for k, motion in enumerate(MOTIONS)
    ),
    SliderCrank().linkage(),
    *(Press(geometry=geometry).linkage() for geometry in GEOMETRIES.values()),
    quick_return(),
    boom_press(),
    geared_five_bar(motor=Motor(20.0, breakdown=None)),
    upright_press(frame=Guide("frame", "crown", stiffness=1e9, damping=0.1)),
    FOUR_BAR.changed(
        joints=[Pin("O", (0, 0), "crank.tail", 1e7, 0.1), *FOUR_BAR.joints[1:]],
        name="elastic pin",
    ),
]


@pytest.mark.parametrize("linkage", EVERY, ids=lambda linkage: linkage.name)
def test_a_linkage_is_read_back_bit_for_bit(linkage: Linkage):
    stored = json.loads(json.dumps(linkage.as_plain()))
    assert linkage_from(stored, "here") == linkage


def test_the_output_point_moves_along_its_guide():
    whole = Press().linkage().changed(output="slider 6.centre")
    assert whole.output == Press().linkage().output
    assert FOUR_BAR.changed(output="").output == OutputPoint("rocker")
    assert (
        assemble([Body("a", 1.0, 1.0)], direction="90 deg").output.direction
        == 0.5 * math.pi
    )


def test_a_bar_is_a_thin_rod_with_its_ends():
    bar = Bar("b", length="20 cm", mass="300 g")
    assert bar == Body(
        "b", 0.3, 0.3 * 0.2**2 / 12.0, {"tail": (-0.1, 0.0), "head": (0.1, 0.0)}
    )
    with pytest.raises(InputError, match=r"length of b = -1 m: allowed is 1e-06 to"):
        Bar("b", length=-1, mass=0.3)


ENDS = [(0.0, 0.0), (1.0, 5.0), (2.0, 0.0)]
SHEET = {
    "table": [(0.0, 0.0), (1.0, -5.0), (2.0, -6.0)],
    "sense": "along",
    "outside": "hold",
}
ROW = (0.0, 0.0)
MANY = [Rise(k / 40, (k + 1) / 40, 0.01, "modified-sine") for k in range(200)]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"joints": [Pin("O", (0, 0), "crnk.tail")]},
            "body in joint O 'crnk'; did you mean crank",
        ),
        (
            {"joints": [Pin("O", (0, 0), "crank.tial")]},
            "unknown point of crank in joint O 'tial'",
        ),
        ({"joints": [Guide("g", "slider")]}, "unknown body in guide g 'slider'"),
        *(
            (
                {"joints": [Pin(f"{sign}A", (0, 0), "crank.tail")]},
                r"must not begin with \+ - or @",
            )
            for sign in "+-@＝"
        ),
        (
            {"drives": [Drive("crank", 1.0), Drive("crank", 2.0)]},
            "drive of crank: the name is used",
        ),
        (
            {"drives": [Drive("cank", 1.0)]},
            "unknown body in drives 'cank'; did you mean crank",
        ),
        ({"guess": {"rod": 1.0}}, "unknown body in guess 'rod'"),
        ({"loads": [Load("rod")]}, "unknown body in loads 'rod'"),
        (
            {"loads": [Force("rocker.haed", 0.0, 1.0)]},
            "unknown point of rocker in loads 'haed'",
        ),
        ({"loads": [Moment("frame", wobble)]}, "unknown body in loads 'frame'"),
        (
            {"loads": [Moment("crank", OverTime([(0, 1), (0.3, 2)]))]},
            "cycle of 0.20944 s allowed",
        ),
        ({"output": "rocker.nose"}, "unknown point of rocker in output 'nose'"),
        (
            {"bodies": [*FOUR_BAR.bodies, FOUR_BAR.bodies[0]]},
            "body crank: the name is used twice",
        ),
        ({"bodies": []}, "bodies: at least one is needed"),
        (
            {"drives": [Drive("crank", 30.0, follow=Follow("rocker.haed"))]},
            "'haed'; did you mean",
        ),
        ({"run_up": 1.5}, "run_up = 1.5: a whole number"),
        ({"gravity": "fast"}, "gravity = 'fast' is not a number"),
    ],
)
def test_parts_that_do_not_fit_together_are_refused(changes, message):
    with pytest.raises(InputError, match=message):
        FOUR_BAR.changed(**changes)


@pytest.mark.parametrize(
    ("kind", "values", "message"),
    [
        (OverTime, {"table": []}, "table: one row or more"),
        (OverTime, {"table": 3}, "table = 3: a list is expected"),
        (OverTime, {"table": [(0, 0), (0, 1)]}, r"table\[1\]: 0 does not lie above 0"),
        (
            OverTime,
            {"table": [(0, 0), (1, math.nan)]},
            r"table\[1\]\[1\] = nan N or N m: allowed",
        ),
        (
            OverTime,
            {"table": [(0, 0), (3, 1)], "period": 2.0},
            "period of 2 s allowed is 0 to 2 s",
        ),
        (
            OverPosition,
            {"table": [(1, 0), (0, 0)]},
            r"table\[1\]: 0 does not lie above 1",
        ),
        (
            OverPosition,
            {"table": [(0, 1), (1, 0)]},
            "1 N or N m at the end, 0 m or rad, would be",
        ),
        (
            OverPosition,
            {"table": ENDS, "sense": "allong"},
            "sense = 'allong'.*did you mean along",
        ),
        (
            OverPosition,
            {"table": ENDS, "sense": "along"},
            "5 N or N m at 1 .*would drive",
        ),
        (OverPosition, {"table": ENDS, "release": True}, "release: it needs a table"),
        (
            OverPosition,
            {"table": ENDS, "unloading": 9.0},
            "unloading: it needs a table that acts",
        ),
        (
            OverPosition,
            {**SHEET, "unloading": 4.9},
            "4.9 N.m .* is 5, the steepest rise of",
        ),
        (
            OverPosition,
            {**SHEET, "table": [(1, -5)], "unloading": 9.0},
            "-5 N .*, where it begins",
        ),
        (Harmonics, {"harmonics": [(1, 1)]}, "frequency = 0 rad/s: with harmonics"),
        (Moment, {"body": "crank", "law": 1.0}, "use Load for a constant moment"),
        (Moment, {"body": "crank", "law": "f.py:f"}, "no such file"),
        (
            Force,
            {"point": "crank", "direction": 0.0, "law": None},
            "law = None: a number",
        ),
        (
            Force,
            {"point": "crank", "direction": 0.0, "law": math.pow},
            "source of .* be read",
        ),
        (
            Rise,
            {"start": 1.0, "end": 0.5, "by": 1.0},
            "a rise from 1 to 0.5 rad: it must begin",
        ),
        (
            Drive,
            {"table": [(k * 0.01, 0.0) for k in range(600)]},
            "table of crank: 600 rows; all",
        ),
        (
            Drive,
            {"table": [ROW, (2.0, 0.1), (1.0, 0.2)]},
            "phases from 0 to 1 rad; they must",
        ),
        (
            Drive,
            {"table": [ROW, (2.0, 0.1), (6.5, 0.2), (7.0, 0.0)]},
            "from 0 to 7 rad; .*2 pi",
        ),
        (
            Drive,
            {"table": [ROW, (1.0, 0.1, 0.0), (2.0, 0.1)]},
            r"table\[1\] of crank = .*expected",
        ),
        (
            Drive,
            {"table": [ROW, (1.0, 0.1, 0.0, 0.0), (2.0, 0.1)]},
            "rows of one length are",
        ),
        (
            Drive,
            {"rises": [Rise(0.0, 2.0, 1.0), Rise(1.0, 3.0, -1.0)]},
            "the rise that ends at 2",
        ),
        (
            Drive,
            {"rises": [Rise(0.0, 2.0, 1.0)], "table": [ROW] * 3},
            "a table and rises",
        ),
        (
            Drive,
            {"rises": MANY},
            f"rises of crank: 601 pieces; allowed are {MAX_PIECES} at most",
        ),
        (
            Drive,
            {"harmonics": [ROW], "follow": Follow("crank.head")},
            "harmonics and follow can",
        ),
        (
            Drive,
            {"harmonics": [ROW] * 17},
            "harmonics of crank: 17; allowed are 0 to 16",
        ),
        (Drive, {"speed": math.nan}, "speed of crank = nan rad/s: allowed is"),
        (
            Drive,
            {"speed": 0.0, "harmonics": [(0.0, 1.0)]},
            "frequency of crank = 0 rad/s",
        ),
        (Follow, {"point": "a", "rises": [Rise(0.0, 1.0, 0.1)]}, "must come back"),
        (
            Blanking,
            {"stiffness": 1e12},
            r"with force = 500 N allowed is 0\.05 N/mm to 500 kN/mm",
        ),
        (
            Drawing,
            {"bottom": "low"},
            "bottom = 'low': allowed is one of lowest, highest",
        ),
    ],
)
def test_impossible_parts_are_refused(kind, values, message):
    required = {"body": "crank", "speed": 10.0} if kind is Drive else {}
    with pytest.raises(InputError, match=message):
        kind(**{**required, **values})


def test_the_parameters_of_a_user_law_are_checked():
    def of_angle(angle: float) -> float:
        return angle

    with pytest.raises(
        InputError, match="unknown parameter of of_angle in law of crank 'angle'"
    ):
        Moment("crank", of_angle)
    assert isinstance(Moment("crank", wobble).law, UserFunction)


def test_a_missing_cycle_is_requested():
    for drives in ([], [Drive("crank", 1.0), Drive("rocker", math.pi)]):
        with pytest.raises(InputError, match="specify cycle, s"):
            _ = FOUR_BAR.changed(drives=drives).period
    assert FOUR_BAR.changed(drives=[], cycle="2 s").period == 2.0


@given(st.lists(st.integers(1, 63), min_size=2, max_size=4))
def test_a_cycle_of_drives_has_few_turns(turns):
    """Whole ratios of any size: no common cycle of more turns than allowed is accepted."""
    names = [f"crank {k}" for k in range(len(turns))]
    linkage = assemble(
        [Bar(name, 0.05, 0.3) for name in names],
        [Pin(f"O {k}", (0.2 * k, 0.0), f"crank {k}.tail") for k in range(len(turns))],
        [Drive(name, 3000.0 / turn) for name, turn in zip(names, turns, strict=True)],
    )
    if math.lcm(*turns) / min(turns) <= MAX_TURNS:
        assert linkage.period == pytest.approx(
            2.0 * math.pi * math.lcm(*turns) / 3000.0
        )
    else:
        with pytest.raises(InputError, match="cycle of linkage"):
            _ = linkage.period


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("bodies", 0, "mass"), "0.3", r"mass of crank = '0\.3' has no unit"),
        (("bodies", 0, "mass"), "0.3 m", r"unknown unit 'm'; known are kg, g, t"),
        (("bodies", 0, "mass"), "-1 kg", r"mass of crank = -1 kg: allowed is 1e-09 to"),
        (("bodies", 0, "mass"), None, r"bodies\[0\]: mass is missing"),
        (
            ("bodies", 0, "mas"),
            "1 kg",
            r"unknown key of bodies\[0\] 'mas'; did you mean mass",
        ),
        (("bodies", 0), 3, r"bodies\[0\] = 3: a Body is expected"),
        (
            ("joints", 0, "second"),
            "crank.tale",
            "unknown point of crank in joint O 'tale'",
        ),
        (("joints", 0, "first"), ["1 m", "2"], r"first\[1\] of O = '2' has no unit"),
        (
            ("joints", 0, "secnd"),
            "crank.tail",
            r"key of joints\[0\] 'secnd'; did you mean second",
        ),
        (("drives", 0, "speed"), "30 rpn", "unknown unit 'rpn'"),
        (("guess", "coupler"), "fast", "guess.coupler = 'fast' is not a number"),
        (("bodys",), [], "unknown key of here 'bodys'; did you mean bodies"),
        (("run_up",), 2000, "run_up = 2000: allowed is 0 to 1000"),
        (
            ("drives", 0, "table"),
            [["0 deg", "1"]],
            r"table\[0\]\[1\] of crank = '1' has no unit",
        ),
        (("drives", 0, "rises"), [{"start": 0, "end": "9 deg"}], "by is missing"),
        (("drives", 0, "follow"), {}, "follow of crank: point is missing"),
        (
            ("drives", 0, "table"),
            [[0, 0], ["60 deg", "5 deg"]],
            "2 rows; allowed are 3 to 512",
        ),
        (
            ("loads",),
            [{"body": "crank", "law": {"kind": "over"}}],
            "unknown kind of law",
        ),
        (("loads",), [{"point": "rocker", "law": "1 N"}], "direction is missing"),
    ],
)
def test_plain_data_that_does_not_fit_is_refused(path, value, message):
    data = FOUR_BAR.as_plain()
    owner: Any = data
    for key in path[:-1]:
        owner = owner[key]
    if value is None:
        del owner[path[-1]]
    else:
        owner[path[-1]] = value
    with pytest.raises(InputError, match=message) as refusal:
        linkage_from(data, "here")
    assert "here" in str(refusal.value)
