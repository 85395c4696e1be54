"""Inverse dynamics of ideal mechanisms against virtual work and statics."""

import numpy as np
import pytest
from closed_form import needed_by_virtual_work, press_motion

import presswear as pw
from presswear.linkage.loads import OverPosition
from presswear.physics.ideal import motion_of
from presswear.physics.statics import check_drives, needed_torques
from presswear.tools.errors import InputError


@pytest.mark.parametrize("run_up", [0, 1])
def test_torques_of_the_press_are_those_of_virtual_work(run_up: int) -> None:
    """Under a stop and weights; behind a run-up the cycle is the same."""
    press = pw.Press(run_up=run_up)
    stop = OverPosition([(-0.6, 200.0), (-0.5, 0.0)], outside="hold")
    plain = press.linkage()
    linkage = plain.changed(loads=[pw.Force("slider 6", 0.5 * np.pi, stop)])
    within = np.linspace(0.0, press.period, 101)
    place = press_motion(press, within).output(plain)[:, 0]
    upwards = np.interp(place, *np.array(stop.table).T)
    result = needed_torques(linkage, motion_of(linkage), linkage.run_up_time + within)
    expected = needed_by_virtual_work(press, within, upwards)
    np.testing.assert_allclose(result, expected, atol=1e-9 * np.abs(expected).max())


def test_a_limit_is_that_of_the_greatest_torque() -> None:
    """A bar on a pin at even speed bears its weight alone: m g r."""
    bar = pw.Bar("crank", length=0.4, mass=2.0)
    weight = 2.0 * 9.81 * 0.2

    def made(limit: float) -> pw.Linkage:
        drive = pw.Drive("crank", speed=5.0, angle=0.3, torque_limit=limit)
        return pw.assemble([bar], [pw.Pin("O", (0.0, 0.0), "crank.tail")], [drive])

    enough, little = made(1.001 * weight), made(0.999 * weight)
    check_drives(enough, motion_of(enough))
    says = r"torque_limit of crank = 3\.92008 N m: the ideal motion needs 3\.924 N m, 568\.\d+ ms"
    with pytest.raises(InputError, match=says):
        check_drives(little, motion_of(little))
    with pytest.raises(InputError, match="torque_limit of crank = 0 N m: allowed is 1e-06 to"):
        made(0.0)
