"""Scenes from files: those that ``presswear new`` writes, and any other text."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from refusals import refused

import presswear as pw
from presswear.physics.curve_following import motion_of
from presswear.physics.dead_centre import bottom_of
from presswear.scene.conventions import CONVENTIONS
from presswear.scene.files import EXAMPLES, PRESSES, example_file, scene_from
from presswear.scene.mechanism_kinds import MECHANISMS
from presswear.scene.settings import changed
from presswear.tools.serialize import plain

OFF = re.compile(r"^#(?=[a-z\[])", re.MULTILINE)  # of a line that is switched off
COMMON = [kind for kind in EXAMPLES if kind not in PRESSES]  # with default bearings


def written(folder: Path, text: str) -> Path:
    file = folder / "my-own.toml"
    file.write_text(text)
    return file


@pytest.mark.parametrize("kind", COMMON)
def test_an_example_is_a_scene_whose_values_are_of_the_file(kind, tmp_path):
    text = example_file(kind)
    scene = scene_from(written(tmp_path, text))
    assert scene.name == "my-own"
    assert pw.Scene.from_dict(scene.as_dict()) == scene
    assert scene.origins["clearance"] == "set by the user, in the file"
    assert scene.origins["exponent"] == "default"
    # A value that the file says already is no change of it.
    again = changed(scene, {"clearance": scene.bearings.clearance, "restitution": 0.7})
    assert again.origins["clearance"] == "set by the user, in the file"
    assert again.origins["restitution"] == "set by the user"


@pytest.mark.parametrize("kind", PRESSES)
def test_a_press_has_bearings_a_process_and_limits(kind, tmp_path):
    scene = scene_from(written(tmp_path, example_file(kind)))
    assert scene.bearings != pw.Bearing()
    assert scene.bearings.pressure_limit
    assert isinstance(scene.process, pw.Blanking)
    deep = replace(CONVENTIONS["refined"], stiffness="conforming")
    assert scene.conventions == deep
    assert pw.Scene.from_dict(scene.as_dict()) == scene


@pytest.mark.parametrize("kind", COMMON)
def test_an_example_has_the_defaults_of_python(kind, tmp_path):
    scene = scene_from(written(tmp_path, example_file(kind)))
    mechanism = scene.mechanism if kind == "points" else MECHANISMS[kind]()
    same = pw.Scene(mechanism, joints=scene.joints, name=scene.name, title=scene.title)
    assert plain(replace(scene, origins={})) == approximate(plain(same))
    assert scene.conventions == CONVENTIONS["refined"]
    if kind != "points":
        assert isinstance(scene.mechanism, MECHANISMS[kind])
        assert scene.clearance_joints == mechanism.default_joints


def approximate(data: Any) -> Any:
    """Return plain data that equal others whose numbers agree in six digits."""
    if isinstance(data, dict):
        return {key: approximate(value) for key, value in data.items()}
    return pytest.approx(data, rel=1e-6) if isinstance(data, float) else data


def switched_off(kind: str) -> list[str]:
    """Return the tables, and the single lines, that an example has switched off."""
    blocks = example_file(kind).split("\n\n")
    tables = [block for block in blocks if block.startswith(("#[", "#frame"))]
    rest = "\n".join(block for block in blocks if block not in tables)
    return [*tables, *(line for line in rest.splitlines() if OFF.match(line))]


@pytest.fixture(scope="module")
def plain_scenes(tmp_path_factory):
    """Return the scenes of the examples as they are written."""
    folder = tmp_path_factory.mktemp("plain")
    return {kind: scene_from(written(folder, example_file(kind))) for kind in EXAMPLES}


# Each table and line in the first example that has one of its name; inertias of bodies
# and bearings of joints once
SWITCHED = {
    re.sub(r"\w+(?=_inertia)|(?<=bearings\.)\w+", "", block.split()[0]): (kind, block)
    for kind in reversed(list(EXAMPLES))
    for block in switched_off(kind)
}


@pytest.mark.parametrize(
    ("kind", "block"),
    [
        *SWITCHED.values(),
        *((kind, "") for kind in EXAMPLES),  # all of them
    ],
    ids=lambda text: text.split("\n")[0].split(" ")[0] or "all",
)
def test_a_table_that_is_switched_on_works(kind, block, tmp_path, plain_scenes):
    """One table after the other, and all of them.

    Torques of each mechanism take seconds; a limit of them is switched on by itself.
    """
    text = example_file(kind)
    if not block:
        text = re.sub(r"(?m)^#torque_limit.*\n", "", text)
    on = text.replace(block, OFF.sub("", block)) if block else OFF.sub("", text)
    scene = scene_from(written(tmp_path, on))
    assert scene != plain_scenes[kind]
    if block.startswith("#[bearings."):
        assert scene.bearing(scene.clearance_joints[0]).clearance == 0.15e-3
    elif block.startswith("#[limits"):
        assert scene.bearings.pressure_limit == 40e6
    elif block.startswith("#["):
        part = block[2:].partition("]")[0]
        data = scene.as_dict()
        assert (data["mechanism"] if part in ("motor", "servo") else data)[
            part
        ] is not None


@pytest.mark.parametrize("kind", ["press", "slider-crank"])
def test_a_guide_that_is_switched_on_has_clearance(kind, tmp_path):
    text = example_file(kind).replace("#guide_", "guide_")
    table = re.search(r"(# .*\n)+", text[text.index("# [bearings.guide]") :])
    text = text.replace(table[0], re.sub("(?m)^# ", "", table[0]))
    joints = re.search(r'with (joints = ".*")', table[0])
    text = re.sub('(?m)^joints = ".*"', joints[1], text)
    scene = scene_from(written(tmp_path, text))
    (guide,) = scene.loose_guides
    assert scene.bearing(guide.name).clearance == 0.05e-3
    assert scene.bearing(guide.name).width == 0.04


def test_the_work_of_a_slider_crank_is_farthest_from_the_crank(tmp_path):
    scene = scene_from(written(tmp_path, OFF.sub("", example_file("slider-crank"))))
    # Crank and rod are in line, and up is towards the crank.
    assert scene.bottom == pytest.approx(-0.17)


def test_a_drawing_is_the_linkage_of_its_points(tmp_path):
    """Joints lie at the start where they are drawn, and bodies are not turned."""
    motion = motion_of(scene_from(written(tmp_path, example_file("points"))).mechanism)
    centres = motion.at(np.zeros(1)).position.reshape(-1, 3)
    drawn = [[0.0, 0.02, 0.0], [0.0, -0.26, 0.0], [0.0, -0.56, 0.0]]
    assert centres == pytest.approx(np.array(drawn), abs=1e-12)
    points: Any = {"A": ("75 cm", "1 m")}
    body = pw.Body("a", 1.0, points=points, centre=("25 cm", "50 cm"))
    assert body == pw.Body("a", 1.0, points={"A": (0.5, 0.5)})
    with refused("centre of a = 3: a list is expected"):
        pw.Body("a", 1.0, centre=3)


def test_a_servo_motion_out_of_reach_is_refused(tmp_path):
    text = OFF.sub("", example_file("press")).replace("part = 0.111111", "part = 0.45")
    with refused("crank 7 cannot make its point follow the curve"):
        scene_from(written(tmp_path, text))


def test_the_press_from_a_file_is_the_named_one_bit_for_bit(tmp_path):
    mechanism = scene_from(written(tmp_path, 'mechanism = "press"')).mechanism
    named = replace(
        pw.scenes.wear_times(), engine=pw.engines.InHouse.word, cycles=1, wear_updates=0
    )
    read = replace(named, mechanism=mechanism.linkage(), joints="A,C")
    one, other = (pw.run(scene).stages[0].arrays for scene in (named, read))
    assert one.keys() == other.keys()
    assert all(array.tobytes() == other[name].tobytes() for name, array in one.items())


LAW = "def rub(sliding, normal):\n    return -normal * sliding\n"
FRICTION = "mechanism = 'press'\n[settings]\nC.friction_law = "


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "",
            "mechanism: a table with a kind, one of press, .*, or with bodies is needed",
        ),
        ("mechanism = 'pres'", "unknown mechanism 'pres'; did you mean press"),
        (
            "mechanism = 'press'\nsetings = 1",
            "unknown key 'setings'; did you mean settings",
        ),
        (
            "mechanism = 'press'\n[settings]\nclearence = '1 mm'",
            "did you mean clearance",
        ),
        (
            "mechanism = 'press'\n[settings]\nclearance = 0.001",
            "clearance = '0.001' has no unit",
        ),
        (
            "mechanism = 'press'\n[settings]\nwear_updates = true",
            "a text or a number is expected",
        ),
        ("mechanism = 'press'\nsettings = 1", "settings = 1: a table is expected"),
        ("mechanism = 'press'\ntitle = 1", "title = 1: a text is expected"),
        ("[mechanism", r"Expected '\]'"),
        ("mechanism = 'press'\nmechanism = 'press'", "Cannot overwrite a value"),
        (
            "[mechanism]\nkind = 'press'\nlenght_2 = 1",
            "'lenght_2'; did you mean length_2",
        ),
        (
            "[mechanism]\nkind = 'press'\n[[mechanism.loads]]",
            "loads: it needs a mechanism of bod",
        ),
        # A law stands beside the file of the scene.
        (f"{FRICTION}'laws.py:rob'", "friction_law.*did you mean rub"),
        (f"{FRICTION}'law.py:rub'", "friction_law.*no such file"),
    ],
)
def test_a_wrong_file_is_refused_in_one_line(text, message, tmp_path):
    (tmp_path / "laws.py").write_text(LAW)
    file = tmp_path / "wrong.toml"
    file.write_text(text)
    with refused(f"^{re.escape(str(file))}: .*{message}"):
        scene_from(file)


# Lines of a file from the third on, separated by @, and pattern of the message.
WRONG_LINES = r"""
speed = 105 rpm | line 3: speed = 105 rpm: .*numbers with a unit, need quotes
c_f = 0,05  # comma | line 3: c_f = 0,05: .*decimals need a point
clearance = '0,3 mm' | use a decimal point, '0\.3 mm'
[settings] | line 3: \[settings\]: Cannot declare
c_f = 0.1@[bearings]@friction = 0.1 | friction stands twice; it is allowed in one table only
[bearings]@kind = 'dwell' | bearings: kind belongs to another table; is its # removed
[bearings.B]@clearance = '1 mm' | B\.clearance: joint B has no clearance; joints = AC
[process]@force = '1 kN' | process: a kind is missing; presswear list SCENE shows the kinds
"""


@pytest.mark.parametrize("case", WRONG_LINES.strip().splitlines())
def test_a_wrong_line_is_answered_with_what_to_write(case, tmp_path):
    lines, message = case.split(" | ")
    text = "\n".join(["mechanism = 'press'", "[settings]", *lines.split("@"), ""])
    file = written(tmp_path, text)
    with refused(f"^{re.escape(str(file))}.*{message}"):
        scene_from(file)


LOADS = """
[[mechanism.loads]]
point = "slide.B"
direction = "30 deg"
law.kind = "over-position"
law.table = [["-20 mm", "0 N"], ["0 mm", "-0.1 kN"], ["10 mm", "-50 N"]]
law.sense = "along"
law.release = true
[[mechanism.loads]]
body = "crank"
law.kind = "over-position"
law.table = [["0 deg", "0 N m"], ["90 deg", "0.1 N m"]]
law.outside = "hold"
[[mechanism.loads]]
body = "rod"
law = { kind = "over-time", table = [["0 s", "0 N m"], ["10 ms", "0.1 N m"]], period = "20 ms" }
"""


def test_a_file_may_hold_loads(tmp_path):
    file = tmp_path / "loaded.toml"
    file.write_text(f"{example_file('points')}{LOADS}")
    scene = scene_from(file)
    assert [
        len(getattr(load.law, "table", ())) for load in scene.linkage().loads_with_law
    ] == [3, 2, 2]
    assert pw.Scene.from_dict(scene.as_dict()) == scene


IDEAL = pw.scenes.ideal()
SLIDER_CRANK = replace(pw.scenes.slider_crank(), joints="none", cycles=1)
DRAWING = pw.Drawing(force=200.0, cushion=15.0)
DWELL = pw.linkage.Dwell(part=0.1, stroke=0.08)


@pytest.mark.parametrize(
    ("key", "part", "texts", "also", "another"),
    [
        (
            "process",
            DRAWING,
            {"force": "0.2 kN", "cushion": "15 N"},
            "peak",
            pw.Coining(),
        ),
        (
            "servo",
            DWELL,
            {"part": "0.1", "stroke": "80 mm"},
            "angle",
            pw.linkage.Pendulum(),
        ),
    ],
)
def test_a_part_from_python_settings_and_files(
    key, part, texts, also, another, tmp_path
):
    def part_of(scene: Any) -> Any:
        return scene.process if key == "process" else scene.mechanism.servo

    settings = {f"{key}.{name}": text for name, text in texts.items()}
    scene = changed(IDEAL, {key: part.kind, **settings})
    assert part_of(scene) == part
    assert pw.Scene.from_dict(scene.as_dict()) == scene
    file = tmp_path / "mine.toml"
    lines = [
        f'{name} = "{text}"' for name, text in {"kind": part.kind, **texts}.items()
    ]
    file.write_text("\n".join(['mechanism = "press"', f"[{key}]", *lines]))
    assert part_of(scene_from(file)) == part
    assert part_of(changed(scene, {key: "none"})) is None
    # The same kind keeps its values; another kind has its defaults.
    assert part_of(changed(scene, {f"{key}.{also}": 0.5})) == replace(
        part, **{also: 0.5}
    )
    assert part_of(changed(scene, {key: another.kind})) == another


@pytest.mark.parametrize("run_up", [0, 2])
def test_work_lies_over_the_lowest_place_or_under_the_highest(run_up):
    press = replace(IDEAL, mechanism=replace(IDEAL.mechanism, run_up=run_up))
    scene = replace(press, process=pw.Blanking())
    (load,) = scene.linkage().loads_with_law
    assert isinstance(load, pw.Force)
    assert isinstance(load.law, pw.OverPosition)
    bottom = bottom_of(IDEAL.ideal)
    assert scene.bottom == pytest.approx(bottom.height, abs=1e-14)
    assert load.law.zero == pytest.approx(scene.bottom + 5e-3, abs=1e-15)
    # Dead centres of a slider-crank: rod plus and less crank.  Up is away from the
    # work.
    scene = replace(SLIDER_CRANK, process=pw.Coining(bottom="highest", height=1e-3))
    assert scene.bottom == pytest.approx(-0.17, abs=1e-15)
    assert scene.stroke == pytest.approx(0.1, abs=1e-15)
    (load,) = scene.linkage().loads_with_law
    assert isinstance(load, pw.Force)
    assert isinstance(load.law, pw.OverPosition)
    assert load.law.zero == pytest.approx(-0.169, abs=1e-15)
    assert abs(load.direction) == pytest.approx(math.pi, abs=1e-15)


def test_a_process_out_of_reach_is_refused():
    high = pw.Drawing(height=7e-3, bottom="highest")
    says = "height = 7 mm above bottom .* least 8 mm, .* 100 mm, the"
    with refused(says):
        replace(SLIDER_CRANK, process=high).check()


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            'B = ["0 mm", "-560 mm"] }\n\n[[mechanism.joints]]',
            'B = ["5 mm", "-560 mm"] }\n\n[[mechanism.joints]]',
            r"joint B: its points lie 5 mm apart in the drawing, rod \(0, -560\) mm and slide \(5,",
        ),
        (
            'first = ["0 mm", "0 mm"]',
            'first = ["0 mm", "40 mm"]',
            "joint O: .* 40 mm apart",
        ),
        (
            'direction = "90 deg"',
            'direction = "90 deg"\nx = "3 mm"',
            "guide: .* 3 mm apart.*the line",
        ),
    ],
)
def test_points_of_a_joint_coincide_in_the_drawing(tmp_path, old, new, message):
    text = example_file("points")
    changed_text = re.sub(r" +#.*", "", text).replace(old, new)
    assert changed_text.count(new) == 1
    with refused(message):
        scene_from(written(tmp_path, changed_text))


def test_a_slide_is_guided_where_it_is_drawn(tmp_path):
    """The drawing of a press, moved to the right, is the same press."""
    text = example_file("points")
    moved = re.sub(r'\["0 mm", ', '["730 mm", ', text)
    first, second = (
        motion_of(scene_from(written(tmp_path, one)).mechanism).at(np.zeros(1)).position
        for one in (text, moved)
    )
    assert second - first == pytest.approx(
        np.tile([0.73, 0.0, 0.0], 3)[np.newaxis], abs=1e-9
    )
