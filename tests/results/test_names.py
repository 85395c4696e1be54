"""Names of joints and bodies, carried from a run to its report and its table."""

import csv
from dataclasses import replace
from pathlib import Path

import pytest

import presswear as pw
from presswear.__main__ import main
from presswear.linkage.linkage import Linkage
from presswear.linkage.mechanisms import FOUR_BAR
from presswear.scene.scene import Scene
from presswear.scene.settings import changed


def named(*names: str) -> Linkage:
    """Return the four-bar with its last joints renamed."""
    kept, last = FOUR_BAR.joints[: -len(names)], FOUR_BAR.joints[-len(names) :]
    renamed = [replace(joint, name=name) for joint, name in zip(last, names, strict=True)]
    return FOUR_BAR.changed(joints=(*kept, *renamed))


@pytest.mark.parametrize("name", ["main_pin", "time", "all", "Bolzen Ø 20", "2", "depth_pin"])
def test_a_name_is_carried_to_the_table(name: str, tmp_path: Path) -> None:
    settings = {"engine": "dae", "integration_tolerance": "1e-6", "cycles": "1", "replicates": "1"}
    scene = changed(Scene(mechanism=named(name), joints=name, wear_updates=0), settings)
    out = tmp_path / "out"
    pw.run(scene, out)
    assert name in pw.load(out).stages[0].joints
    assert main(["report", str(out)]) == 0
    assert main(["export", str(out), str(tmp_path / "table.csv"), "--stage", "0"]) == 0
    with (tmp_path / "table.csv").open() as opened:
        header = next(csv.reader(line for line in opened if not line.startswith("#")))
    assert f"{name}_penetration" in header


@pytest.mark.parametrize("name", ["", " pin", "a/b", "a.b", "a,b", "a\nb", "none", "../x"])
def test_a_name_that_files_or_lists_cannot_hold_is_refused(name: str) -> None:
    with pytest.raises(pw.InputError, match="name"):
        named(name)


def test_two_joints_whose_arrays_could_be_mixed_up_are_refused() -> None:
    with pytest.raises(pw.InputError, match="must not begin with B_, because B is a joint too"):
        named("B", "B_force")
