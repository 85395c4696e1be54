"""Numbers that are followed through a life."""

import numpy as np
import pytest

from presswear.campaign.service_life import levels_of, samples_of
from presswear.physics.ideal import bottom_of
from presswear.physics.wear import map_shape
from presswear.recording.observe import CYCLE_FIXED, CYCLE_JOINT
from presswear.results.life import WORDS
from presswear.scene.catalog import press_blanking
from presswear.scene.options import FOLLOWED


def test_every_number_is_followed_and_has_words() -> None:
    scene = press_blanking(conventions="refined", replicates=2)
    joints = scene.linkage().clearances
    worn = np.zeros((2, *map_shape(joints)))
    rows = np.zeros((2, 4, len(CYCLE_FIXED) + 2 * len(CYCLE_JOINT)))
    found = [*levels_of(scene, worn, tuple(FOLLOWED)), *samples_of(scene, rows)]
    wanted = {
        f"{joint}.{name}" if own.of_joint else name
        for name, own in FOLLOWED.items()
        for joint in "AC"
    }
    assert set(found) == wanted
    assert set(WORDS) == set(FOLLOWED)


def test_they_are_what_surfaces_and_strokes_give() -> None:
    scene = press_blanking(conventions="refined", replicates=2)
    joints = scene.linkage().clearances
    worn = np.zeros((2, *map_shape(joints)))
    worn[0, 0, 1, 7] = 3e-6  # the pin of A in one bin
    worn[1, 1, 0, :] = 1e-6  # the bearing of C all around
    found = levels_of(scene, worn, ())
    assert found["A.depth"].tolist() == [3e-6, 0.0]
    assert found["C.depth"].tolist() == [0.0, 1e-6]
    around = 2.0 * np.pi * joints[1].bearing_radius * joints[1].width * 1e-6
    assert found["C.wear_volume"][1] == pytest.approx(around, rel=1e-12, abs=0.0)
    ideal = bottom_of(scene.ideal)
    assert ideal is not None
    rows = np.zeros((2, 4, len(CYCLE_FIXED) + 2 * len(CYCLE_JOINT)))
    off = np.array([[1.0, 2.0, 3.0, 4.0], [5.0, 5.0, 5.0, 5.0]])
    rows[:, :, CYCLE_FIXED.index("bottom_height")] = ideal.height + off
    place = len(CYCLE_FIXED) + len(CYCLE_JOINT) + CYCLE_JOINT.index("force_max")
    rows[0, :, place] = 10.0, 20.0, 30.0, 40.0
    told = samples_of(scene, rows)
    assert told["bdc_error"] == pytest.approx([2.5, 5.0])
    assert told["bdc_drift"] == pytest.approx([2.5, 5.0])
    assert told["repeatability"] == pytest.approx([5.0 / 3.0, 0.0])
    assert told["C.force_max"].tolist() == [25.0, 0.0]
    assert told["A.force_max"].tolist() == [0.0, 0.0]
