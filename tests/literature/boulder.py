"""Motor-driven slider-crank of the University of Colorado: model, fit and prediction.

The measured curves are mean speeds of the wheel over bins of 10 degrees. Speeds tell
only ratios to the inertia of the wheel, which is set to INERTIA; torques and masses
below are those of this wheel. The rod is light: its mass is part of the collar and of
the imbalance.
"""

import math
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import Literal, Self

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

import presswear as pw
from presswear.linkage.linkage import Linkage
from presswear.tools.arrays import Array

DATA = Path(__file__).parent / "data" / "boulder_slider_crank.csv"
CRANK, ROD, OFFSET = 0.07745, 0.2521, 0.1495  # m
INERTIA = 0.01  # of the wheel about its axis, kg m^2
WHEEL_MASS = 10.0  # kg; it only places the mass centre of a given imbalance
ROD_MASS = 1e-4  # kg
SLIP = 0.5  # of the motor, at which its torque is stated
BINS = 36
CYCLES = 4  # turns until the last repeats
REACH = 0.5  # of the stored quantities, within which the fit searches
STEP = 1e-2  # relative, of differences: above the errors of a run
PREDICTED = (6.5, 7.5, 9.5)  # V

Voltages = tuple[float, ...]


@dataclass(frozen=True)
class Rig:
    """Fitted quantities of the rig, SI; the defaults are those of the fit to all voltages."""

    zero: float = 1.49643  # angle of the crank at wheel angle 0, rad
    torque_per_volt: float = 0.461389  # of the motor at rest, N m/V
    torque_per_speed: float = 0.188795  # slope of the motor line, N m s/rad
    bearing_friction: float = 0.85167  # moment, N m
    collar_mass: float = 0.470054  # kg
    collar_friction: float = 5.12583  # force on the guide, N
    imbalance_along: float = (
        0.0272382  # mass times distance, towards the crank pin, kg m
    )
    imbalance_across: float = -0.00996898  # 90 degrees ahead of the crank pin, kg m

    @classmethod
    def of(cls, values: Array) -> Self:
        """Return the rig with the fitted quantities in their order."""
        return cls(*map(float, values))

    @property
    def values(self) -> Array:
        """Fitted quantities in their order."""
        return np.array(astuple(self))


@dataclass(frozen=True)
class Fit:
    """Result of a fit."""

    rig: Rig
    covariance: Array  # of the fitted quantities
    scatter: float  # of a bin, part of the mean speed
    message: str  # why the fit ended


def measured() -> dict[float, Array]:
    """Return the measured mean speeds in the bins, rad/s, by voltage."""
    rows = [
        line for line in DATA.read_text("utf-8").splitlines() if line[:1].isnumeric()
    ]
    table = np.array([[float(value) for value in line.split(",")] for line in rows])
    return dict(zip((5.5, 8.5, 10.5), table.T[1:], strict=True))


def against(force: float) -> list[pw.Force]:
    """Return Coulomb friction of the collar: a constant force against either motion, N."""
    senses: tuple[tuple[Literal["against", "along"], float], ...]
    senses = (("against", force), ("along", -force))
    return [
        pw.Force(
            "collar",
            0.5 * math.pi,
            pw.OverPosition([(-1.0, size), (1.0, size)], sense=sense, outside="hold"),
            name=f"friction {sense}",
        )
        for sense, size in senses
    ]


def linkage(rig: Rig, voltage: float) -> Linkage:
    """Return the linkage; the collar slides upright below the wheel, beside its axis."""
    no_load = rig.torque_per_volt * voltage / rig.torque_per_speed
    motor = pw.Motor(
        rig.torque_per_volt * voltage * SLIP,
        slip=SLIP,
        breakdown=None,
        no_load_speed=no_load,
    )
    centre = (rig.imbalance_along / WHEEL_MASS, rig.imbalance_across / WHEEL_MASS)
    steiner = WHEEL_MASS * math.hypot(*centre) ** 2
    points = {
        "axis": (-centre[0], -centre[1]),
        "pin": (CRANK - centre[0], -centre[1]),
    }
    return pw.assemble(
        bodies=[
            pw.Body("wheel", WHEEL_MASS, INERTIA - steiner, points=points),
            pw.Bar("rod", ROD, ROD_MASS),
            pw.Body("collar", rig.collar_mass),
        ],
        joints=[
            pw.Pin("O", (0.0, 0.0), "wheel.axis"),
            pw.Pin("A", "wheel.pin", "rod.tail"),
            pw.Pin("B", "rod.head", "collar"),
            pw.Guide("guide", "collar", x=-OFFSET, y=0.0, direction=0.5 * math.pi),
        ],
        drives=[pw.Drive("wheel", 0.85 * no_load, rig.zero, motor=motor)],
        output="collar",
        guess={"rod": -0.5 * math.pi},
        loads=[
            pw.Load("wheel", moment=-rig.bearing_friction),
            *against(rig.collar_friction),
        ],
    )


