"""The press at work with ever stiffer joints: every figure becomes that of the ideal one."""

import re

import pytest
import stiff_joints


@pytest.mark.slow
def test_a_stiff_joint_becomes_ideal_in_every_figure(capsys: pytest.CaptureFixture[str]) -> None:
    """Places with order 1; forces and torques with about 1/2, the half power of a gap that opens.

    Where a joint's force passes zero at an even rate a pin crosses its clearance c in a time of
    c^(1/3) and arrives with c^(2/3); such an impact is of c^(4/5) K^(2/5), here c^(1/2).
    """
    stiff_joints.main()
    rows = [re.split(r"  +", line) for line in capsys.readouterr().out.splitlines()]
    found = {row[0]: [float(value) for value in row[1:]] for row in rows}
    assert len(found) == 10
    for name, (*values, order) in found.items():
        lowest, highest = (0.95, 1.05) if name.endswith("(m)") else (0.1, 1.1)
        assert lowest < order < highest, name
        assert values[-1] < 0.5 * values[0], name
