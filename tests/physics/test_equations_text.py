"""Text of the written equations: numbers, names, reasons, and what processes store."""

import ast
import os
import re
import subprocess
import sys
from dataclasses import replace

import pytest
from four_bar_linkage import FOUR_BAR
from test_equations import PRESS, RAMP, loose, written

import presswear as pw
from presswear.linkage.friction_law import FrictionLaw
from presswear.linkage.joints import Joint, Revolute
from presswear.linkage.linkage import Linkage
from presswear.physics.equations.text import Text
from presswear.physics.equations.writer import write_equations
from presswear.physics.packed import pack


def test_numbers_are_no_part_of_the_text():
    """Another clearance, speed, mass or law parameter compiles nothing."""
    one = loose(FOUR_BAR, "B")
    fast = loose(
        pw.FourBar(speed=40.0, coupler_mass=0.7).linkage(),
        "B",
        friction=FrictionLaw(0.2),
    )
    wide = tuple(replace(joint, clearance=3e-4) for joint in fast.clearances)
    first = written(one)
    second = written(replace(fast, clearances=wide))
    assert first.text == second.text
    assert first.numbers.keys() == second.numbers.keys()
    changed = {
        name for name, value in first.numbers.items() if value != second.numbers[name]
    }
    assert {
        "crank_omega",
        "coupler_mass",
        "B_clearance",
        "B_friction_coefficient",
    } <= changed


def test_names_of_bodies_and_joints_become_names_of_variables():
    """Also names that begin with a digit, share a beginning, or differ by signs only."""
    bodies = [
        pw.Bar("2 arm", 0.2, 1.0),
        pw.Bar("arm", 0.3, 1.0),
        pw.Bar("arm!", 0.3, 1.0),
        pw.Bar("arm 2", 0.3, 1.0),
    ]
    joints = [
        pw.Pin("a b", (0.0, 0.0), "2 arm.tail"),
        pw.Pin("2 arm", "2 arm.head", "arm.tail"),
        pw.Pin("a_b", "arm.head", "arm!.tail"),
        pw.Pin("arm", "arm!.head", "arm 2.tail"),
    ]
    drive = pw.Drive("2 arm", 10.0)
    text = written(pw.assemble(bodies, joints, [drive], output="arm")).text
    assigned = [
        line.split(" = ")[0].strip() for line in text.splitlines() if " = " in line
    ]
    assert len(assigned) == len(set(assigned))
    compile(text, "equations", "exec")


def test_a_name_cannot_become_code():
    """A result may come from anybody, and its equations are executed."""
    name = "arm\nraise SystemExit\r#\u2028raise SystemExit"
    text = Text()
    text.comment(name)
    assert text.prefix(name).isidentifier()
    joint = text.prefix('"""' + name)
    assert joint.isidentifier()
    assert ast.unparse(ast.parse("\n".join(line.strip() for line in text.lines))) == ""
    equations = written(replace(loose(FOUR_BAR, "B"), name=f'"""{name}\\'))
    (function,) = ast.parse(equations.text).body
    assert isinstance(function, ast.FunctionDef)
    assert not [node for node in ast.walk(function) if isinstance(node, ast.Raise)]


def rubbing_press() -> Linkage:
    """Return the press with friction in its rigid pin B."""
    joints: list[Joint] = []
    for joint in PRESS.joints:
        if isinstance(joint, Revolute) and joint.name == "B":
            joints.append(replace(joint, bearing_radius=0.01, friction=RAMP))
        else:
            joints.append(joint)
    return PRESS.changed(joints=joints)


@pytest.mark.parametrize(
    ("linkage", "reason"),
    [
        (PRESS, "the drives hold every body"),
        (loose(PRESS, "A"), "joint guide closes a loop"),
        (loose(rubbing_press(), "A", "C"), "joint . rubs without clearance"),
    ],
)
def test_a_linkage_without_written_equations_is_named_with_its_reason(
    linkage: Linkage, reason
):
    result = write_equations(linkage, pack(linkage))
    assert isinstance(result, str)
    assert re.search(reason, result)


STORED = """
import sys
import numpy as np
from presswear.physics.equations import body_forces
from presswear.physics.equations.body_forces import BodyForces
from presswear.physics.equations.function import function_of
from presswear.tools.compile import call_entry, compiled, entry_of

TEXT = "def equations(model, t, y, out, level):\\n    out[0] = {}\\n"

@compiled
def called(entry, model, t, y, out, level):
    call_entry(entry, (model, t, y, out, level))

values = [float(word) for word in sys.argv[1:]]
y, out = np.zeros((2, 1))
kernels = [function_of(TEXT.format(value)) for value in values]
entries = [entry_of(kernel, 0, 0.0, y, y, 2) for kernel in kernels]
for kernel in kernels:
    called(entry_of(kernel, 0, 0.0, y, y, 2), 0, 0.0, y, out, 2)
    print(*out)
"""


def test_equations_that_other_processes_stored_are_not_mistaken(tmp_path):
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path)}
    for values in ("1.0",), ("2.0", "1.0"):
        command = [sys.executable, "-c", STORED, *values]
        ran = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=True
        )
        assert ran.stdout.split() == list(values)
