"""Slots with clearance in scenes: the map of their walls, refusals, and files."""

from dataclasses import replace

import pytest
from slotted import (
    driven_rod,
    quick_return,
    scotch_yoke,
    sized,
    slotted_crank,
)

import presswear as pw
from presswear.scene.settings import changed

L, W, C = 0.06, 0.04, 0.2e-3  # of the block and its slot, m


def test_the_map_of_a_wall_reaches_over_the_travel_of_the_block():
    """The crank of 0.1 m turns 0.3 m above the pivot, 0.2 m before the point of the slot."""
    mechanism = sized(quick_return(), "slot", L, W)
    scene = pw.Scene(mechanism, joints="slot", bearings=pw.Bearing(clearance=C))
    walls = {corner.wall for corner in scene.linkage().corners}
    (wall,) = walls
    assert wall is not None
    assert wall.start + 0.5 * wall.length == pytest.approx(0.1, abs=1e-9)
    assert wall.length == pytest.approx(1.02 * (0.2 + L), rel=1e-6)


def test_what_a_slot_cannot_have_is_refused():
    play = pw.Bearing(clearance=C)
    with pytest.raises(pw.InputError, match="width of slot: a guide with clearance"):
        pw.Scene(sized(scotch_yoke(), "slot", L, None), joints="slot", bearings=play)
    rod = sized(driven_rod(), "bore", L, W)
    with pytest.raises(pw.InputError, match="bearings of bore: rod has a drive"):
        pw.Scene(rod, joints="bore", bearings=play)
    # The ways of the yoke let the block turn, which has no inertia.
    yoke = sized(scotch_yoke(), "ways", 0.2, 0.1)
    with pytest.raises(pw.InputError, match=r"inertia of block = 0 kg m\^2: must"):
        pw.Scene(yoke, joints="ways", bearings=play).linkage()
    yoke = sized(scotch_yoke(), "slot", L, W).changed(output="block")
    moved = pw.Scene(yoke, joints="slot", bearings=play)
    work = {"process": "coining", "process.offset": "10 mm"}
    with pytest.raises(pw.InputError, match=r"process.offset = 10 mm: .* is on yoke"):
        changed(moved, work).check()


def test_a_slot_on_a_driven_body_is_explained():
    scene = pw.Scene(slotted_crank(), joints="A", wear_updates=0)
    with pytest.raises(
        pw.InputError, match="slot is on crank, whose motion drives pre"
    ):
        replace(scene, engine="exudyn-tree").check()
    assert replace(scene, engine="exudyn").solver.word == "exudyn-joints"


QUICK_RETURN = """
[mechanism]
kind = "linkage"
output = "rocker"
gravity = "0 m/s^2"
guess = {rocker = "60 deg"}
bodies = [
    {name = "crank", length = "100 mm", mass = "1 kg"},
    {name = "block", mass = "0.5 kg", inertia = "1e-3 kg m^2"},
    {name = "rocker", mass = "2 kg", inertia = "0.1 kg m^2", points.pivot = ["-200 mm", 0.0]},
]
joints = [
    {name = "O2", first = [0.0, "300 mm"], second = "crank.tail"},
    {name = "A", first = "crank.head", second = "block"},
    {name = "O4", first = [0.0, 0.0], second = "rocker.pivot"},
    {name = "slot", body = "block", on = "rocker", length = "60 mm", width = "40 mm"},
]
drives = [{body = "crank", speed = "300 rpm"}]

[bearings]
joints = "slot"

[bearings.slot]
clearance = "0.2 mm"
"""


def test_a_file_has_a_slot_with_clearance(tmp_path):
    file = tmp_path / "slot.toml"
    file.write_text(QUICK_RETURN)
    scene = pw.scene_from(file)
    play = pw.Bearing(clearance=0.2e-3)
    same = pw.Scene(sized(quick_return(), "slot", L, W), bearings={"slot": play})
    assert scene.linkage().corners == same.linkage().corners
    wider = changed(scene, {"slot.clearance": "0.3 mm"})
    assert {corner.clearance for corner in wider.linkage().corners} == {0.3e-3}
