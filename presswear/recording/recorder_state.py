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
        # p ds, N/m; with wear over the arc see ``physics.pressure_wear``, N m; with a
        # user law of the pressure the sliding distance, m
        ("pressure", np.float64),
        # rates at the end of the step, only filled by exudyn-joints
        ("work_rate", np.float64),  # W
        ("pressure_rate", np.float64),  # W/m^2
    ]
)
# A drive in the recording; engines fill the integrals before they call ``observe``
DRIVE = np.dtype(
    [
        ("torque", np.float64),  # in the last accepted state, N m
        ("power", np.float64),  # W
        ("torque_integral", np.float64),  # over the last step, N m s
        ("torque_square_integral", np.float64),  # (N m)^2 s
        ("work", np.float64),  # J
        ("power_square_integral", np.float64),  # W^2 s
    ]
)
# Output point, its last state, and the sampling of series
OUTPUT = np.dtype(
    [
        ("rows", np.int64),  # series rows written
        ("last_time", np.float64),  # of the last row, s
        ("now", np.float64),  # of the last accepted state, s
        ("interval", np.float64),  # longest time between two rows, s
        ("force_step", np.float64),  # see FORCE_STEP
        ("index", np.int64),  # of the x of the output body in q
        ("cos", np.float64),  # of the direction of the output
        ("sin", np.float64),
        ("x", np.float64),  # output point in the axes of its body, m
        ("y", np.float64),
        ("start", np.float64),  # output coordinate at the start, m
        ("room", np.int64),  # largest number of rows
        ("place", np.float64),  # output coordinate in the last state, m
        ("velocity", np.float64),  # m/s
        ("acceleration", np.float64),  # m/s^2
        ("bottom", np.float64),  # lowest position in the present stroke so far, m
        ("bottom_time", np.float64),  # nominal time of this position, s
        # nominal times between which the bottom is searched for, s
        ("stroke_begin", np.float64),
        ("stroke_end", np.float64),
        ("stroke_length", np.float64),  # s
        ("period", np.float64),  # from one stroke to the next, s
    ]
)
# A guide with a spring. Its stretch is recorded: the coordinate of its body along the
# guide, minus that of the point of the guide.
GUIDE = np.dtype(
    [
        ("index", np.int64),  # of the x of the body in q
        ("cos", np.float64),
        ("sin", np.float64),
        ("point", np.float64),  # m
    ]
)
# An elastic pin. The distance of the centres of pin and bearing is recorded.
PIN = np.dtype(
    [
        ("first", np.int64),  # of the x of the body of its bearing in q; -1: ground
        ("first_x", np.float64),  # in the frame of this body, m
        ("first_y", np.float64),
        ("second", np.int64),  # of the x of the body of the pin in q; -1: ground
        ("second_x", np.float64),
        ("second_y", np.float64),
    ]
)


class RecorderState(NamedTuple):
    """Recorder state: arrays that the kernels fill during one run."""

    packed: Packed  # the linkage
    motions: Records  # of MOTION, of its drives
    contacts: Records  # of CONTACT, with their forces, in the last accepted state
    onset: Array  # latched closing speeds of the joints, 0 where open, m/s
    memory: Records  # of MEMORY
    counters: Records  # of COUNTERS
    stored_contacts: Records  # of STORED_CONTACT, shape (joints, rows)
    output: Records  # one of OUTPUT
    # Rows of SERIES, of JOINT_SERIES for each joint, of torques where they are stored,
    # and of LEADER_SERIES where a motor turns the linkage
    series: Array
    film: Array  # see ``presswear.recording.film``
    sampler: Records  # one of FRAME_SAMPLER
    nominal: Records  # one of NOMINAL
    cycle: Array  # row of the present cycle, see ``cycle_columns``
    # depth that the present cycle added, m, (joints, 2, m), see ``map_shape``
    depth: Array
    # first columns of FILM_CYCLE in this row, of each joint; -1 without a film
    film_columns: NDArray[np.int64]
    last: Records  # of LAST, of each joint
    wear_integrals: Records  # of WEAR_INTEGRALS, over the last step
    # working space of ``deposit_over_arc`` and ``deposit_by_law``, (4, m)
    shares: Array
    torque: Array  # of the drives in the present state, N m
    drives: Records  # of DRIVE
    # Energies in the order of ENERGIES, J, and their rates in the last state, W; only
    # filled by exudyn-joints, which integrates them step by step
    energies: Array
    powers: Array
    guides: Records  # of GUIDE, with a spring
    pins: Records  # of PIN, elastic
    # of the guides, then of the pins, in the rows of the series, m
    stretches: Array
    angle_indices: NDArray[np.int64]  # in q, of the drives with a motor
    # angles, rad, and speeds, rad/s, of these drives in the rows of the series, (rows, 2,
    # drives)
    turns: Array