def speeds(rig: Rig, voltage: float) -> Array:
    """Return the mean speeds in the bins of the last turn, rad/s; 0 where the motor stalls."""
    parts = linkage(rig, voltage)
    recording = pw.Recording(recorded_cycles=CYCLES, rows_per_cycle=500)
    scene = pw.Scene(parts, cycles=CYCLES, recording=recording, replicates=1)
    try:
        stage = pw.run(scene, engine="dae").stages[0]
    except pw.RunFailed:
        return np.zeros(BINS)
    period = 2.0 * math.pi / parts.drives[0].speed
    # The last row lies up to one interval before the end, 7 % of a bin; the last bin
    # is therefore that of the turn before.
    edges = (CYCLES - 1 + np.arange(-1, BINS) / BINS) * period
    if stage.time[-1] < edges[-1]:
        return np.zeros(BINS)
    return np.roll(2.0 * math.pi / BINS / np.diff(stage.clock_of(edges)), -1)


def residuals(rig: Rig, voltages: Voltages) -> Array:
    """Return model less measurement, part of the mean speed of each voltage."""
    curves = measured()
    return np.concatenate(
        [(speeds(rig, v) - curves[v]) / curves[v].mean() for v in voltages]
    )


def fitted(voltages: Voltages) -> Fit:
    """Fit the rig to the curves of the voltages, from the stored quantities."""
    first = Rig().values
    found = least_squares(
        lambda scale: residuals(Rig.of(scale * first), voltages),
        np.ones(first.size),
        bounds=(1.0 - REACH, 1.0 + REACH),
        diff_step=STEP,
        x_scale="jac",
        xtol=1e-4,
        ftol=1e-5,
        max_nfev=20,
    )
    variance = float(found.fun @ found.fun) / (found.fun.size - first.size)
    covariance = variance * np.linalg.inv(found.jac.T @ found.jac)
    return Fit(
        Rig.of(found.x * first),
        covariance * np.outer(first, first),
        math.sqrt(variance),
        found.message,
    )


def numbers(curve: Array) -> Array:
    """Return the mean over the bins and the range over them, rad/s."""
    return np.array([curve.mean(), np.ptp(curve)])


def left_out() -> Array:
    """Return errors of mean and range, and the least speed, one voltage a row.

    Each voltage is predicted from the fit to the two others. A voltage at which that
    fit stalls has no error and no row.
    """
    curves = measured()
    rows = []
    for voltage, curve in curves.items():
        fit = fitted(tuple(v for v in curves if v != voltage))
        model = speeds(fit.rig, voltage)
        error = numbers(model) - numbers(curve)
        print(f"without {voltage} V: scatter {fit.scatter:.4f}, {fit.rig}")
        print("    deviations", np.sqrt(np.diag(fit.covariance)))
        print("    error of mean and range", error if model.any() else "none: stalls")
        if model.any():
            rows.append([*error, curve.min()])
    return np.array(rows)


def parameter_variance(fit: Fit, voltage: float) -> Array:
    """Return the variance of mean and range that the covariance of the fit causes."""
    values = fit.rig.values
    base = numbers(speeds(fit.rig, voltage))
    slopes = []
    for k in range(values.size):
        moved = values.copy()
        moved[k] *= 1.0 + STEP
        change = numbers(speeds(Rig.of(moved), voltage)) - base
        slopes.append(change / (values[k] * STEP))
    gradient = np.array(slopes)
    variance: Array = np.einsum("ik,ij,jk->k", gradient, fit.covariance, gradient)
    return variance


def half_widths(fit: Fit, errors: Array, voltage: float) -> tuple[Array, Array]:
    """Return the half widths of mean and range, 95 %, rad/s, and the three variances.

    The variances are those of the parameters, of the bins, and of the left-out voltages.
    An error of the work changes the square of the speed: an error of a range is
    taken as inverse to the least speed. The factor is Student's for the left-out errors.
    """
    curve = speeds(fit.rig, voltage)
    bins = (fit.scatter * curve.mean()) ** 2 * np.array([1.0 / BINS, 2.0])
    model = np.array(
        [
            np.mean(errors[:, 0] ** 2),
            np.mean((errors[:, 1] * errors[:, 2]) ** 2) / curve.min() ** 2,
        ]
    )
    parts = np.array([parameter_variance(fit, voltage), bins, model])
    factor = float(student.ppf(0.975, len(errors)))
    return factor * np.sqrt(parts.sum(axis=0)), parts


def main() -> None:
    """Print the fit to the measured voltages and what the rig predicts for others."""
    fit = fitted(tuple(measured()))
    print(fit.rig, fit.message)
    print("standard deviations", np.sqrt(np.diag(fit.covariance)), fit.scatter)
    for voltage, curve in measured().items():
        model = speeds(fit.rig, voltage)
        rms = float(np.sqrt(np.mean(residuals(fit.rig, (voltage,)) ** 2)))
        print(voltage, "V:", numbers(curve), numbers(model), rms)
    errors = left_out()
    for voltage in PREDICTED:
        curve = speeds(fit.rig, voltage)
        width, parts = half_widths(fit, errors, voltage)
        print(voltage, "V:", numbers(curve), "+-", width, curve.min(), curve.max())
        print("    deviations of parameters, bins, left out:", np.sqrt(parts).tolist())


if __name__ == "__main__":
    main()
