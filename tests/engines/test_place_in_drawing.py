"""Results do not depend on where the drawing puts a machine, nor on events at the same instant."""

from dataclasses import replace
from functools import cache

import pytest
from numpy.testing import assert_allclose
from runs import run_scene

import presswear as pw
from presswear.engines.base import Run
from presswear.linkage.linkage import Linkage
from presswear.linkage.points import GROUND, Attachment
from presswear.validation.cases import contacts_of


def moved(linkage: Linkage, x: float, y: float) -> Linkage:
    """Return a linkage that is drawn elsewhere."""

    def end(point: Attachment) -> Attachment:
        is_moved = point.body == GROUND
        return replace(point, x=point.x + x * is_moved, y=point.y + y * is_moved)

    pins = [
        replace(pin, first=end(pin.first), second=end(pin.second))
        for pin in linkage.revolutes
    ]
    guides = [replace(guide, x=guide.x + x, y=guide.y + y) for guide in linkage.guides]
    return linkage.changed(joints=[*pins, *guides])


MACHINES = {
    "press": (pw.Press().linkage(), "AC"),
    "four-bar": (pw.FourBar().linkage(), "B"),
}


@cache
def machine_run(name: str, x: float, y: float) -> Run:
    linkage, joints = MACHINES[name]
    bearing = pw.Bearing(clearance=0.5e-3, friction=0.1, restitution=0.7)
    bearings = dict.fromkeys(joints, bearing)
    scene = pw.Scene(moved(linkage, x, y), bearings=bearings, wear_updates=0)
    return run_scene(scene, scene.numerics.dae)


@pytest.mark.parametrize("name", MACHINES)
@pytest.mark.parametrize("distance", [33.0, 1000.0])
def test_a_machine_moves_alike_wherever_it_is_drawn(name, distance):
    # The first contacts lie before the horizon, up to which round-off of 1e-13 m stays
    # small.
    at_origin = machine_run(name, 0.0, 0.0)
    run = machine_run(name, distance, distance)
    for k in range(len(MACHINES[name][1])):
        contacts = contacts_of(run, k)
        expected = contacts_of(at_origin, k)
        for column, tolerance in (("touchdown", 1e-6), ("closing_speed", 1e-4)):
            assert_allclose(contacts[column][:3], expected[column][:3], rtol=tolerance)
