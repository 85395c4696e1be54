"""The motion that drives prescribe, and the times at which it is not smooth."""

import math

import numpy as np

from presswear.linkage.drives import MAX_HARMONICS, Drive
from presswear.linkage.linkage import Linkage
from presswear.linkage.motion_pieces import DEGREE, MAX_PIECES
from presswear.tools.compile import Records, compiled, inlined, lazily_compiled

# A drive as the kernels see it
MOTION = np.dtype(
    [
        ("speed", np.float64),  # mean speed, with the turn of the pieces in a cycle
        ("angle", np.float64),  # at t = 0
        ("fundamental", np.float64),  # frequency of the first harmonic, rad/s
        ("count", np.int64),  # number of harmonics
        ("cosine", np.float64, (MAX_HARMONICS,)),
        ("sine", np.float64, (MAX_HARMONICS,)),
        ("pieces", np.int64),
        ("start", np.float64, (MAX_PIECES,)),  # see ``linkage.motion_pieces.Pieces``
        ("polynomial", np.float64, (MAX_PIECES, DEGREE + 1)),
        ("wave", np.float64, (MAX_PIECES, 3)),
        ("run_up", np.float64),  # time in which the linkage runs up, s
    ]
)

_TURN = 2.0 * math.pi  # rad
# Distance up to which a step counts as ended on a break, over the phase since t = 0
_BREAK_TOL = 1e-13
_BISECTIONS = 60  # halve the time of the run-up to its round-off


@compiled
def run_up_motion(duration: float, t: float) -> tuple[float, float, float]:
    """Return the time of the motion without a run-up, s, its rate, and the rate of that, 1/s."""
    if t >= duration:
        return t - 0.5 * duration, 1.0, 0.0
    x = max(t / duration, 0.0)
    square = x * x
    nominal = duration * square * square * (2.5 - x * (3.0 - x))
    rate = square * x * (10.0 - x * (15.0 - 6.0 * x))
    middle = x * (1.0 - x)
    return nominal, rate, 30.0 * middle * middle / duration


@compiled
def piece_at(drive: Records, phase: float) -> int:
    """Return the piece in which a phase of 0 to 2 pi lies; -1 before the first."""
    low = -1
    high: int = drive.pieces
    while high - low > 1:
        middle = (low + high) // 2
        if drive.start[middle] <= phase:
            low = middle
        else:
            high = middle
    return low


@compiled
def piece_motion(drive: Records, phase: float) -> tuple[float, float, float]:
    """Return the angle of the pieces since phase 0, rad, and two derivatives by the phase."""
    phase -= _TURN * math.floor(phase / _TURN)
    i = piece_at(drive, phase)
    if i < 0:
        i = drive.pieces - 1
        phase += _TURN
    x = phase - drive.start[i]
    value = 0.0
    slope = 0.0
    curvature = 0.0
    for power in range(DEGREE, -1, -1):
        curvature = curvature * x + 2.0 * slope
        slope = slope * x + value
        value = value * x + drive.polynomial[i, power]
    amplitude = drive.wave[i, 0]
    if amplitude != 0.0:
        w = drive.wave[i, 1]
        sine = math.sin(w * x + drive.wave[i, 2])
        value += amplitude * sine
        slope += amplitude * w * math.cos(w * x + drive.wave[i, 2])
        curvature -= amplitude * w * w * sine
    return value, slope, curvature


@lazily_compiled((0.0, 0.0, 0.0), MOTION, 0)
def uneven_motion(drive: Records, t: float) -> tuple[float, float, float]:
    """Return the result of ``drive_motion`` for any drive."""
    rate = 1.0  # rate of the time of the motion without a run-up
    rate_change = 0.0  # 1/s
    if drive.run_up > 0.0:
        t, rate, rate_change = run_up_motion(drive.run_up, t)
    angle: float = drive.speed * t
    speed: float = drive.speed
    acceleration = 0.0
    for k in range(drive.count):
        w = (k + 1) * drive.fundamental
        cosine = math.cos(w * t)
        sine = math.sin(w * t)
        angle += drive.cosine[k] * (cosine - 1.0) + drive.sine[k] * sine
        speed += w * (drive.sine[k] * cosine - drive.cosine[k] * sine)
        acceleration -= w * w * (drive.cosine[k] * cosine + drive.sine[k] * sine)
    if drive.pieces > 0:
        value, slope, curvature = piece_motion(drive, drive.fundamental * t)
        angle += value
        speed += drive.fundamental * slope
        acceleration += drive.fundamental * drive.fundamental * curvature
    if drive.run_up > 0.0:
        acceleration = acceleration * rate * rate + speed * rate_change
        speed *= rate
    return angle, speed, acceleration


