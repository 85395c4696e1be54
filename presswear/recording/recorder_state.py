"""Recorder state: arrays and records that the kernels fill during one run."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from presswear.physics.packed import Packed
from presswear.tools.arrays import Array
from presswear.tools.compile import Records

# Wear integrals of a joint over one step
WEAR_INTEGRALS = np.dtype(
    [
        ("work", np.float64),  # F_n ds, N m
        # p ds, N/m. With wear over the arc it is in N m, see ``physics.pressure_wear``; with
        # a user law of the pressure it is the sliding distance, m.
        ("pressure", np.float64),
        # rates at the end of the step, only filled by exudyn-joints
        ("work_rate", np.float64),  # W
        ("pressure_rate", np.float64),  # W/m^2
    ]
)
# A drive in the recording; engines fill the integrals before they call ``observe``
DRIVE = np.dtype(
    [
        ("torque", np.float64),  # torque in the last accepted state, N m
        ("power", np.float64),  # power in the last accepted state, W
        # integrals over the last step
        ("torque_integral", np.float64),  # N m s
        ("torque_square_integral", np.float64),  # (N m)^2 s
        ("work", np.float64),  # J
        ("power_square_integral", np.float64),  # W^2 s
    ]
)
# Output point, its last accepted state, and the sampling of series
OUTPUT = np.dtype(
    [
        ("rows", np.int64),  # number of rows of the series that are written
        ("last_time", np.float64),  # time of the last row, s
        ("now", np.float64),  # time of the last accepted state, s
        ("interval", np.float64),  # longest time between two rows, s
        ("force_step", np.float64),  # see FORCE_STEP
        ("index", np.int64),  # index in q of x of the output body
        # cosine and sine of the angle of the output direction
        ("cos", np.float64),
        ("sin", np.float64),
        ("x", np.float64),  # output point in the axes of its body, m
        ("y", np.float64),
        ("start", np.float64),  # output coordinate at the start, m
        ("room", np.int64),  # largest number of rows
        ("place", np.float64),  # output coordinate in the last state, m
        ("velocity", np.float64),  # its rate, m/s
        ("acceleration", np.float64),  # its second derivative, m/s^2
        ("bottom", np.float64),  # lowest position in the present stroke so far, m
        ("bottom_time", np.float64),  # nominal time of this position, s
        # nominal times between which the bottom is searched for, s
        ("stroke_begin", np.float64),
        ("stroke_end", np.float64),
        ("stroke_length", np.float64),  # duration of a stroke, s
        ("period", np.float64),  # time between the starts of two strokes, s
    ]
)
# A guide with a spring. Its stretch is recorded: the coordinate of its body along the
# guide, minus that of the point of the guide.
GUIDE = np.dtype(
    [
        ("index", np.int64),  # index in q of x of the body
        # cosine and sine of the angle of the guide
        ("cos", np.float64),
        ("sin", np.float64),
        ("point", np.float64),  # coordinate of the point of the guide along it, m
    ]
)
# An elastic pin. The distance of the centres of pin and bearing is recorded.
PIN = np.dtype(
    [
        ("first", np.int64),  # index in q of x of the body with the bearing; -1: ground
        # centre of the bearing in the axes of this body, m
        ("first_x", np.float64),
        ("first_y", np.float64),
        ("second", np.int64),  # index in q of x of the body with the pin; -1: ground
        # centre of the pin in the axes of this body, m
        ("second_x", np.float64),
        ("second_y", np.float64),
    ]
)


class RecorderState(NamedTuple):
    """Recorder state: arrays that the kernels fill during one run."""

    packed: Packed  # the linkage
    motions: Records  # records of MOTION, of the drives
    contacts: Records  # records of CONTACT, with forces, in the last accepted state
    onset: Array  # latched closing speeds of the joints, 0 where open, m/s
    memory: Records  # records of MEMORY
    counters: Records  # records of COUNTERS
    stored_contacts: Records  # records of STORED_CONTACT, shape (joints, rows)
    output: Records  # one record of OUTPUT
    # Rows of SERIES, of JOINT_SERIES for each joint, of torques where they are stored,
    # and of LEADER_SERIES where a motor turns the linkage
    series: Array
    film: Array  # see ``presswear.recording.film``
    sampler: Records  # one record of FRAME_SAMPLER
    nominal: Records  # one record of NOMINAL
    cycle: Array  # row of the present cycle, see ``cycle_columns``
    # depth that the present cycle added, m, (joints, 2, m), see ``map_shape``
    depth: Array
    # first column of FILM_CYCLE in ``cycle`` for each joint; -1 without a film
    film_columns: NDArray[np.int64]
    last: Records  # record of LAST for each joint
    wear_integrals: Records  # records of WEAR_INTEGRALS, over the last step
    # working space of ``deposit_over_arc`` and ``deposit_by_law``, (4, m)
    shares: Array
    torque: Array  # torques of the drives in the present state, N m
    drives: Records  # records of DRIVE
    # Energies in the order of ENERGIES, J, and their rates in the last state, W; only
    # filled by exudyn-joints, which integrates them step by step
    energies: Array
    powers: Array
    guides: Records  # records of GUIDE, of the guides with a spring
    pins: Records  # records of PIN, of the elastic pins
    # stretches of these guides, then of these pins, in the rows of the series, m
    stretches: Array
    angle_indices: NDArray[
        np.int64
    ]  # indices in q of the angles of drives with a motor
    # angles, rad, and speeds, rad/s, of the drives with a motor in the rows of the series,
    # (rows, 2, drives)
    turns: Array
