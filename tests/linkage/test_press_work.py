"""Forces of blanking and drawing over the way: work, continuity, cushion and stop."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import quad

from presswear.linkage.process import Blanking, Coining, Drawing, laws_of

sizes = st.floats(1.0, 1e7)
depths = st.floats(1e-5, 0.1)
blanks = st.builds(
    Blanking,
    force=sizes,
    thickness=depths,
    rise=depths,
    # No shorter than a millionth of the length, the resolution of a table.
    plateau=st.floats(0.05, 1.0),
    snap=depths,
    cushion=st.floats(0.0, 1e5),
)
peaks = st.floats(0.05, 0.95)
cups = st.builds(
    Drawing, force=sizes, depth=depths, peak=peaks, cushion=st.floats(0.0, 1e5)
)


@given(st.one_of(blanks, cups))
def test_work_is_the_integral_of_a_continuous_force(
    process: Blanking | Drawing,
):
    """Steep only where a sheet snaps through; the law pushes against the way in by as much."""
    places, forces = np.array(process.curve).T
    assert forces[0] == forces[-1] == 0.0
    assert forces.max() == pytest.approx(process.force)
    law = laws_of(process, 0.2, 0.03)[process.kind]

    def size(depth: float) -> float:
        return float(np.interp(-depth, *np.array(law.table).T))

    work = sum(quad(size, *piece)[0] for piece in pairwise(places))
    assert process.work == pytest.approx(work, rel=1e-9)
    gap = 1e-9 * places[-1]
    steepest = np.abs(np.diff(forces) / np.diff(places)).max()
    for place in places:
        assert abs(size(place + gap) - size(place - gap)) <= 2.001 * steepest * gap
    assert law.release
    assert law.zero == 0.2
    assert law.unloading == pytest.approx((np.diff(forces) / np.diff(places)).max())
    # A new blank lies there once the old one was left by the lift.
    assert max(place for place, _ in law.table) == 0.03
    if isinstance(process, Blanking):
        assert np.interp(process.fracture, places, forces) == process.force
        assert process.fracture - places[1] == pytest.approx(
            process.plateau * process.thickness
        )
        assert places[-1] - process.fracture == pytest.approx(process.snap)


@given(cups)
def test_a_drawing_force_lies_on_half_cosines(cup: Drawing):
    peak = cup.peak * cup.depth
    for depth, force in cup.curve:
        part = (
            depth / peak if depth <= peak else (cup.depth - depth) / (cup.depth - peak)
        )
        exact = cup.force * np.sin(0.5 * np.pi * part) ** 2
        assert force == pytest.approx(exact, abs=1e-9 * cup.force)


def test_a_cushion_and_a_stop_push_both_ways():
    held = laws_of(Drawing(cushion=20.0), 0.1, 0.01)["cushion"]
    stop = laws_of(Coining(stiffness=1e5), 0.1, 0.01)["coining"]
    for law, size in ((held, 20.0), (stop, 1e5 * 5e-3)):
        assert law.sense == "both"
        assert not law.release
        assert law.outside == "hold"
        assert np.interp(-5e-3, *np.array(law.table).T) == pytest.approx(size)
        assert np.interp(1e-9, *np.array(law.table).T) == 0.0