@inlined
def drive_motion(drive: Records, t: float) -> tuple[float, float, float]:
    """Return angle since t = 0, rad, speed, rad/s, and acceleration, rad/s^2, of a drive."""
    if drive.count + drive.pieces > 0 or drive.run_up > 0.0:
        return uneven_motion(drive, t)
    return drive.speed * t, drive.speed, 0.0


@lazily_compiled(0, MOTION, 0)
def break_after(drive: Records, t: float) -> float:
    """Return the time, s, at which the next piece or the run-up ends; infinity if none does.

    Angle, speed and acceleration have no jump there, but a derivative behind them has.
    """
    duration = drive.run_up
    end_of_run_up = duration if t < duration * (1.0 - _BREAK_TOL) else math.inf
    if drive.pieces == 0:
        return end_of_run_up
    nominal = run_up_motion(duration, t)[0] if duration > 0.0 else t
    phase = drive.fundamental * nominal
    tolerance = _BREAK_TOL * (1.0 + phase)
    # A phase that is short of a whole turn by round-off belongs to the next.
    turns = _TURN * math.floor((phase + tolerance) / _TURN)
    i = piece_at(drive, phase - turns + tolerance) + 1
    next_start = drive.start[i] if i < drive.pieces else _TURN + drive.start[0]
    nominal = (turns + next_start) / drive.fundamental
    if nominal >= 0.5 * duration:
        return min(end_of_run_up, nominal + 0.5 * duration)
    low = t
    high = duration
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if run_up_motion(duration, middle)[0] < nominal:
            low = middle
        else:
            high = middle
    return min(end_of_run_up, high)


@compiled
def step_to_break(motions: Records, t: float, h: float) -> float:
    """Return the step, s, no longer than ``h``, that does not run past the next break of a motion.

    If the break is less than two steps away, the step goes half of the way. A step up
    to shortly before the break would be followed by a tiny one.
    """
    to_break = math.inf
    for i in range(motions.shape[0]):
        if motions[i].pieces > 0 or motions[i].run_up > 0.0:
            to_break = min(to_break, break_after(motions[i], t) - t)
    if to_break <= h:
        return to_break
    return 0.5 * to_break if to_break < 2.0 * h else h


def motions_of(linkage: Linkage) -> Records:
    """Return the drives of a linkage as records of MOTION, shape (drives,)."""
    motions = np.zeros(len(linkage.drives), MOTION)
    for motion, drive in zip(motions, linkage.drives, strict=True):
        if drive.follow is not None:
            raise ValueError(
                f"{drive.name} follows a curve: its motion has to be found first"
            )
        motion["speed"] = drive.mean_speed
        motion["angle"] = drive.start
        motion["fundamental"] = drive.base
        motion["count"] = len(drive.harmonics)
        # A motor runs up by its torque.
        motion["run_up"] = linkage.run_up_time if linkage.prescribes(drive) else 0.0
        for k, (cosine, sine) in enumerate(drive.harmonics):
            motion["cosine"][k] = cosine
            motion["sine"][k] = sine
        motion["pieces"] = count = len(drive.pieces.start)
        for name in ("start", "polynomial", "wave"):
            motion[name][:count] = getattr(drive.pieces, name)
    return motions


def is_steady(linkage: Linkage, drive: Drive) -> bool:
    """Return whether a drive turns at constant speed from the start."""
    return not (drive.repeats or linkage.run_up)
