"""Guides on moving bodies as data: files, drawings, angles at the start, and messages."""

import math
from typing import Any

import pytest
from slotted import quick_return, scotch_yoke, swinging_block

import presswear as pw
from presswear.linkage.bodies import Body
from presswear.linkage.joints import Guide, Pin
from presswear.linkage.linkage import assemble
from presswear.linkage.part_checks import start_angles
from presswear.linkage.topology import branches_of
from presswear.scene.scene import Scene
from presswear.tools.errors import InputError
from presswear.tools.serialize import make


def test_a_slot_leads_through_the_block_as_drawn():
    """Its line is in the frame of the body that carries it."""
    linkage = assemble(
        bodies=[
            Body("crank", 1.0, 0.1, {"O": (0.0, 0.3), "A": (0.1, 0.3)}, (0.05, 0.3)),
            Body("block", 0.5, 1e-3, {"A": (0.1, 0.3)}, (0.1, 0.3)),
            Body("rocker", 2.0, 0.1, {"P": (0.0, 0.0)}, (0.02, 0.2)),
        ],
        joints=[
            Pin("O", (0.0, 0.3), "crank.O"),
            Pin("A", "crank.A", "block.A"),
            Pin("P", (0.0, 0.0), "rocker.P"),
            Guide("slot", "block", direction=math.atan2(0.3, 0.1), on="rocker"),
        ],
        drives=[pw.Drive("crank", 1.0)],
    )
    slot = linkage.guides[0]
    assert (slot.x, slot.y) == pytest.approx((0.08, 0.1))
    start = Scene(linkage, joints="none").ideal.position[0]
    assert start[:, 2] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_angles_pass_through_slots_in_both_directions():
    guides = [
        Guide("a", "block", angle=0.2, on="rocker"),
        Guide("b", "second", angle=0.3, on="block"),
        Guide("c", "rod", angle=0.1, on="swivel"),
    ]
    drives = [pw.Drive("rod", angle=0.5)]
    angles = start_angles(guides, drives, {"rocker": 1.0})
    expected = {"rocker": 1.0, "block": 1.2, "second": 1.5, "rod": 0.5, "swivel": 0.4}
    assert angles == pytest.approx(expected)


def test_a_block_in_a_yoke_needs_no_inertia():
    """A yoke on the frame does not turn, so that its block does not; a rocker does."""
    bodies = {body.name: body for body in scotch_yoke().bodies}
    assert bodies["block"].inertia == 0.0
    linkage = quick_return()
    blocks = [Body("block", 0.5) if b.name == "block" else b for b in linkage.bodies]
    with pytest.raises(InputError, match="inertia of block = 0 kg m"):
        linkage.changed(bodies=blocks)


def test_trees_hang_from_either_end_of_a_slot():
    swinging = Scene(swinging_block(), joints="P").linkage()
    branches = branches_of(swinging)
    assert not isinstance(branches, str)
    assert [branch.end.body for branch in branches] == ["rod", "block"]
    assert (branches[1].turn, branches[1].slope) == (0.0, 0.0)


SLOT: dict[str, Any] = {"name": "slot", "body": "block", "on": "rocker"}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"on": "block"}, "guide slot: on = block: must be another body, or frame"),
        (
            {"stiffness": 1e6},
            r"guide slot: stiffness = 1e\+06 N/m with on = rocker: al",
        ),
        ({"on": "rokcer"}, "body in on of guide slot 'rokcer'.*rocker"),
    ],
)
def test_wrong_slots_are_refused_by_name(changes, message):
    linkage = quick_return()
    with pytest.raises(InputError, match=message):
        linkage.changed(
            joints=[*linkage.revolutes, make("joints[3]", Guide, SLOT | changes)]
        )
