"""Worn depth of a run, computed once more from its stored forces, places and sliding."""
# mypy: disable-error-code="union-attr,operator,index,arg-type"

import numpy as np

import presswear as pw
from presswear.tools.arrays import Array

CYCLES = 4  # of a run, the first two without wear
NODES = 5  # in a bin


def archard_per_cycle(result: pw.Result, bins: int) -> Array:
    """Return the depth of pin and bearing that a cycle adds without running-in, (bins,), m.

    K p (p / p_ref)^(m - 1) of a round elastic foundation, by angle on the slider, which
    does not turn.
    """
    bearing = result.scene.bearing("B")
    pair = bearing.materials
    joint = result.stages[0].joints["B"]
    time = result.stages[0].time
    x = joint.series("eccentricity_x")
    y = joint.series("eccentricity_y")
    angle = (np.arange(NODES * bins) + 0.5) * 2.0 * np.pi / (NODES * bins)
    overlap = np.hypot(x, y)[:, np.newaxis] * np.cos(
        angle - np.arctan2(y, x)[:, np.newaxis]
    )
    overlap = np.maximum(overlap - bearing.clearance, 0.0)
    integral = overlap.sum(axis=1, keepdims=True) * (angle[1] - angle[0])
    share = np.divide(overlap, integral, out=np.zeros_like(overlap), where=integral > 0)
    force = joint.series("normal")[:, np.newaxis]
    pressure = force * share / (bearing.width * bearing.bearing_radius)
    m = pair.pressure_exponent
    rate = pair.wear_coefficient * pressure**m * pair.pressure_reference ** (1.0 - m)
    rate = rate.reshape(len(time), bins, NODES).mean(axis=2)
    rate *= np.abs(joint.series("sliding"))[:, np.newaxis]
    worn = time >= 2.0 * result.scene.mechanism.period
    return np.asarray(np.trapezoid(rate[worn], time[worn], axis=0) / (CYCLES - 2))


def test_depth_is_that_of_the_stored_series():
    """Running-in and a power of the pressure, on the pin of the slider, within 2 %."""
    scene = pw.scenes.slider_crank(
        conventions="refined",
        engine="dae",
        cycles=CYCLES,
        recorded_cycles=CYCLES,
        replicates=1,
        wear_updates=1,
        extrapolation="single",
        wear_maps="raw",
        cycles_per_update=2e5,
        running_in=20.0,
        running_in_depth="6 um",
        pressure_exponent=0.7,
        pressure_reference="8 MPa",
    )
    result = pw.run(scene, jobs=1)
    pair = scene.bearing("B").materials
    depth = result.stages[1].joints["B"].depth("pin")
    cycle = archard_per_cycle(result, depth.size)
    archard = 2e5 * (1.0 - pair.bearing_share) * cycle
    # h with dh / dx = 1 + (rho - 1) exp(-h / h_0) from h = 0
    h_0 = pair.running_in_depth
    expected = h_0 * np.log1p(pair.running_in * np.expm1(archard / h_0))
    assert np.abs(depth - expected).sum() < 0.02 * depth.sum()
    assert np.abs(depth - archard).sum() > 0.4 * depth.sum()
