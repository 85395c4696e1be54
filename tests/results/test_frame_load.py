"""Loads of an elastic frame: closed forms of a slow stop, reverse force, texts of the report."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from upright_press import SHEET, upright_crank

import presswear as pw
from presswear.results.export import table_of
from presswear.results.frame_load import frame_loads
from presswear.results.strokes import sampled_strokes
from presswear.show.key_numbers import key_numbers
from presswear.show.limits import limit_lines
from presswear.show.report import write_report
from presswear.show.stage_tables import stage_tables

FRAME = 0.5e9
STOP = 2e9
WEIGHT = 9.81 * 1010.0
SNAPPING = replace(SHEET, snap=2e-5)


def pressed(process: Any, bearings: Any = None, **frame: Any) -> pw.Result:
    """Run an upright slider-crank of 410 kg for a stroke, on a crown of 600 kg."""
    crank = upright_crank(**frame)
    joints = {"joints": "none"} if bearings is None else {"bearings": bearings}
    return pw.run(pw.Scene(crank, process=process, cycles=2, **joints))


def on_frame(process: Any, damping: float) -> pw.Result:
    frame = {"frame_mass": 600.0, "frame_stiffness": FRAME, "frame_damping": damping}
    return pressed(process, **frame)


def test_a_stop_stretches_the_frame():
    """Within the inertia of the slide at the bottom, 0.6 kN, and what the frame swings."""
    result = on_frame(pw.Coining(stiffness=STOP, height=2e-4), damping=0.5)
    (load,) = frame_loads(result.scene, result.stages[0]).values()
    (stretch,) = [
        number
        for number in key_numbers(result)
        if number.name == "Stretch of the frame"
    ]
    assert stretch.meaning.endswith(
        "; both from rest under the carried weight, 9\u202f910 N."
    )
    force = (2e-4 + WEIGHT / FRAME) / (1.0 / STOP + 1.0 / FRAME)
    assert load.force.mean == pytest.approx(force, rel=0.02)
    assert load.stretch.mean == pytest.approx(load.force.mean / FRAME)
    assert load.reverse_force is None
    bottom = result.stages[0].statistics.bdc
    error = (force - WEIGHT) / FRAME
    assert bottom.error.mean == pytest.approx(error, rel=0.05)


def test_a_frame_without_weight_has_no_weight_in_the_report():
    frame = {"frame_mass": 600.0, "frame_stiffness": FRAME, "gravity": 0.0}
    result = pressed(pw.Coining(stiffness=STOP, height=2e-4), **frame)
    (stretch,) = [
        number
        for number in key_numbers(result)
        if number.name == "Stretch of the frame"
    ]
    assert "weight" not in stretch.meaning


def test_the_frame_swings_back_after_a_fracture():
    """To the other side by the force at the fracture, less half a period of damping."""
    result = on_frame(SNAPPING, damping=0.05)
    stage = result.stages[0]
    strokes = result.strokes(0)
    (load,) = frame_loads(result.scene, stage).values()
    stretch = stage.arrays["stretch"]
    assert stretch.shape == (stage.time.size, 1)
    end = strokes.fracture[-1, 0]
    at_break = FRAME * float(np.interp(end, stage.time, stretch[:, 0])) + WEIGHT
    assert load.reverse_force.mean == pytest.approx(
        math.exp(-0.05 * math.pi) * at_break, rel=0.1
    )
    lines = {line.number.name: line for line in limit_lines(result.scene, stage)}
    line = lines["Reverse force of the frame"]
    assert (line.limit, line.verdict.word) == ("10 %", "above the limit")
    assert "reverse force over greatest force" in f"{stage_tables(result)['tonnage']}"
    assert np.array_equal(table_of(result, 0)["frame_stretch"], stretch[:, 0])


@pytest.mark.parametrize(("damping", "excessive"), [(0.6, False), (0.57, True)])
def test_a_reverse_force_above_10_percent_is_warned_of(damping, excessive):
    """The force of the spring is the greatest where the frame has it most stretched."""
    result = on_frame(SNAPPING, damping)
    stage = result.stages[0]
    # The second of two strokes that begin at the top; the sheet breaks once.
    late = stage.time >= 0.5
    load = (FRAME * stage.arrays["stretch"][:, 0] + WEIGHT)[late]
    part = -load.min() / load.max()
    assert part == pytest.approx(0.1, abs=0.02)
    (line,) = [
        line
        for line in limit_lines(result.scene, stage)
        if line.number.name == "Reverse force of the frame"
    ]
    assert (line.verdict.word == "above the limit") == excessive == (part > 0.1)


def test_an_elastic_pin_carries_the_work_and_the_inertia_of_the_slide():
    """F - m (g + a), with the acceleration of the slide; the damper takes little."""
    pin = pw.Bearing(clearance=0.0, stiffness=FRAME, damping_ratio=0.02)
    result = pressed(SHEET, bearings={"B": pin})
    stage = result.stages[0]
    (forces,) = result.elastic_pin_forces(0).values()
    process = result.process_force(0)
    expected = np.abs(process - 300.0 * (9.81 + stage.acceleration))
    (stroke,) = sampled_strokes(result.scene, stage)
    for phase, (start, end) in stroke.phases.items():
        within = expected[(stage.clock >= start) & (stage.clock <= end)]
        assert forces[phase].mean == pytest.approx(within.max(), rel=0.03)
    assert forces["approach"].mean < 5e3 < 9e4 < forces["work"].mean
    table = f"{stage_tables(result)['elastic_pins']}"
    assert "Elastic pin B" in table
    assert "greatest in a stroke, snap-through" in table
    columns = table_of(result, 0)
    assert FRAME * columns["B_stretch"].max() == pytest.approx(
        max(estimate.mean for estimate in forces.values()), rel=1e-3
    )


def test_a_report_without_work_has_the_force_of_an_elastic_pin(tmp_path):
    pin = pw.Bearing(clearance=0.0, stiffness=FRAME)
    result = pw.run(pw.Scene(upright_crank(), cycles=2, bearings={"B": pin}), tmp_path)
    text = write_report(result, has_all_figures=False).read_text()
    for part in ("Elastic pin B", "in a stroke, approach", "in a stroke, return"):
        assert part in text
    assert "snap-through" not in text
    assert "Tonnage and shock" not in text


def test_a_rigid_frame_has_no_load():
    result = pressed(pw.Coining(stiffness=STOP, height=2e-4))
    assert frame_loads(result.scene, result.stages[0]) == {}
    assert "stretch" not in result.stages[0].arrays
    assert "Elastic" not in f"{stage_tables(result)['tonnage']}"
